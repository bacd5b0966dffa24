"""A hum of the mains in a force is told, what moves at that frequency is not called one."""

from dataclasses import replace

import numpy as np
import pytest
from check.made_channels import ask

import teleopdesign as td
from teleopdesign.measurement.motion import without_mains


@pytest.fixture(scope="module")
def rod():
    return td.load_experiment(td.example("rod"))


def humming(rod, key, frequency, share):
    first = rod.fit_records[0]
    y = first.signals[key]
    tone = np.sqrt(2) * share * y.std() * np.sin(2 * np.pi * frequency * first.time + 1)
    record = replace(first, signals={**first.signals, key: y + tone})
    return replace(rod, records=(record,))


def hums(experiment):
    return ask("force_readings", experiment, "hum")


@pytest.mark.parametrize("frequency", [50.0, 60.0, 49.93])
@pytest.mark.parametrize("key", ["device.interaction_force", "device.actuator_force"])
def test_a_tenth_of_hum_is_reported_with_its_size(rod, key, frequency):
    (one,) = hums(humming(rod, key, frequency, 0.1))
    y = rod.fit_records[0].signals[key]
    assert one.concern == "warning"
    assert one.numbers["rms"] == pytest.approx(0.1 * y.std(), rel=0.25)  # the window's scallop


def test_a_weak_hum_is_a_note_and_taken_off_too(rod):
    """Of a hundredth of the force, which is about the noise of this one."""
    spoilt = humming(rod, "device.interaction_force", 50.0, 0.01)
    (one,) = hums(spoilt)
    assert one.concern == "note" and "% of the channel" in one.sentence
    clean = rod.fit_records[0].signals["device.interaction_force"]
    left = without_mains(spoilt.records[0], "device.interaction_force") - clean
    # what the force itself has at that frequency goes with it
    assert np.sqrt(np.mean(left**2)) < 0.2 * 0.01 * clean.std()


def test_no_hum_is_reported_where_there_is_none(rod):
    assert hums(rod) == []
    assert hums(humming(rod, "device.actuator_force", 35.0, 0.1)) == []


def test_a_motion_of_fifty_hertz_is_no_hum(rod):
    one = humming(rod, "device.actuator_force", 50.0, 0.1)
    record = one.records[0]
    x = record.signals["device.position"]
    moved = x + 0.02 * x.std() * np.sin(2 * np.pi * 50 * record.time)
    record = replace(record, signals={**record.signals, "device.position": moved})
    assert hums(replace(one, records=(record,))) == []


@pytest.mark.parametrize("frequency", [50.0, 60.0, 49.93])
@pytest.mark.parametrize("key", ["device.interaction_force", "device.actuator_force"])
def test_a_hum_is_taken_off_the_force_and_nothing_else_is(rod, key, frequency):
    first = rod.fit_records[0]
    clean, spoilt = first.signals[key], humming(rod, key, frequency, 0.1).records[0]
    left = without_mains(spoilt, key) - clean
    # ends are off by what the force itself has at that frequency
    assert np.sqrt(np.mean(left**2)) < 0.02 * 0.1 * clean.std()
    assert without_mains(first, key) is clean
