"""What a model leaves: what is planted is said, at its size; where nothing is, nothing is said."""

import time
from dataclasses import replace

import numpy as np
import pytest
from diagnose.own_cases import truth_of, write_own
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign import Model, example, load_effect, load_experiment
from teleopdesign.cli import main
from teleopdesign.diagnose import find_missing
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.identifiability import is_identifiable
from teleopdesign.diagnose.noise_floor import noise_floor
from teleopdesign.diagnose.prepare import prepare
from teleopdesign.diagnose.search import estimate_from_starts
from teleopdesign.errors import ModelError
from teleopdesign.measurement.reversals import since_reversal
from teleopdesign.unexplained import describe_residual, where_it_fails
from teleopdesign.unexplained.amounts import amount, number
from teleopdesign.unexplained.curve import curve_of
from teleopdesign.unexplained.dependence import Dependence, dependences, model_columns
from teleopdesign.unexplained.effect_file import effect_text, write_effect
from teleopdesign.unexplained.formula import formula_for
from teleopdesign.unexplained.qualifiers import contrasts
from teleopdesign.unexplained.rows import rows_of
from teleopdesign.unexplained.sentences import sentence_for
from teleopdesign.unexplained.shapes import (
    FORCE,
    POSITION,
    SHAPES,
    Shape,
    Variable,
    basis,
    knots_of,
)


@pytest.fixture(scope="module")
def rod():
    """The shipped experiment, prepared."""
    return prepare(load_experiment(example("rod")))


@pytest.fixture(scope="module")
def lacking(rod):
    """The shipped model, which lacks `stribeck`, fitted."""
    return estimate_from_starts(Model.from_experiment(rod.experiment), rod)


@pytest.fixture(scope="module")
def adequate(rod, lacking):
    """The model that leaves only noise, fitted."""
    return estimate_from_starts(lacking.model.with_effect("stribeck", at="device"), rod)


@pytest.fixture(scope="module")
def failure(rod, lacking):
    """What the shipped model leaves."""
    return describe_residual(lacking, rod)


@pytest.fixture(scope="module")
def rows(rod, adequate):
    """The residual rows of the model that leaves only noise."""
    return rows_of(adequate.model, rod, "device")


@pytest.fixture(scope="module")
def floor_squares(rod, adequate, rows):
    """What sensors alone leave on the check rows."""
    floor = noise_floor(adequate.model, rod, np.random.default_rng(0)).value
    return floor**2 * sum(s.measured for s in rod.of("check"))


def planted(rows, missing):
    """The rows with a force missing(along) that the model lacks, as the residual shows it."""
    return replace(rows, residual=rows.residual + rows.lowpassed(lambda a: missing(a)[None])[:, 0])


def said(rows, found, axis="prismatic"):
    """The sentence about a dependence, with its formula."""
    formula = formula_for(rows, model_columns(rows), found)
    left = rows.residual * rows.root
    sides = contrasts(rows, found, left)
    return sentence_for(found.shape, curve_of(rows, found), formula, sides, axis), formula


def test_the_shipped_model_needs_more_friction_at_low_speed_in_both_directions(failure):
    part, one = failure.largest
    assert one.dependence.shape.name == "friction over speed"
    assert "in both directions" in one.sentence
    assert "below 1" in one.sentence and "more than the model" in one.sentence
    (term,) = one.formula.terms
    # planted 0.2 N and 22 mm/s; the description is of first order: a tenth
    assert term.kind == "bell"
    assert term.number == pytest.approx(0.022, rel=0.1)
    assert one.formula.coefficients[0] == pytest.approx(0.2, rel=0.1)
    assert part.after < 0.3 * part.error


def test_a_curve_lies_within_its_band_of_means_that_it_has_not_seen(failure):
    curve = failure.largest[1].curve
    x, y, low, high = curve.means
    at = np.interp(x, curve.x, curve.y)
    # bands of two standard deviations on either side; the lines between knots add a little
    assert np.mean((at > low - 0.1 * np.ptp(y)) & (at < high + 0.1 * np.ptp(y))) > 0.9


def test_a_model_that_leaves_only_noise_is_said_to_be_fine(rod, adequate):
    (finding,) = where_it_fails(adequate, rod)
    assert finding.concern == "fine"


