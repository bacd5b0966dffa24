"""Lock-in over whole cycles: phasors, distortion, settling."""

import numpy as np
import pytest

from teleopdesign.frequency.sinusoid import lock_in


def test_a_cycle_need_not_be_a_whole_number_of_steps():
    step, frequency = 1e-4, 17.3
    time = step * np.arange(round(5 / frequency / step))
    response = lock_in(
        np.sin(2 * np.pi * frequency * time + 0.5), step=step, frequency=17.3, points=578
    )
    # (omega step)^2/8 = 1.5e-5 is what linear interpolation leaves
    assert response.phasor == pytest.approx(np.exp(0.5j), abs=2e-5)
    assert response.unsettled < 2e-5


def test_a_drifting_amplitude_is_not_steady():
    time = 1e-3 * np.arange(5001)
    response = lock_in(
        (1 + 0.1 * time) * np.sin(2 * np.pi * time), step=1e-3, frequency=1.0, points=1000
    )
    # a tenth a cycle over the three cycles from the second to the last, of 1.4 on average
    assert response.unsettled == pytest.approx(3 * 0.1 / 1.4, rel=0.02)


def test_a_turning_transient_does_not_pass_for_steady():
    """Its cycles come in pairs that agree; those of the second half of the record do not."""
    time = 1e-3 * np.arange(8001)
    pairs = 1 + 0.1 * (np.floor(time / 2) % 2)
    response = lock_in(pairs * np.sin(2 * np.pi * time), step=1e-3, frequency=1.0, points=1000)
    assert response.unsettled == pytest.approx(0.1 / 1.1, rel=0.02)
