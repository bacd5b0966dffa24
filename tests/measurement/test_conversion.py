"""What a channel's keys say of its column, at their limits."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError

T = np.arange(400) / 200.0


def made(axis="revolute", position=None, force=None):
    metric = axis == "prismatic"
    channels = {
        "position": {"column": "x", "unit": "m" if metric else "rad"} | (position or {}),
        "actuator_force": {"column": "y", "unit": "N" if metric else "N*m"} | (force or {}),
    }
    table = {"t": T, "x": np.sin(T), "y": np.cos(T)}
    return td.experiment(table, axis=axis, inertia=1.0, **channels)


@pytest.mark.parametrize("counts", [0.5, 1.0, 4096.0])
def test_any_number_of_counts_above_none_is_a_turn(counts):
    experiment = made(position={"unit": "counts", "counts_per_turn": counts})
    signal = experiment.records[0].signals["device.position"]
    assert signal == pytest.approx(np.sin(T) * 2 * np.pi / counts)


@pytest.mark.parametrize("period", [0.25, 0.5, 3.0])
def test_a_column_may_wrap_at_less_than_one(period):
    table = {"t": T, "x": np.mod(T, period), "y": np.cos(T)}
    position = {"column": "x", "unit": "rad", "unwrap": period}
    experiment = td.experiment(
        table, axis="revolute", inertia=1.0, position=position, actuator_force="y"
    )
    assert experiment.records[0].signals["device.position"] == pytest.approx(T)


@pytest.mark.parametrize(("axis", "unit"), [("revolute", r"N\*m/A"), ("prismatic", "N/A")])
@pytest.mark.parametrize("current", ["A", "mA"])
def test_a_current_asks_for_the_constant_of_such_a_motor(axis, unit, current):
    with pytest.raises(ExperimentError, match=f'torque_constant = .*unit = "{unit}"'):
        made(axis, force={"unit": current})


@pytest.mark.parametrize("ratio", [0, -2.0])
def test_no_gear_ratio_stands_still_or_turns_back(ratio):
    with pytest.raises(ExperimentError, match=f"gear_ratio: found {ratio:g}, expected "):
        made(position={"gear_ratio": ratio})


def test_a_channel_without_keys_is_neither_late_nor_measured():
    plain = made().channels
    assert not plain["device.actuator_force"].measured
    assert plain["device.position"].delay == plain["device.actuator_force"].delay == 0.0
    late = made(position={"delay": {"value": 5, "unit": "ms"}}, force={"measured": True}).channels
    assert late["device.position"].delay == pytest.approx(0.005)
    assert late["device.actuator_force"].measured
    assert late["device.actuator_force"].delay == 0.0


@pytest.mark.parametrize(
    ("key", "bits", "counts"),
    [("twos_complement", 16, 65536), ("twos_complement", 12, 4096), ("sign_bit", 10, None)],
)
def test_signed_numbers_that_were_logged_as_counts_are_decoded(key, bits, counts):
    numbers = np.round(300.0 * np.cos(7.0 * T))
    negative = 1024.0 - numbers if counts is None else counts + numbers
    table = {"t": T, "x": np.sin(T), "y": np.where(numbers < 0, negative, numbers)}
    force = {"column": "y", "unit": "N*m", "scale": 0.5, key: bits}
    made_of = {"axis": "revolute", "inertia": 1.0, "position": {"column": "x", "unit": "rad"}}
    experiment = td.experiment(table, actuator_force=force, **made_of)
    signal = experiment.records[0].signals["device.actuator_force"]
    np.testing.assert_array_equal(signal, 0.5 * numbers)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"twos_complement": 16, "sign_bit": 10}, "found beside sign_bit, expected one"),
        ({"twos_complement": 1}, "found 1, expected a whole number from 2 to 52"),
        ({"sign_bit": 1.5}, "found 1.5, expected a whole number from 1 to 52"),
        ({"scale": 1.0, "twos_complement": 8}, "found a reading of 300, expected less than 256"),
    ],
)
def test_a_code_of_signed_numbers_that_cannot_be_is_refused(keys, message):
    table = {"t": T, "x": np.sin(T), "y": np.linspace(0.0, 300.0, len(T))}
    made_of = {"axis": "revolute", "inertia": 1.0, "position": {"column": "x", "unit": "rad"}}
    with pytest.raises(ExperimentError, match=message):
        td.experiment(table, actuator_force={"column": "y", "unit": "N*m"} | keys, **made_of)
