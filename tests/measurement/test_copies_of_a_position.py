"""Logs without names that hold the position twice: as control error, or in another unit."""

from __future__ import annotations

import numpy as np
import pytest
from measurement.columns_by_hand import look

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.survey import Survey
from teleopdesign.measurement.survey.copies import is_copy, pulls_back

ROWS, STEP = 600, 0.01


def loop(law):
    """Command and position, in whole numbers, of a motor under a law of its control error."""
    x = v = u = 0.0
    held = np.zeros((ROWS, 2))
    for row in range(ROWS):
        held[row] = u, np.round(x)
        for _ in range(10):
            v += STEP / 10 * (60.0 * u - 8.0 * v - 90.0 * np.tanh(v))
            x += STEP / 10 * v
        u = law(135.0 - np.round(x))
    return held[:, 0], held[:, 1]


def survey(**columns) -> Survey:
    return look(columns, sample_rate=1.0 / STEP)


@pytest.mark.parametrize(
    "law",
    [
        pytest.param(lambda e: 100.0 * np.sign(e), id="relay"),
        pytest.param(lambda e: float(np.clip(10.0 * e, -100.0, 100.0)), id="saturated gain"),
    ],
)
def test_the_error_of_a_controller_is_neither_position_nor_force(law):
    command, angle = loop(law)
    result = survey(**{"column 1": command, "column 2": angle, "column 3": 135.0 - angle})
    assert result.channels["position"]["column"] == "column 2"
    assert result.channels["actuator_force"]["column"] == "column 1"
    assert result.unused["column 3"].startswith("'column 2' times a constant plus a constant")


def pushed():
    """A piston pushed to and fro at a constant speed: position, force with its pressure."""
    t = STEP * np.arange(ROWS)
    x = 30.0 * np.abs(t % 4.0 / 2.0 - 1.0)
    noise = 0.05 * np.random.default_rng(2).standard_normal(ROWS)
    return x, 100.0 + 9.0 * np.sign(np.gradient(x)) + noise


def test_a_position_in_volts_and_in_mm_is_one_position():
    x, f = pushed()
    result = survey(a=np.round(4.5 + x / 13.3, 3), b=np.round(x, 3), c=np.round(f, 2))
    position = result.channels["position"]["column"]
    assert result.channels["actuator_force"]["column"] == "c"
    assert "another unit" in result.unused[{"a": "b", "b": "a"}[position]]


def test_only_a_copy_to_the_last_digit_is_a_copy():
    x = 15.0 + 15.0 * np.sin(STEP * np.arange(ROWS))
    spring = 2.0 * x + 0.05 * np.random.default_rng(3).standard_normal(ROWS)
    assert is_copy(np.round(2.0 * x, 2), np.round(x, 2))
    assert not is_copy(spring, np.round(x, 2))
    assert not is_copy(np.sign(x - 15.0), np.round(x, 2))


def test_a_log_of_positions_alone_has_no_force():
    x, _ = pushed()
    with pytest.raises(ExperimentError, match="no column that could be a force"):
        survey(a=np.round(x, 3), b=np.round(2.0 * x, 3))


def test_a_named_command_in_proportion_to_the_position_is_a_force():
    x, _ = pushed()
    result = survey(angle=np.round(x, 3), u=np.round(10.0 * (15.0 - x), 3))
    assert result.channels["actuator_force"]["column"] == "u"


@pytest.mark.parametrize("damper", [0.0, 0.05])
def test_the_damper_of_a_controller_that_pulls_back_is_no_wrong_sign(damper):
    """A hand moves it. `new` took the position with the opposite sign."""
    t = STEP * np.arange(ROWS)
    x = np.round(0.4 * np.sin(2.1 * t) * np.sin(0.7 * t), 4)
    u = np.round(-1.5 * x - damper * np.diff(x, prepend=x[0]) / STEP, 5)
    noise = 0.01 * np.random.default_rng(1).standard_normal(ROWS)
    assert pulls_back(u, x, STEP) and not pulls_back(-u, x, STEP)
    assert not pulls_back(u + noise, x, STEP)
    names = "time", "angle (rad)", "torque (Nm)"
    for torque, sign in (u, 1), (u + noise, -1 if damper else 1):
        position = survey(**dict(zip(names, (t, x, torque), strict=True))).channels["position"]
        assert position.get("sign", 1) == sign