def test_what_is_left_is_counted_in_the_floors_that_a_diagnosis_kept_to(rod, adequate):
    floor = noise_floor(adequate.model, rod, np.random.default_rng(0))
    kept = floor.at_most(0.25 * floor.drawn)
    assert kept.held and kept.counted == pytest.approx(0.25)
    ((whole,), (part,)) = (describe_residual(adequate, rod, f).parts for f in (floor, kept))
    assert part.floor == pytest.approx(0.25 * whole.floor)
    assert whole.is_adequate and not part.is_adequate


@pytest.mark.slow
def test_a_fit_and_its_model_give_the_same_sentences(rod, lacking, failure):
    assert [str(f) for f in where_it_fails(lacking.model, rod)] == list(map(str, failure.findings))


def test_every_finding_has_numbers_and_a_graph_with_units(failure):
    for finding in failure.findings:
        assert finding.numbers and np.isfinite(list(finding.numbers.values())).all()
        assert finding.graph.series
        assert finding.graph.y_label.endswith(")"), "the unit"
        assert finding.sentence.endswith(".")


def test_every_view_of_the_issue_is_there(failure):
    wanted = "time velocity position acceleration force direction frequency".split()
    assert {*wanted, "time since reversal"} == set(failure.parts[0].views)


def test_what_is_found_is_drawn(failure):
    import matplotlib.pyplot as plt

    figure = failure.plot()
    panels = [ax for ax in figure.axes if ax.axison]
    assert len(panels) == len(failure.parts[0].views) + len(failure.parts[0].dependences)
    assert "Below" in figure.get_suptitle()
    plt.close(figure)


def position(a):
    return a.signals["position"]


PLANTED = {
    "force over position": (lambda a: a.push * 4.0 * position(a), "at positions above", 4.0),
    "friction over position": (
        lambda a: a.grip * np.where(position(a) > 0.005, 12.0 * (position(a) - 0.005), 0.0),
        "at positions above",
        12.0,
    ),
    "force over speed": (lambda a: a.push * 0.5 * a.signals["speed"], "above", 0.5),
    "friction over load": (lambda a: a.grip * 0.08 * a.signals["load"], "command's size", 0.08),
    "damping over position": (
        lambda a: a.push * 3e3 * position(a) ** 2 * a.signals["velocity"],
        "more damping",
        3e3,
    ),
}


QUICK = ("force over position", "friction over load", "damping over position")


@pytest.mark.parametrize(
    "name", [n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in PLANTED]
)
def test_a_planted_dependence_is_said_with_variable_range_and_size(rows, floor_squares, name):
    missing, words, size = PLANTED[name]
    here = planted(rows, missing)
    found, _ = dependences(here, floor_squares)
    assert found[0].shape.name == name
    text, formula = said(here, found[0])
    assert words in text
    assert formula.terms[0].kind in ("power", "above")
    # noise of the sensors is a tenth to a third of what is planted
    assert formula.coefficients[0] == pytest.approx(size, rel=0.15)


@pytest.mark.parametrize(
    ("name", "missing", "size"),
    [
        ("force", lambda a: a.push * -0.06, -0.06),
        ("friction over time", lambda a: a.grip * 0.2 * np.exp(-a.signals["time"] / 3.0), None),
        ("lateness", lambda a: a.push * 1.5e-3 * a.signals["force_rate"], 1.5e-3),
        ("mass", lambda a: a.push * 0.02 * a.signals["acceleration"], 0.02),
    ],
)
def test_a_planted_constant_has_its_sign_and_size(
    rod, adequate, floor_squares, name, missing, size
):
    fixed = adequate.model.parameters["device.inertia"]
    model = adequate.model.with_values({"device.inertia": replace(fixed, fixed=True)})
    here = planted(rows_of(model, rod, "device"), missing)
    found, _ = dependences(here, floor_squares)
    assert found[0].shape.name == name
    if size is not None:
        assert curve_of(here, found[0]).y[0] == pytest.approx(size, rel=0.1)


