"""Short logs without names: four columns of a motion explain any few values of another column."""

import numpy as np
import pytest
from measurement.columns_by_hand import look

from teleopdesign.base.errors import ExperimentError


def motion(seconds, rate):
    """Time, position and force of a body with dry friction, as an encoder and a drive log them."""
    t = np.arange(round(seconds * rate)) / rate
    q = np.sin(2 * np.pi * 0.8 * t) + 0.2 * np.sin(2 * np.pi * 2.3 * t)
    v = np.gradient(q, t)
    return t, np.round(q, 4), 0.02 * np.gradient(v, t) + 0.3 * np.sign(v)


@pytest.mark.parametrize("seed", range(5))
def test_noise_is_no_force_where_few_values_tell(seed):
    """Voltage, current and speed of a motor at rest for 1 s: 100 % of one was explained."""
    t, _, _ = motion(1.0, 100.0)
    noise = np.cumsum(np.random.default_rng(seed).standard_normal((3, len(t))), axis=1)
    columns = {f"column {k + 2}": np.round(x, 4) for k, x in enumerate(noise)}
    with pytest.raises(ExperimentError, match="are too few to show which column moves the body"):
        look({"column 1": t, **columns})


@pytest.mark.parametrize(("seconds", "rate"), [(6.0, 100.0), (1.5, 1000.0), (8.0, 25.0)])
def test_the_force_of_a_longer_or_faster_log_is_shown(seconds, rate):
    t, q, force = motion(seconds, rate)
    survey = look({"column 1": t, "column 2": q, "column 3": force})
    assert survey.channels["actuator_force"]["column"] == "column 3"


def test_a_name_or_an_option_tells_the_force_of_a_short_log():
    t, q, force = motion(1.2, 100.0)
    survey = look({"time": t, "q": q, "torque": force})
    assert survey.channels["actuator_force"]["column"] == "torque"
    columns = {"column 1": t, "column 2": q, "column 3": force}
    survey = look(columns, position="column 2", actuator_force="column 3")
    assert survey.channels["actuator_force"]["column"] == "column 3"
