"""What a channel's keys say of its column, at their limits."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError

T = np.arange(400) / 200.0


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