@pytest.mark.parametrize(
    "frequency", [pytest.param(f, marks=pytest.mark.slow) for f in (0.3, 17.0)] + [50.0]
)
def test_a_hum_is_found_at_its_frequency(rows, floor_squares, frequency):
    here = planted(
        rows, lambda a: a.push * 0.15 * np.sin(2 * np.pi * frequency * a.signals["time"] + 1.0)
    )
    found, _ = dependences(here, floor_squares)
    assert found[0].shape.carrier is FORCE and found[0].shape.variable.name == "time"
    text, formula = said(here, found[0])
    # a tenth of the resolution of a record of 12 s
    assert formula.terms[0].number == pytest.approx(frequency, abs=0.01)
    assert np.hypot(*formula.coefficients) == pytest.approx(0.15, rel=0.1)
    assert "goes up and down at" in text


def test_cogging_of_many_periods_is_found_at_its_period(rows, floor_squares):
    here = planted(rows, lambda a: a.push * 0.1 * np.sin(2 * np.pi * position(a) / 1.2e-3))
    found, _ = dependences(here, floor_squares)
    assert found[0].shape.name == "force repeating over position"
    assert 1.0 / found[0].knots[0] == pytest.approx(1.2e-3, rel=1e-3)
    assert "every 1.2 mm of travel" in said(here, found[0])[0]


def test_only_one_direction_is_said(rows, floor_squares):
    here = planted(
        rows, lambda a: a.push * np.where(a.signals["velocity"] > 0, a.signals["velocity"], 0.0)
    )
    found, _ = dependences(here, floor_squares)
    assert found[0].shape.name in ("force over speed", "force over velocity", "friction over speed")
    assert "forward" in said(here, found[0])[0]


def test_only_after_a_rest_is_said(rows):
    """A friction at low speed that is there only where the body had rested before."""
    shape = Shape(SHAPES[1].carrier, next(s.variable for s in SHAPES if "over speed" in s.name))

    def low(a):
        return a.grip * 0.3 * np.exp(-((a.signals["speed"] / 0.03) ** 2))

    whole = rows.lowpassed(lambda a: low(a)[None])[:, 0] * rows.root
    after = rows.lowpassed(lambda a: (low(a) * (a.signals["rested"] >= 0.2))[None])[:, 0]
    here = replace(rows, residual=rows.residual + after)
    columns = replace(model_columns(rows), values=whole[:, None], penalty=np.zeros((1, 1)))
    one = Dependence(
        shape, np.zeros(1), columns, np.ones(1), np.zeros(0), np.zeros(0), 9.0, 0.0, 1.0
    )
    told = contrasts(here, one, here.residual * here.root)
    assert [c.only for c in told if "rested" in c.sides[0]] == ["after it has rested"]
    assert [c.only for c in told if "forward" in c.sides[0]] == [""]


@pytest.mark.slow
def test_the_residual_in_another_unit_says_the_same(rows, floor_squares):
    missing = PLANTED["force over position"][0]
    one = planted(rows, missing)
    scaled = replace(one, residual=1e3 * one.residual, measured=1e3 * one.measured)
    a, b = dependences(one, floor_squares)[0], dependences(scaled, 1e6 * floor_squares)[0]
    assert [d.shape for d in a] == [d.shape for d in b]
    assert [d.score for d in a] == pytest.approx([d.score for d in b], rel=1e-3)


def test_what_another_value_of_a_parameter_explains_is_not_missing(rows, floor_squares):
    step = 0.05 * rows.tangents / np.linalg.norm(rows.tangents, axis=0)
    moved = replace(rows, residual=rows.residual + step @ np.ones(rows.tangents.shape[1]))
    assert dependences(moved, floor_squares)[0] == ()


def test_nothing_is_learnt_from_the_checked_rows(rows, floor_squares):
    """A force on the check record alone is no dependence that the fit record tells of."""
    here = planted(rows, lambda a: a.push * 4.0 * position(a) * (a.stretch.use == "check"))
    assert "force over position" not in [d.shape.name for d in dependences(here, floor_squares)[0]]


def test_time_and_travel_are_counted_from_where_the_body_set_off():
    direction = np.array([0, 1, 1, 0, 0, 0, 1, 1, -1, -1], dtype=np.int8)
    x = np.array([0.0, 1, 2, 2, 2, 2, 3, 4, 3, 2])
    found = since_reversal(direction, x, sample_time=0.1, rest=0.35)
    assert found.known.tolist() == [False] + [True] * 9
    assert found.time == pytest.approx([0, 0, 0.1, 0.2, 0.3, 0.4, 0, 0.1, 0, 0.1])
    assert found.travel == pytest.approx([0, 0, 1, 1, 1, 1, 0, 1, 0, 1])
    assert found.rested[6:8] == pytest.approx(0.4) and found.rested[8] == pytest.approx(0.1)
    short = since_reversal(direction, x, sample_time=0.1, rest=0.5)
    assert short.time[6] == pytest.approx(0.5), "a short stop is no new start"


