"""What the readings of a position show of its encoder: their noise and their step."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def reading_noise(position: Array) -> float:
    """Rms noise of one position reading, from its content near the Nyquist frequency."""
    fourth = np.diff(position, 4)
    # white noise passes a fourth difference with gain sqrt(70); the median ignores sharp motion
    return float(np.median(np.abs(fourth)) / 0.6745 / np.sqrt(70.0))


def reading_step(position: Array) -> float:
    """Smallest step between neighbouring values that the readings take: the encoder's, if any.

    In a motion that never comes back to a place, values lie apart by the travel of a sample: then
    the step is the one whose rounding looks like the noise that is seen.
    """
    values = np.unique(position)
    if len(values) < 2:
        return 0.0
    gaps = np.diff(values)
    step = float(np.quantile(gaps[gaps > 1e-9 * np.ptp(values)], 0.002))
    rounding = float(np.sqrt(12.0)) * reading_noise(position)
    moving = float(np.mean(np.diff(position) != 0)) > 0.5
    # readings that are all alike in their fourth difference show no noise at all
    is_noisy = rounding > 1e-9 * float(np.ptp(position))
    return min(step, rounding) if is_noisy and moving and step > 3.0 * rounding else step
