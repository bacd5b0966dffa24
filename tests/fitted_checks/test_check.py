"""The check before fitting: signs, units, timing, swapped columns, and what a record can show."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from fitted_checks.asking import ask_fitted, disagreements
from shared_data import shared_folder

import teleopdesign as td
from teleopdesign import Model, example, load_experiment
from teleopdesign.cli import main
from teleopdesign.effects import catalogue
from teleopdesign.fitted_checks import check_experiment
from teleopdesign.measurement.prepare import prepare

#: effects that stand for each way of being seen; all of them take longer
SOME = ("bias", "coulomb", "coulomb_asymmetry", "viscous", "stribeck", "spring", "actuation_delay")


@pytest.fixture(scope="module")
def rod():
    return load_experiment(example("rod"))


@pytest.fixture(scope="module")
def few():
    known = catalogue()
    return {n: known[n] for n in SOME}


def changed(experiment, quantity, change, body="device"):
    """The experiment with one channel of every record changed."""
    key = f"{body}.{quantity}"
    records = tuple(
        replace(r, signals={**r.signals, key: change(r.signals[key])}) for r in experiment.records
    )
    return replace(experiment, records=records)


def shifted(samples):
    """Later by so many samples; the ends repeat."""

    def change(x):
        return x[np.clip(np.arange(len(x)) - samples, 0, len(x) - 1)]

    return change


def plausible(experiment):
    return disagreements(Model.from_experiment(experiment), prepare(experiment))


def the_one(experiment, topic):
    findings = [f for f in plausible(experiment) if f.concern != "fine"]
    assert [f.topic for f in findings] == [topic], list(map(str, findings))
    return findings[0]


# signs and units


def test_a_right_record_agrees_with_its_model(rod):
    (finding,) = plausible(rod)
    assert finding.concern == "fine"
    # Stribeck is missing in this model: 6 % of the force, which the inertia takes part of
    assert finding.numbers["inertia"] == pytest.approx(0.19, rel=0.1)
    assert finding.numbers["gain"] == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("quantity", ["actuator_force", "interaction_force", "position"])
def test_the_channel_whose_sign_is_turned_is_named(rod, quantity):
    finding = the_one(changed(rod, quantity, np.negative), "signs")
    assert finding.concern == "warning"
    assert finding.sentence.startswith(f"{quantity} has the opposite sign")
    assert (finding.numbers["gain"] < 0) == (quantity != "position")


@pytest.mark.parametrize(("factor", "slip"), [(1e3, "in mm, given as m"), (1e2, "in cm, given")])
def test_a_position_in_another_unit_than_stated_is_detected_by_the_model(rod, factor, slip):
    finding = the_one(changed(rod, "position", lambda x: factor * x), "units")
    assert slip in finding.sentence
    assert finding.numbers["ratio.inertia"] == pytest.approx(1 / factor, rel=0.15)
    assert finding.numbers["ratio.coulomb.level"] == pytest.approx(1.0, rel=0.15)


def test_an_inertia_in_grams_given_as_kilograms_is_distinguished_from_a_wrong_position(rod):
    model = Model.from_experiment(rod)
    heavy = model.with_values({"device.inertia": 186.6})
    (finding,) = disagreements(heavy, prepare(rod))
    assert "inertia is meant in g, given as kg" in finding.sentence


@pytest.mark.parametrize("quantity", ["actuator_force", "interaction_force"])
def test_one_force_in_another_unit_is_named_by_the_inertia(rod, quantity):
    finding = the_one(changed(rod, quantity, lambda x: 1e3 * x), "units")
    assert f"{quantity} is in another unit" in finding.sentence
    factor = max(finding.numbers["gain"], 1 / finding.numbers["gain"])
    assert factor == pytest.approx(1e3, rel=0.05)


# timing


@pytest.mark.slow
@pytest.mark.parametrize(
    ("quantity", "samples", "concern"),
    [
        ("interaction_force", 5, "warning"),
        ("interaction_force", -7, "warning"),
        ("actuator_force", 5, "warning"),  # an effect before its cause
        ("actuator_force", -5, "note"),  # a delay of the actuator does that too
        ("position", 5, "warning"),
        ("position", -60, "warning"),
    ],
)
def test_a_channel_shifted_by_whole_samples_is_named_with_the_time(rod, quantity, samples, concern):
    finding = the_one(changed(rod, quantity, shifted(samples)), "time shift")
    assert finding.concern == concern
    # three standard errors of the interaction force's shift, 0.4 ms; of the others' 0.1 ms
    error = 1.2e-3 if quantity == "interaction_force" else 3e-4
    assert finding.numbers[f"{quantity}.lag"] == pytest.approx(samples * 1e-3, abs=error)
    assert set(finding.numbers) & {"left", "unshifted"}


@pytest.mark.parametrize(("other", "concern"), [(0.0, "note"), (1.0, "warning")])
def test_a_shift_by_a_radian_and_more_is_no_delay_on_a_motion_of_one_frequency(other, concern):
    """A hand's force 0.29 s late at 0.8 Hz: its phase is that of another force, or of a gain."""
    t = np.arange(0.0, 20.0, 5e-3)

    def moved(t):
        return np.sin(5.0 * t) + other * np.sin(2.1 * t + 1.0) + other * 0.1 * np.sin(23.0 * t)

    v, a = np.gradient(moved(t), t), np.gradient(np.gradient(moved(t), t), t)
    hand = 0.5 * np.sin(3.3 * t) + 0.3 * np.sin(9.1 * t + 0.4)
    late = np.interp(t - 0.29, t, hand)
    noise = 1e-3 * np.random.default_rng(1).standard_normal(len(t))
    data = {
        "t": t,
        "x": moved(t),
        "F": 0.1 * a + 0.4 * np.sign(v) + 0.2 * v - hand + noise,
        "f": late,
    }
    experiment = td.experiment(
        data,
        axis="prismatic",
        time="t",
        position={"column": "x", "resolution": 1e-4},
        actuator_force="F",
        interaction_force="f",
        inertia=0.1,
        bandwidth=10.0,
        effects=["coulomb", "viscous"],
    )
    finding = the_one(experiment, "time shift")
    assert finding.concern == concern and finding.numbers["interaction_force.lag"] == pytest.approx(
        0.29, abs=0.02
    )
    assert ("no delay before you know it" in finding.sentence) == (concern == "note")