@given(st.floats(1e-9, 1e9), st.sampled_from([-1.0, 1.0]))
def test_a_number_is_said_to_two_digits(size, sign):
    # half of the second digit, at worst of 1.0
    assert float(number(sign * size)) == pytest.approx(sign * size, rel=0.0501)


def test_amounts_have_units_that_read_well():
    assert amount(0.004, "velocity", "prismatic") == "4.0 mm/s"
    assert amount(0.3, "force", "prismatic") == "0.30 N"
    assert amount(0.012, "force", "revolute") == "12 mN m"
    assert amount(0.12, "dimensionless", "prismatic") == "12 %"


@given(st.lists(st.floats(-2.0, 3.0), min_size=1, max_size=20))
def test_lines_between_knots_reproduce_a_straight_line_and_beyond(values):
    knots = np.linspace(-1.0, 1.0, 5)
    u = np.array(values)
    functions = basis(Variable("position", "position"), knots, u)
    assert (2.0 * knots + 1.0) @ functions == pytest.approx(2.0 * u + 1.0, abs=1e-9)


def test_a_record_with_its_own_zero_is_not_asked_about_position(rod, adequate):
    zero = frozenset({"position_zero"})
    own = replace(rod, stretches=tuple(replace(s, offset_names=zero) for s in rod.stretches))
    rows = rows_of(adequate.model, own, "device")
    assert len(knots_of(POSITION, rows)) == 0


def test_without_check_records_blocks_are_held_out(rod, lacking):
    seen = replace(rod, stretches=rod.of("fit"))
    found = describe_residual(lacking, seen)
    assert found.largest[1].dependence.shape.name == "friction over speed"


def written(tmp_path, name, found, prepared, described=None):
    part, largest = found.largest
    path = tmp_path / f"{name}.py"
    write_effect(path, part, described or largest, prepared)
    return load_effect(path)


def test_a_written_effect_loads_and_its_fit_reaches_the_noise_floor(
    tmp_path, rod, lacking, adequate, failure
):
    effect = written(tmp_path, "low_speed", failure, rod)
    assert effect.role == "friction_level"
    fitted = estimate_from_starts(lacking.model.with_effect(effect, at="device"), rod, lacking)
    # the formula is the catalogue's own, so its error must be that of the model that is right
    assert fitted.check_error == pytest.approx(adequate.check_error, rel=0.02)
    assert is_identifiable(fitted, lacking)


def test_without_a_formula_the_curve_itself_is_written(tmp_path, rod, lacking, adequate, failure):
    part, largest = failure.largest
    effect = written(tmp_path, "curve", failure, rod, replace(largest, formula=None))
    assert list(effect.parameters) == ["strength"]
    fitted = estimate(lacking.model.with_effect(effect, at="device"), rod)
    # straight between 16 knots, learnt to first order: a third more than the noise
    assert fitted.check_error < 1.33 * adequate.check_error


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: s.name)
def test_every_dependence_is_an_effect_file_that_loads_or_says_why_not(
    tmp_path, rod, rows, floor_squares, failure, shape
):
    part, largest = failure.largest
    one = next((t for t in part.tests if t.shape == shape), None)
    if one is None:
        pytest.skip("the rod tells nothing of it")
    described = replace(largest, dependence=one, formula=None)
    name = None if shape.variable is None else shape.variable.name
    if shape.is_wave:
        pytest.skip("a sinusoid has a formula")
    if name in ("since_reversal", "travel") or shape.carrier.name == "lateness":
        with pytest.raises(ModelError, match="cannot be written"):
            effect_text(part, described, rod)
        return
    path = tmp_path / "made.py"
    write_effect(path, part, described, rod)
    text = path.read_text()
    assert max(map(len, text.splitlines())) <= 100
    effect = load_effect(path)
    assert effect.is_absent({s: 0.0 for s in effect.symbols().values()})


