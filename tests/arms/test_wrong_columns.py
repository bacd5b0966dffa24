"""Columns of an arm that contradict each other: what is wrong with which is said, and stops."""

from dataclasses import replace

import numpy as np
import pytest
from arms.arm_simulator import random_arm, write_experiment

import teleopdesign as td
from teleopdesign.check import look_at, stopping_findings
from teleopdesign.model import Model


def load_arm(folder, hidden=None, late=0.0):
    generator = np.random.default_rng([77, 3])
    arm = random_arm(generator, 3)
    written = write_experiment(folder, arm, generator, hidden, seconds=6.0, late=late)
    return td.load_experiment(written)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return load_arm(tmp_path_factory.mktemp("made") / "arm")


def read_as(experiment, signals):
    """The experiment with other signals: channel -> (channel that it is read from, factor)."""
    records = tuple(
        replace(r, signals={**r.signals, **{n: f * r.signals[s] for n, (s, f) in signals.items()}})
        for r in experiment.records
    )
    return replace(experiment, records=records)


def opposite(*keys):
    return {key: (key, -1.0) for key in keys}


def exchange(quantity, one, two):
    a, b = f"joint{one}.{quantity}", f"joint{two}.{quantity}"
    return {a: (b, 1.0), b: (a, 1.0)}


def stops(experiment, model=None):
    return [f for f in stopping_findings(look_at(experiment, model)) if f.topic == "arm columns"]


U, Q = "actuator_force", "position"


def turned(*keys):
    return opposite(*keys), [f"{key} has the opposite sign" for key in keys]


def exchanged(one, two, *quantities):
    signals, words = {}, []
    for quantity in quantities:
        signals |= exchange(quantity, one, two)
        columns = f"joint{one}.{quantity} and joint{two}.{quantity}"
        words.append(f"the columns of {columns} are exchanged")
    return signals, words


FAULTS = [
    turned(f"joint2.{U}"),
    turned(f"joint1.{U}"),
    turned(f"joint3.{Q}"),
    exchanged(1, 2, U),
    exchanged(2, 3, Q),
    turned(f"joint2.{U}", f"joint2.{Q}"),  # the opposite axis
    exchanged(2, 3, Q, U),  # the names of two joints
    turned(f"joint1.{U}", f"joint3.{U}"),
    turned(f"joint1.{U}", f"joint2.{U}", f"joint3.{U}"),
]


@pytest.mark.parametrize(
    ("signals", "words"),
    # one of a kind in the plain run
    [
        pytest.param(*f, marks=pytest.mark.slow if i in (1, 4, 8) else ())
        for i, f in enumerate(FAULTS)
    ],
    ids=range(len(FAULTS)),
)
def test_a_wrong_sign_or_place_of_columns_has_its_line(arm, signals, words):
    (finding,) = stops(read_as(arm, signals))
    assert all(one in finding.sentence for one in words)
    assert finding.sentence.count("opposite sign") + finding.sentence.count("exch") == len(words)
    # 1 % of white noise through 8 of 50 Hz: 0.4 %
    assert finding.numbers["otherwise"] < 0.006 < 0.05 < finding.numbers["as_given"]


@pytest.mark.parametrize(("joint", "factor"), [(1, 0.5), (2, 2.0), (2, 100.0)])
def test_a_wrong_torque_constant_has_a_line_with_the_scale_that_mends_it(arm, joint, factor):
    key = f"joint{joint}.{U}"
    (finding,) = stops(read_as(arm, {key: (key, factor)}))
    times = float(finding.sentence.partition(f"{key} is multiplied by ")[2].split()[0])
    # the noise of 1 % of the force over 1000 rows, less as the joints push each other
    assert times == pytest.approx(1.0 / factor, rel=0.02)


def test_a_stated_actuator_gain_is_no_wrong_torque_constant(arm):
    experiment = read_as(arm, {f"joint2.{U}": (f"joint2.{U}", 2.0)})
    model = Model.from_experiment(experiment)
    model = model.with_effect(model.known["actuator_gain"], at="joint2")
    assert stops(experiment)
    assert not stops(experiment, model)


def test_an_exchange_of_columns_with_other_torque_constants_needs_no_scale(arm):
    """The torque constant stays with the joint where the names of the columns are corrected."""
    key = f"joint2.{U}"
    channel = arm.channels[key]
    fourfold = replace(channel, conversion=replace(channel.conversion, factor=4.0))
    other = replace(arm, channels={**arm.channels, key: fourfold})
    wrong = {key: (f"joint1.{U}", 4.0), f"joint1.{U}": (key, 0.25)}
    (finding,) = stops(read_as(other, wrong))
    assert f"the columns of joint1.{U} and {key} are exchanged" in finding.sentence
    assert "multiplied" not in finding.sentence


@pytest.mark.parametrize(
    ("hidden", "late"),
    [
        pytest.param(None, 0.0, marks=pytest.mark.slow),
        pytest.param(("load_dependent_friction", 1, 1.5), 0.0, marks=pytest.mark.slow),
        (("presliding", 1, 1.5), 0.75),
        pytest.param(("spring", 0, 1.5), -1.0, marks=pytest.mark.slow),
    ],
)
def test_what_a_model_lacks_is_no_wrong_column(tmp_path, hidden, late):
    assert not stops(load_arm(tmp_path / "arm", hidden, late))


def test_a_diagnosis_names_no_effect_while_a_column_is_wrong(arm):
    diagnosis = td.find_missing(read_as(arm, exchange(U, 2, 3)))
    assert diagnosis.verdict == "undecided" and not diagnosis.missing
    assert f"joint2.{U} and joint3.{U} are exchanged" in str(diagnosis)
    assert not any(one.missing for one in diagnosis.joints.values())
