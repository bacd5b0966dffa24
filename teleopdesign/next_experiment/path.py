"""Smooth paths within limits: positions over time that a servo can follow.

A path is a polyline of moves at constant speed and holds, smoothed by a raised-cosine window. The
window's length follows from the limits: for a range R of speeds,

    acceleration <= 2 R / T,   jerk <= 4 pi R / T^2

for a window of length T and any line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..measurement.filtering import Array
from .limits import Limits

#: s: rest at each end of a part
REST = 0.3


@dataclass(frozen=True)
class Move:
    """A move to a position at a constant speed."""

    to: float
    speed: float


@dataclass(frozen=True)
class Hold:
    """A rest for some time (s)."""

    time: float


def travel(legs: Sequence[Move | Hold], limits: Limits, *, sample_time: float) -> Array:
    """The smoothed line through these legs, from rest at 0 to rest at the end of the last leg.

    sample_time: s
    returns: positions, shape (n,), one per sample
    """
    times, places, lowest, highest = [0.0], [0.0], 0.0, 0.0
    for leg in legs:
        if isinstance(leg, Hold):
            times.append(times[-1] + leg.time)
            places.append(places[-1])
            continue
        distance = leg.to - places[-1]
        if distance == 0.0:
            continue
        times.append(times[-1] + abs(distance) / leg.speed)
        places.append(leg.to)
        lowest = min(lowest, leg.speed * np.sign(distance))
        highest = max(highest, leg.speed * np.sign(distance))
    width = window_length(highest - lowest, limits)
    margin = REST + 0.5 * width
    t = np.arange(0.0, times[-1] + 2 * margin, sample_time) - margin
    return round_corners(np.interp(t, times, places), width, sample_time)


def window_length(range_of_speed: float, limits: Limits) -> float:
    """Length (s) of the raised cosine that keeps acceleration and jerk within the limits."""
    return max(
        2.0 * range_of_speed / limits.acceleration,
        float(np.sqrt(4.0 * np.pi * range_of_speed / limits.jerk)),
    )


def round_corners(line: Array, width: float, sample_time: float) -> Array:
    """The line after a raised-cosine window of length `width` (s); its ends do not change."""
    samples = max(3, 2 * round(0.5 * width / sample_time) + 1)
    window = np.hanning(samples + 2)[1:-1]
    half = samples // 2
    padded = np.concatenate([np.full(half, line[0]), line, np.full(half, line[-1])])
    return np.asarray(np.convolve(padded, window / window.sum(), mode="valid"))


def sines(
    frequencies: Array, duration: float, limits: Limits, *, share: float, sample_time: float
) -> Array:
    """Sum of sines in a smooth window, as large as the limits allow times `share`.

    frequencies: Hz, shape (k,). Amplitudes fall so that none dominates the acceleration; phases are
        Schroeder's (a low peak for the power)
    """
    t = np.arange(0.0, duration, sample_time)
    k = np.arange(len(frequencies))
    corner = float(np.sqrt(frequencies[0] * frequencies[-1]))
    amplitude = 1.0 / (1.0 + (frequencies / corner) ** 2)
    phase = -np.pi * k * (k + 1) / len(frequencies)
    y = amplitude @ np.sin(2 * np.pi * np.outer(frequencies, t) + phase[:, None])
    y = with_window(y, ramp=min(0.5, 0.2 * duration), sample_time=sample_time)
    return share * y * largest_factor(y, limits, sample_time=sample_time)


def with_window(y: Array, *, ramp: float, sample_time: float) -> Array:
    """The signal with a smooth start and end of length `ramp` (s), and a rest before and after."""
    t = np.arange(len(y)) * sample_time
    rise = np.clip(np.minimum(t, t[-1] - t) / ramp, 0.0, 1.0)
    rest = np.zeros(round(REST / sample_time))
    # sixth order at both ends: no jump of jerk
    return np.concatenate(
        [rest, y * rise**4 * (35 - 84 * rise + 70 * rise**2 - 20 * rise**3), rest]
    )


def largest_factor(y: Array, limits: Limits, *, sample_time: float) -> float:
    """The largest factor by which a path keeps its limits (stroke, speed, acceleration, jerk)."""
    peaks = [y]
    for _ in range(3):
        peaks.append(np.gradient(peaks[-1], sample_time))
    bounds = (limits.high, limits.speed, limits.acceleration, limits.jerk)
    return min(
        bound / max(float(np.abs(p).max()), 1e-300) for bound, p in zip(bounds, peaks, strict=True)
    )