def test_the_command_says_where_it_fails_and_writes_what_is_asked(tmp_path, capsys):
    wanted = {n: tmp_path / n for n in ("f.png", "f.json", "low_speed.py")}
    asked = ["--figure", "f.png", "--json", "f.json", "--effect-file", "low_speed.py"]
    asked = [str(wanted.get(a, a)) for a in asked]
    assert main(["describe", str(example("rod")), "--as-is", *asked]) == 0
    printed = capsys.readouterr().out
    assert "in both directions" in printed and "teleopdesign diagnose" in printed
    assert all(path.stat().st_size > 500 for path in wanted.values())


def test_bad_files_are_refused_before_the_work(tmp_path, capsys):
    folder = str(example("rod"))
    for option, name in (("--effect-file", "a-b.py"), ("--json", "x.txt"), ("--figure", "x.doc")):
        assert main(["describe", folder, option, str(tmp_path / name)]) == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_looking_is_fast(rod, lacking):
    describe_residual(lacking, rod)
    began = time.process_time()
    describe_residual(lacking, rod)
    # 0.5 s on one core for 20 s at 1 kHz; threads of a busy machine count several times
    assert time.process_time() - began < 8.0


@pytest.mark.slow
def test_noise_alone_is_called_a_dependence_in_less_than_one_record_of_fifty(rows, floor_squares):
    """Residuals of the sensors' own spectrum, drawn anew."""
    rng, alarms, draws = np.random.default_rng(8), 0, 100
    size = np.sqrt(np.mean(rows.residual**2))
    for _ in range(draws):
        noise = rows.lowpassed(lambda a: rng.standard_normal((1, len(a.push))))[:, 0]
        here = replace(rows, residual=size * noise / np.std(noise))
        alarms += bool(dependences(here, floor_squares)[0])
    assert alarms <= 2


SAID = {
    "viscous": ("damping",),
    "coulomb": ("friction",),
    "stribeck": ("friction over speed",),
    "bias": ("force",),
    "spring": ("force over position",),
    "hardening_spring": ("force over position",),
    "actuation_delay": ("lateness",),
    "actuator_lag": ("lateness",),
    "quadratic_drag": ("friction over speed",),
    "viscous_asymmetry": ("force over speed", "force over velocity"),
    "position_dependent_friction": ("friction over position", "friction repeating over position"),
    "cogging": ("force over position", "force repeating over position"),
    "load_dependent_friction": ("friction over load",),
    "friction_drift": ("friction over time",),
    "actuator_saturation": ("force over actuator_force",),
    "torque_ripple": ("lost command over position", "lost command repeating over position"),
}


@pytest.mark.slow
@pytest.mark.parametrize("effect", SAID)
def test_what_the_independent_simulator_hides_is_said(tmp_path, effect):
    folder = write_own(tmp_path / "case", effect, seed=21)
    prepared = prepare(load_experiment(folder))
    fit = estimate_from_starts(Model.from_experiment(prepared.experiment), prepared)
    assert describe_residual(fit, prepared).largest[1].dependence.shape.name in SAID[effect]


@pytest.mark.slow
def test_where_the_independent_simulator_hides_nothing_nothing_is_said(tmp_path):
    alarms, number_of_cases = 0, 50
    for seed in range(number_of_cases):
        folder = write_own(tmp_path / str(seed), None, seed=1000 + seed)
        prepared = prepare(load_experiment(folder))
        fit = estimate_from_starts(Model.from_experiment(prepared.experiment), prepared)
        alarms += describe_residual(fit, prepared).largest is not None
    assert alarms <= 1, "2 % of records"


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_a_force_outside_the_catalogue_is_described_written_and_named(tmp_path, seed):
    folder = write_own(tmp_path / "case", None, seed=300 + seed, level="outside")
    experiment = load_experiment(folder)
    prepared = prepare(experiment)
    model = Model.from_experiment(experiment)
    effect = written(
        tmp_path, "found", describe_residual(estimate(model, prepared), prepared), prepared
    )
    known = {**model.known, "found": effect}
    diagnosis = find_missing(experiment, replace(model, known=known))
    assert "found" in [c.effect.name for c in diagnosis.missing]
    # within half of the true model's error; a hum's form is exact, others to the floor's spread
    assert diagnosis.after.check_error < 1.5 * truth_of(folder)["check_error_true"]
