"""What a sensor errs by: as stated, else as its readings show."""

from types import SimpleNamespace

import numpy as np
import pytest

from teleopdesign.diagnose.noise_floor import sensor_of
from teleopdesign.measurement.channel import Channel

TIME = np.arange(4000) * 1e-3


def channel(quantity, *, resolution=None, noise=None, measured=False):
    return Channel(quantity, "device", quantity, "N", resolution, noise, measured=measured)


def sensor(one, readings, *, step=1e-5):
    """The sensor of a channel of a body whose encoder's step is stated."""
    channels = {"device.position": channel("position", resolution=step), "device.it": one}
    return sensor_of(SimpleNamespace(channels=channels), "device.it", readings)


def readings(noise, *, step=0.0, seed=1):
    """A force that varies as a hand's does, read with noise and in steps."""
    force = 2.0 * np.sin(2 * np.pi * 3 * TIME) + 0.3 * np.sin(2 * np.pi * 11 * TIME)
    read = force + noise * np.random.default_rng(seed).standard_normal(len(TIME))
    return step * np.round(read / step) if step else read


@pytest.mark.parametrize("noise", [0.003, 0.05, 0.4])
@pytest.mark.parametrize("step", [0.0, 0.5, 2.0])
def test_the_noise_of_a_measured_force_of_which_none_is_stated_is_that_of_its_readings(noise, step):
    """Beside the steps of its converter, which are drawn by themselves."""
    for quantity, measured in [("interaction_force", False), ("actuator_force", True)]:
        one = channel(quantity, resolution=step * noise or None, measured=measured)
        reading = sensor(one, readings(noise, step=step * noise))
        assert reading.noise == pytest.approx(noise, rel=0.15) and reading.step == step * noise


def test_noise_that_is_stated_is_believed():
    for quantity, measured in [("interaction_force", False), ("actuator_force", True)]:
        one = channel(quantity, noise=0.01, measured=measured)
        assert sensor(one, readings(0.3)).noise == 0.01
        none = channel(quantity, noise=0.0, measured=measured)
        assert sensor(none, readings(0.3)).noise == 0.0, "none is a statement, too"
