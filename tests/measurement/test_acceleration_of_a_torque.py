"""Two columns without names: a torque and its acceleration are no position and its force."""

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.from_arrays import log_of
from teleopdesign.measurement.survey import Choices, survey_log


def motion(seed):
    """Time, position, acceleration and force of a body with friction that moves by three tones."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, 6.0, 0.005)
    x, v, a = np.zeros((3, len(t)))
    for w in 2 * np.pi * random.uniform(0.3, 2.0, 3):
        wave = random.uniform(0.5, 1.0) / w * np.exp(1j * (w * t + random.uniform(0.0, 6.0)))
        x, v, a = x + wave.imag, v + w * wave.real, a - w**2 * wave.imag
    friction = 0.5 * np.std(a) * np.tanh(v / (0.01 * np.std(v))) + 0.3 * v
    return t, x, a, 0.03 * (a + friction)  # inertia 0.03 kg*m^2


def names_of_channels(first, second, t):
    log = log_of({"t": t, "m": first, "imu": second})
    channels = survey_log(log, "log.csv", Choices()).channels
    return channels["position"]["column"], channels["actuator_force"]["column"]


@pytest.mark.parametrize("seed", range(5))
def test_an_acceleration_is_no_force_on_the_torque_that_causes_it(seed):
    t, x, a, force = motion(seed)
    noise = 0.003 * np.random.default_rng(seed).standard_normal(len(t))
    with pytest.raises(ExperimentError, match="a force and the acceleration that it causes"):
        names_of_channels(force, a * (1.0 + noise), t)
    assert names_of_channels(np.round(x, 3), force, t) == ("m", "imu")
