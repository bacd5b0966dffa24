"""Friction curves of plain numpy: the law that made them is named with its values, no other one."""

from pathlib import Path

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.cli import main
from teleopdesign.diagnose.covariance import friction_at
from teleopdesign.diagnose.search import estimate_from_starts
from teleopdesign.measurement.prepare import prepare

NOISE = 0.008  # N*m
#: effect -> the friction that it makes beside Coulomb and viscous friction, at a speed above zero
TRUTHS = {
    "stribeck": lambda v: 0.4 + 0.3 * np.exp(-((v / 0.08) ** 2)) + 0.25 * v,
    "smoothed_coulomb": lambda v: 0.4 * v / (0.03 + v) + 0.25 * v,
    "quadratic_drag": lambda v: 0.4 + 0.25 * v + 0.1 * v**2,
}
VALUES = {
    "stribeck": {"extra_static_level": 0.3, "stribeck_velocity": 0.08},
    "smoothed_coulomb": {"level": 0.4, "smoothing_velocity": 0.03},
    "quadratic_drag": {"drag": 0.1},
}


def speeds(rng, points=20):
    one_way = np.geomspace(0.005, 1.5, points)
    return np.concatenate([-one_way, one_way]) * (1.0 + 0.02 * rng.standard_normal(2 * points))


def drawn(seed, truth, *, points=20, more=lambda v: 0.0, **options):
    """A curve with a point at each speed; more: force that does not change sign with the speed."""
    rng = np.random.default_rng(seed)
    v = speeds(rng, points)
    force = truth(np.abs(v)) * np.sign(v) + more(v) + NOISE * rng.standard_normal(len(v))
    return td.friction_curve(v, force, axis="revolute", **options)


@pytest.mark.parametrize("name", TRUTHS)
def test_the_law_of_a_curve_is_named_with_its_values(name):
    diagnosis = td.find_missing(drawn(3, TRUTHS[name]))
    assert diagnosis.verdict == "effects_missing"
    assert [one["effect"] for one in diagnosis.missing_places] == [name]
    named = next(c for c in diagnosis.candidates if c.candidate.effect.name == name)
    for parameter, value in VALUES[name].items():
        estimate = named.parameters[parameter]
        assert abs(estimate.value - value) < 4.0 * estimate.stderr
        assert estimate.stderr < 0.2 * value
    assert diagnosis.after.check_error == pytest.approx(diagnosis.floor.value, rel=0.5)
    assert "presliding" in " ".join(diagnosis.left_out)
    assert "device.inertia" not in diagnosis.parameters


def test_constant_force_and_coulomb_asymmetry_stay_one_group():
    diagnosis = td.find_missing(drawn(4, lambda v: 0.4 + 0.25 * v, more=lambda v: 0.06))
    assert diagnosis.verdict == "undecided"
    (group,) = diagnosis.indistinguishable
    assert {c.effect.name for c in group} == {"bias", "coulomb_asymmetry"}


def test_a_pair_that_no_point_tells_apart_is_missing_beside_a_named_effect():
    """Each has half of the probability, the pair nearly all of it."""
    v = np.r_[np.linspace(-0.2, -0.005, 20), np.linspace(0.005, 0.2, 20)]
    force = np.sign(v) * (0.5 + 0.2 * np.exp(-((v / 0.03) ** 2))) + 1.5 * v + 0.1
    force += 0.005 * np.random.default_rng(0).standard_normal(len(v))
    diagnosis = td.find_missing(td.friction_curve(v, force, axis="prismatic"))
    assert [c.effect.name for c in diagnosis.missing] == ["stribeck"]
    (row,) = diagnosis.either
    assert {row.added.effect.name, row.alternatives[0].candidate.effect.name} == {
        "bias",
        "coulomb_asymmetry",
    }
    assert "is missing: these records do not decide which" in str(diagnosis)
    assert "less likely than not" not in str(diagnosis)


@pytest.mark.slow
def test_no_effect_is_named_on_coulomb_and_viscous_friction():
    among = ("stribeck", "smoothed_coulomb", "quadratic_drag")
    answers = [td.find_missing(drawn(s, lambda v: 0.4 + 0.25 * v), among=among) for s in range(12)]
    assert {a.verdict for a in answers} == {"model_adequate"}


def test_answer_of_a_curve_is_the_same_from_its_file(tmp_path):
    path = drawn(6, TRUTHS["stribeck"]).save(tmp_path / "curve")
    answer = tmp_path / "answer.json"
    assert main(["diagnose", str(path), "--only", "stribeck", "--json", str(answer)]) == 0
    diagnosis = td.load_answer(answer)
    assert diagnosis.kind == "friction curve" and diagnosis.model.body("device").has("stribeck")
    assert td.compare(diagnosis.model, diagnosis.experiment).fit_error == pytest.approx(
        diagnosis.after.fit_error, rel=1e-3
    )
    page = tmp_path / "page.html"
    assert main(["report", str(answer), "--output", str(page)]) == 0
    assert "friction curve" in page.read_text()
    assert main(["describe", str(answer)]) == 0
    assert diagnosis.plot().axes[0].get_xlabel() == "velocity (rad/s)"


