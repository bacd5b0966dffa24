"""The unit of a log's stamps where nothing says it, from both sides of each limit."""

import numpy as np
import pytest

from teleopdesign.measurement.stamps import unit_of_steps


@pytest.mark.parametrize(
    ("step", "unit"),
    [
        (1e-4, "s"),
        (0.19, "s"),
        (0.21, "ms"),
        (0.25, "ms"),
        (1.0, "ms"),
        (199.0, "ms"),
        (200.0, "us"),
        (201.0, "us"),
        (1.9e5, "us"),
        (199_999.0, "us"),
        (200_000.0, "ns"),
        (2.1e5, "ns"),
        (1e6, "ns"),
        (1e9, "ns"),
    ],
)
def test_a_log_has_from_five_rows_a_second_to_a_hundred_thousand(step, unit):
    stamps = 1e6 + step * np.arange(300)
    guess, why = unit_of_steps(stamps)
    assert guess == unit and (why == "") == (unit == "s")
    assert unit == "s" or f"only in {unit} are steps of {step:.4g}" in why
    # a row that says no time, and some that go back, change nothing
    stamps[[50, 90]] = np.nan
    stamps[100:] -= 40 * step
    assert unit_of_steps(stamps)[0] == unit


def test_seconds_that_are_too_fine_are_a_guess():
    assert unit_of_steps(9e-6 * np.arange(400_000)) == (
        "s", "s: only in s are steps of 9e-06 usual for a log"
    )  # fmt: skip


@pytest.mark.parametrize(
    ("step", "length", "unit"),
    [
        (0.001, 60.0, "day"),
        (0.19, 60.0, "day"),
        (0.21, 60.0, "s"),  # steps of 2.4e-6: no day's log, nor is it in seconds a long one
        (0.001, 0.9, "s"),  # in days less than a second long
        (0.1, 85_000.0, "day"),
        (0.15, 87_000.0, "s"),  # in seconds longer than a second
    ],
)
def test_steps_of_a_spreadsheet_are_days(step, length, unit):
    """Seconds of which 86 400 are one."""
    stamps = 46_000.0 + np.arange(0.0, length, step) / 86_400.0
    assert unit_of_steps(stamps - 46_000.0)[0] == unit
