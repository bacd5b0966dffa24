"""Stages of the actuation along a motion: a command some time later, and one that lags."""

import numpy as np
import pytest

from teleopdesign.realise.stages_along import _delay_samples


@pytest.mark.parametrize("steps", [0, 1, 7, 40, 41, 1_000])
def test_a_signal_some_steps_delay_samples_is_held_before_it_begins(steps):
    y = np.random.default_rng(1).normal(size=(2, 40))
    expected = y[:, np.clip(np.arange(40) - steps, 0, None)]
    assert (_delay_samples(y, steps) == expected).all()