def test_scatter_of_repeated_points_is_the_noise_floor():
    rng = np.random.default_rng(7)
    v = np.repeat(np.concatenate([-np.linspace(0.1, 1, 20), np.linspace(0.1, 1, 20)]), 4)
    friction = (0.4 + 0.25 * np.abs(v)) * np.sign(v)
    curve = td.friction_curve(v, friction + NOISE * rng.standard_normal(len(v)), axis="revolute")
    floor = td.compare(td.fit(td.Model.from_experiment(curve), curve), curve).floor
    assert "readings at one speed" in floor.source
    # the floor of a fit is no larger than what the fit leaves; 120 degrees of freedom: 6 %
    size = floor.value * np.sqrt(np.mean(friction**2))
    assert size == pytest.approx(NOISE, rel=0.2)


def test_band_of_the_curve_holds_the_truth():
    """Two standard errors: 95 % of normal errors; 30 draws of three speeds are known to 4 %."""
    at, held = np.array([-1.0, 0.05, 0.8]), []
    for seed in range(30):
        curve = drawn(seed, lambda v: 0.4 + 0.25 * v)
        prepared = prepare(curve)
        fit = estimate_from_starts(td.Model.from_experiment(curve), prepared)
        force, error = friction_at(fit, at)
        truth = (0.4 + 0.25 * np.abs(at)) * np.sign(at)
        held.append(np.abs(force - truth) < 2.0 * error)
    assert np.mean(held) > 0.85


def test_a_curve_without_a_named_law_is_fitted_by_free_friction():
    curve = drawn(
        9, lambda v: 0.5 - 0.2 * np.sin(3 * v) + 0.1 * np.cos(7 * v), effects=("viscous",)
    )
    model = td.Model.from_experiment(curve).with_effect("free_friction")
    fit = estimate_from_starts(model, prepare(curve))
    # straight lines between eight values leave a few percent of such waves
    assert fit.check_error < 0.08
    answer = td.find_missing(curve, among=("stribeck",))
    assert answer.no_named_law is not None
    assert answer.no_named_law.candidate.effect.name == "free_friction"
    assert answer.no_named_law.check_error < 0.6 * answer.after.check_error
    assert "no named law" in repr(answer)


def test_force_of_the_wrong_sign_names_nothing_and_says_what_mends_it():
    curve = drawn(10, lambda v: -(0.4 + 0.25 * v))
    answer = td.find_missing(curve)
    assert answer.verdict == "undecided" and "sign = -1" in answer.silence
    assert any("sign = -1" in f.sentence for f in td.check_experiment(curve))


@pytest.mark.parametrize(
    ("channels", "effects", "message"),
    [
        ('time = { column = "v", unit = "s" }', "coulomb = {}", "no time"),
        ("", "presliding = {}\ncoulomb = {}", "presliding needs a time"),
    ],
)
def test_what_needs_a_time_is_refused(tmp_path, channels, effects, message):
    np.savetxt(tmp_path / "c.csv", [[0.1, 1.0], [0.2, 1.1], [-0.1, -1.0], [-0.2, -1.1]] * 3,
               delimiter=",", header="v,f", comments="")  # fmt: skip
    (tmp_path / "experiment.toml").write_text(
        'kind = "friction curve"\n[model.device]\naxis = "revolute"\n'
        f"[model.device.effects]\n{effects}\n[channels]\n{channels}\n"
        'velocity = { column = "v", unit = "rad/s" }\n'
        'actuator_force = { column = "f", unit = "N*m" }\n'
        '[[records]]\nfile = "c.csv"\nuse = "fit"\n'
    )
    with pytest.raises(td.ExperimentError, match=message):
        td.find_missing(td.load_experiment(tmp_path))


def write_table(path: Path, head: str):
    v = np.linspace(-100, 100, 40)
    np.savetxt(path, np.column_stack([v, 20 * np.sign(v) + 0.1 * v]), delimiter=",", header=head,
               comments="")  # fmt: skip


def test_new_reads_a_table_of_speeds_and_torques(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_table(tmp_path / "motor.csv", "speed (rpm),torque (mN m)")
    assert main(["new", "motor.csv", "--output", "motor"]) == 0
    curve = td.load_experiment("motor")
    assert curve.is_curve and curve.axis("device") == "revolute"
    assert np.abs(curve.records[0].signals["device.velocity"]).max() == pytest.approx(10.47, 1e-3)
    assert "kind" in curve.guesses


def test_a_curve_at_the_motor_is_that_of_the_joint_behind_its_gear(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_table(tmp_path / "motor.csv", "speed (rpm),torque (mN m)")
    assert main(["new", "motor.csv", "--output", "motor", "--gear-ratio", "50"]) == 0
    signals = td.load_experiment("motor").records[0].signals
    assert np.abs(signals["device.velocity"]).max() == pytest.approx(10.47 / 50, 1e-3)
    assert np.abs(signals["device.actuator_force"]).max() == pytest.approx(50 * 0.03, 1e-3)
    assert main(["new", "motor.csv", "--overwrite", "--inertia", "0.3"]) == 2
    assert "--inertia: says nothing of a friction curve" in capsys.readouterr().err


@pytest.mark.parametrize("points", [4, 9])
def test_few_speeds_name_no_effect_beside_the_parameters_that_follow_them(points):
    """Coulomb and viscous friction are all that is there; a law through all points says nothing."""
    for seed in range(2):
        rng = np.random.default_rng(seed)
        one_way = np.geomspace(0.003, 0.3, points - points // 2)
        v = np.r_[-one_way[: points // 2][::-1], one_way]
        force = 0.5 * np.sign(v) + 2.0 * v + 0.005 * rng.standard_normal(points)
        diagnosis = td.find_missing(td.friction_curve(v, force, axis="prismatic"))
        assert not diagnosis.missing and diagnosis.no_named_law is None
        assert (points < 6) == ("measure at 6 speeds or more" in diagnosis.silence)
