"""Currents and voltages in the steps of a driver, which no name tells from amperes and volts."""

import numpy as np
import pytest
from measurement.columns_by_hand import Q, T, U, look

HINT = "steps of a driver"


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("Present Current(raw)", "A: "),
        ("motor current", "A: "),
        ("iq", "A: "),
        ("voltage", "V: "),
    ],
)
def test_whole_numbers_of_a_current_may_be_steps_of_a_driver(name, unit):
    """A servo's current of 104 steps was 104 A, and nothing said that it may be another unit."""
    steps = np.round(200.0 * U / np.ptp(U))
    why = look({"t": T, "angle_rad": Q, name: steps}).guesses["channels.actuator_force.unit"]
    assert why.startswith(unit)
    assert HINT in why
    assert f"from {steps.min():g} to {steps.max():g}" in why


@pytest.mark.parametrize(
    "readings",
    [200.0 * U / np.ptp(U), np.round(8.0 * U / np.ptp(U)), np.round(1e3 * U) / 1e3],
    ids=["parts of an ampere", "few steps", "a thousandth"],
)
def test_other_readings_of_a_current_are_amperes(readings):
    guesses = look({"t": T, "angle_rad": Q, "motor current": readings}).guesses
    assert HINT not in guesses["channels.actuator_force.unit"]


def test_a_stated_unit_is_no_guess():
    survey = look({"t": T, "angle_rad": Q, "current_mA": np.round(200.0 * U / np.ptp(U))})
    assert "channels.actuator_force.unit" not in survey.guesses
