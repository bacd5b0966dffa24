"""A speed that a program computed from two rows is no force, whatever the clock of the log."""

import numpy as np
import pytest
from measurement.columns_by_hand import column, look

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.survey.derivative import has_signs_of_steps


def computed_speed():
    """Stamps of bursts, and counts of an encoder with the speed a program computes from two rows.

    The program waits for 0.12 s after each seventh row, and takes the time in between from a clock
    of its own.
    """
    steps = np.where(np.arange(700) % 7 == 0, 0.12, 0.0003)
    clock = np.cumsum(steps)
    angle = np.round(80.0 * np.sin(1.9 * clock) / 0.45) * 0.45
    speed = np.diff(angle, prepend=angle[0]) / steps
    return clock, angle, np.round(speed, 2)


def test_a_speed_computed_on_an_uneven_clock_is_no_force():
    clock, angle, speed = computed_speed()
    table = {"column 1": np.floor(1e3 * clock), "column 2": angle, "column 3": speed}
    with pytest.raises(ExperimentError, match="column 3 is taken for a velocity, --force"):
        look(table, time="column 1")
    assert look(table, time="column 1", actuator_force="column 3"), "the user knows"
    survey = look({**table, "current [A]": 0.1 + np.cos(3.1 * clock)}, time="column 1")
    assert survey.unused["column 3"].startswith("a velocity by its signs, those of the steps")
    with pytest.raises(ExperimentError, match="'column 1' never falls and may be a coarse time"):
        look(table)


def test_a_force_moves_a_body_later_and_holds_it_at_rest():
    _, angle, speed = computed_speed()
    steps = column("x", angle)
    assert has_signs_of_steps(steps, column("column 3", speed))
    assert not has_signs_of_steps(steps, column("torque", speed))
    assert not has_signs_of_steps(steps, column("column 3", np.roll(speed, 1)))
    assert not has_signs_of_steps(steps, column("column 3", speed + 0.1)), "it holds the body"
    assert not has_signs_of_steps(column("x", np.abs(angle).cumsum()), column("c", np.abs(speed)))
    assert not has_signs_of_steps(steps, column("column 3", speed[:-1]))
    assert not has_signs_of_steps(steps, column("column 3", np.full(len(speed), np.nan)))


def test_the_speeds_and_errors_of_two_axes_without_names_are_no_forces():
    """A ball on a plate: places, speeds, and the errors of both with the other sign."""
    clock = np.cumsum(0.017 + 0.002 * np.random.default_rng(4).standard_normal(400))
    table = {}
    for k, place in enumerate((90.0 * np.sin(1.3 * clock), 60.0 * np.sin(0.8 * clock + 1.0))):
        place = np.round(place)
        speed = np.round(np.diff(place, prepend=place[0]) / np.gradient(clock), 3)
        signals = (place, speed, 7.0 - place, -speed)
        table |= {f"column {k + 1 + 2 * i}": x for i, x in enumerate(signals)}
    table = dict(sorted(table.items()))
    with pytest.raises(ExperimentError, match="found no column that could be a force"):
        look(table, sample_rate=60.0)
    force = np.cos(2.1 * clock) + 0.3
    survey = look({**table, "current [A]": force}, sample_rate=60.0, position="column 1")
    assert survey.channels["actuator_force"]["column"] == "current [A]"
    assert survey.unused["column 7"].startswith("a velocity by its signs")
    assert survey.unused["column 2"].startswith("another position: 'column")


def test_the_error_of_a_speed_loop_is_no_force():
    """A loop of speed: set value, reading, error, and the sum of the errors, no header."""
    t = 0.02 * np.arange(300)
    reading = 0.3 + 0.25 * np.random.default_rng(7).standard_normal(len(t))
    error = np.round(12.0 - 3.4 * reading, 4)
    signals = (np.full(len(t), 12.0), np.round(reading, 4), error, 30.0 + 0.02 * np.cumsum(error))
    table = {f"column {k + 1}": x for k, x in enumerate(signals)} | {"column 5": t}
    with pytest.raises(ExperimentError, match="are taken for a velocity, --force"):
        look(table, time="column 5", position="column 4")
    names = {"column 2": "torque"}
    survey = look({names.get(n, n): x for n, x in table.items()}, time="column 5")
    assert survey.channels["actuator_force"]["column"] == "torque", "a virtual damper"
