"""A force of the hand that its sensor makes late belongs to the record: no missing effect."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose.simulated_cases import FEW, write_simulated
from scipy.signal import lfilter

import teleopdesign as td
from teleopdesign.diagnose.answer import answer
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.record_shift import name_of_hand
from teleopdesign.effects import EFFECTS
from teleopdesign.measurement.prepare import prepare
from teleopdesign.show.diagnose.text import ladder_text

pytestmark = pytest.mark.slow  # diagnoses of whole cases

HAND = name_of_hand("device")
#: the first one whose device is held by a hand of measured force
SEED = 1
#: what a late force resembles, and what it does not
LATE = ("actuator_lag", "actuation_delay", "added_inertia", "stribeck", "viscous")
#: a late force of the hand was named one of these
KNOWN = {n: EFFECTS[n] for n in (*FEW, "actuator_lag", "actuation_delay")}


def filtered(experiment, seconds):
    """The experiment with a hand's force that a first-order low-pass filtered."""

    def logged(record):
        late = 1.0 - np.exp(-record.sample_time / seconds)
        force = record.signals[HAND]
        return replace(
            record,
            signals={**record.signals, HAND: lfilter([late], [1.0, late - 1.0], force)},
        )

    return replace(experiment, records=tuple(logged(r) for r in experiment.records))


@pytest.fixture(scope="module")
def adequate(tmp_path_factory):
    """A simulated device whose model is right, with a hand whose force is measured."""
    experiment = td.load_experiment(
        write_simulated(tmp_path_factory.mktemp("own") / "null", None, seed=SEED)
    )
    assert HAND in experiment.channels
    return experiment


@pytest.fixture(scope="module")
def late(adequate):
    return filtered(adequate, 5e-3)


@pytest.fixture(scope="module")
def diagnosis(late):
    return td.find_missing(late, td.Model.from_experiment(late, KNOWN))


def test_the_filter_of_the_hands_sensor_is_reported_and_nothing_is_missing(adequate, diagnosis):
    assert diagnosis.verdict == "model_adequate"
    shift = answer(diagnosis)["record_shift"][HAND]
    assert shift["value"] == pytest.approx(5e-3, rel=0.15)
    assert shift["stderr"] < 1e-3
    assert "force of the hand at device" in ladder_text(diagnosis)
    right = estimate(td.Model.from_experiment(adequate), prepare(adequate))
    assert diagnosis.after.check_error < 1.5 * right.check_error
    for name, value in right.model.parameters.items():
        there = diagnosis.model.parameters[name].value
        assert there == pytest.approx(value.value, rel=0.03, abs=5 * value.stderr)


@pytest.mark.parametrize("effect", ["actuator_lag"])
def test_what_is_missing_keeps_its_name_beside_a_hand_in_time_or_late(tmp_path, effect):
    """A lag of the command is no lag of the sensor: the motion tells which force is late."""
    experiment = td.load_experiment(write_simulated(tmp_path / "case", effect, seed=SEED))
    for logged in (experiment, filtered(experiment, 5e-3)):
        diagnosis = td.find_missing(logged, among=LATE)
        assert [c.effect.name for c in diagnosis.missing] == [effect]
        assert (HAND in diagnosis.model.record_shift) == (logged is not experiment)