# teleoperators


@pytest.mark.slow
@pytest.mark.parametrize("quantity", ["position", "actuator_force", "interaction_force"])
def test_columns_of_master_and_slave_that_are_swapped_are_named(quantity):
    experiment = load_experiment(shared_folder("hidden/cases") / "007")
    one, two = f"master.{quantity}", f"slave.{quantity}"
    records = tuple(
        replace(r, signals={**r.signals, one: r.signals[two], two: r.signals[one]})
        for r in experiment.records
    )
    finding = the_one(replace(experiment, records=records), "swapped columns")
    assert one in finding.sentence and two in finding.sentence
    assert finding.numbers["swapped"] < 0.1 < finding.numbers["as_given"]


# what a record can show


def shows(experiment, known):
    model = Model.from_experiment(experiment, known)
    findings = ask_fitted("excitation", model, prepare(experiment))
    return {f.topic: f for f in findings}


def test_a_rich_record_shows_every_candidate_and_from_which_size(rod, few):
    findings = shows(rod, few)
    numbers = findings["what the record can show"].numbers
    assert all(numbers[n] < 0.1 for n in SOME if n not in ("coulomb", "viscous"))
    assert "stribeck (extra_static_level from 0.0" in findings["what the record can show"].sentence
    assert "bias and coulomb_asymmetry" in findings["look-alikes"].sentence
    assert findings["motion"].concern == "fine"


def one_way(experiment):
    """A motion that only ever goes on, and the force that a friction of 0.5 N and 0.2 kg take."""
    record = experiment.records[0]
    t = record.time
    v = 0.1 + 0.05 * np.sin(2 * np.pi * 1.3 * t)
    x = 0.1 * t - 0.05 / (2 * np.pi * 1.3) * np.cos(2 * np.pi * 1.3 * t)
    force = 0.2 * np.gradient(v, t) + 0.5 + 1.0 * v
    noise = 1e-3 * np.random.default_rng(0).standard_normal(len(t))
    signals = {
        "device.position": 7.2e-6 * np.round(x / 7.2e-6),
        "device.actuator_force": force + noise,
    }
    channels = {k: c for k, c in experiment.channels.items() if c.quantity != "interaction_force"}
    return replace(experiment, channels=channels, records=(replace(record, signals=signals),))


def test_a_motion_one_way_cannot_show_what_needs_both_and_says_so(rod, few):
    findings = shows(one_way(rod), few)
    summary = findings["what the record can show"]
    assert math.isinf(summary.numbers["coulomb_asymmetry"])
    assert math.isinf(summary.numbers["bias"]), "one way, friction is a constant force"
    assert "same force as coulomb.level" in summary.sentence
    assert "it moves in one direction only" in summary.sentence
    assert "spring (it never returns to an earlier position)" in summary.sentence
    motion = findings["motion"]
    assert motion.numbers["forth"] > 0.99 and motion.numbers["reversals"] == 0
    assert "no interaction force is measured" in motion.sentence


# the whole, long records, the command


def test_what_a_record_can_show_is_not_asked_while_signs_disagree(rod):
    findings = check_experiment(changed(rod, "position", np.negative))
    assert str(findings).count("\n") == len(findings) - 1, "printed, a line for each"
    assert findings._repr_html_().count("<tr>") == len(findings) + 1
    assert findings[-1].sentence.startswith("not checked which effects the record can show")
    assert [f.topic for f in findings if f.concern == "warning"] == ["signs"]


def test_a_body_that_never_moves_is_reported_as_at_rest(rod):
    findings = check_experiment(changed(rod, "position", np.zeros_like))
    assert "device never moves" in findings[-1].sentence


def test_the_command_prints_findings_and_writes_them(short_rod, tmp_path, capsys):
    path = tmp_path / "findings.json"
    assert main(["check", str(short_rod), "--json", str(path)]) == 0
    printed = capsys.readouterr().out
    assert "no warnings." in printed
    assert printed.index("note ") < printed.index("fine ")
    answer = json.loads(path.read_text())["findings"]
    assert {f["concern"] for f in answer} == {"note", "fine"}
    assert {f["topic"] for f in answer} >= {"sample clock", "signs and units", "motion"}


@pytest.mark.slow
def test_shared_measurements_raise_no_false_warning():
    """Of simulated cases none; a delayed command is a note, for physics does that too."""
    topics = {}
    for folder in sorted(shared_folder("hidden/cases").iterdir()):
        warned = [f for f in plausible(load_experiment(folder)) if f.concern == "warning"]
        if warned:
            topics[folder.name] = list(map(str, warned))
    assert topics == {}
