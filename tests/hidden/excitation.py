"""Motions a careful experimenter would ask for: sines, slow ramps with reversals, holds, steps.

Every function returns position and velocity of a trajectory of unit size; `richness` goes from
"poor" (a few low sines at one amplitude) through "normal" to "rich".
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Trajectory = tuple[np.ndarray, np.ndarray]
RICHNESS = ("poor", "normal", "rich")


def edge(t: np.ndarray, start: float, end: float, ramp: float = 0.25) -> np.ndarray:
    """Smooth window: 0 outside [start, end], 1 inside, raised-cosine edges."""
    up = np.clip((t - start) / ramp, 0.0, 1.0)
    down = np.clip((end - t) / ramp, 0.0, 1.0)
    return 0.25 * (1 - np.cos(np.pi * up)) * (1 - np.cos(np.pi * down))


def sines(
    t: np.ndarray, rng: np.random.Generator, low: float, high: float, count: int, corner: float
) -> np.ndarray:
    """Sum of sines of unit rms: constant amplitude below `corner` Hz, acceleration above."""
    f = np.geomspace(low, high, count) * rng.uniform(0.93, 1.07, count)
    amplitude = 1.0 / (1.0 + (f / corner) ** 2) * rng.uniform(0.6, 1.4, count)
    phase = rng.uniform(0, 2 * np.pi, count)
    y = (amplitude[:, None] * np.sin(2 * np.pi * f[:, None] * t + phase[:, None])).sum(0)
    return y / np.sqrt(0.5 * (amplitude**2).sum())


def ramps(t: np.ndarray, start: float, end: float, legs: list[tuple[float, float]]) -> np.ndarray:
    """Constant-speed legs (speed, share of the time) between start and end; stays at the end."""
    share = np.array([s for _, s in legs])
    times = start + (end - start) * np.concatenate([[0.0], np.cumsum(share / share.sum())])
    places = np.concatenate(
        [[0.0], np.cumsum([v * d for (v, _), d in zip(legs, np.diff(times), strict=False)])]
    )
    return np.interp(t, times, places)


def chirp(t: np.ndarray, start: float, end: float, low: float, high: float) -> np.ndarray:
    """Exponential chirp with constant speed amplitude, 1 at the low end."""
    s = np.clip((t - start) / (end - start), 0.0, 1.0)
    rate = np.log(high / low)
    phase = 2 * np.pi * low * (end - start) / rate * (np.exp(rate * s) - 1.0)
    return np.sin(phase) * np.exp(-rate * s) * edge(t, start, end, 0.15)


def steps(t: np.ndarray, start: float, end: float, sizes: np.ndarray, rise: float) -> np.ndarray:
    times = np.linspace(start, end, len(sizes) + 1)[:-1]
    y = np.zeros_like(t)
    last = 0.0
    for at, size in zip(times, sizes, strict=False):
        s = np.clip((t - at) / rise, 0.0, 1.0)
        y += (size - last) * (10 * s**3 - 15 * s**4 + 6 * s**5)
        last = size
    s = np.clip((t - end) / rise, 0.0, 1.0)
    return y - last * (10 * s**3 - 15 * s**4 + 6 * s**5)


def _finish(y: np.ndarray, rate: float) -> Trajectory:
    window = np.hanning(round(0.02 * rate) + 3)  # no jump of speed
    y = np.convolve(y, window / window.sum(), mode="same")
    return y, np.gradient(y) * rate


def fit_record(
    rng: np.random.Generator, rate: float, duration: float, richness: str, top: float
) -> Trajectory:
    """Sines at several amplitudes, slow ramps with reversals, holds."""
    t = np.arange(round(duration * rate)) / rate
    d = duration
    if richness == "poor":
        y = sines(t, rng, 0.3, min(4.0, top), 5, 1.5) * edge(t, 0.3, d - 0.2, 0.5)
        return _finish(y, rate)
    count = 10 if richness == "normal" else 16
    blocks = [(0.03, 0.31, 1.0), (0.60, 0.75, 0.45), (0.75, 0.86, 0.2)]
    y = np.zeros_like(t)
    for a, b, gain in blocks:
        gain *= rng.uniform(0.8, 1.25)
        y += gain * sines(t, rng, 0.4, top, count, rng.uniform(2.0, 3.5)) * edge(t, a * d, b * d)
    v = rng.uniform(0.5, 1.5, 8) * np.array([1.5, -1.5, 0.4, -0.4, 3.0, -3.0, 0.1, -0.1])
    legs = [(float(s), float(rng.uniform(0.7, 1.3))) for s in v]
    y += ramps(t, 0.32 * d, 0.56 * d, legs)
    y -= y[round(0.57 * d * rate)] * np.clip((t - 0.57 * d) / (0.03 * d), 0, 1)
    legs = [(1.5, 1.0), (0.0, 0.6), (-2.4, 1.0), (0.0, 0.6), (0.7, 1.0), (-0.05, 0.6)]
    if richness == "rich":
        legs += [(4.0, 0.5), (-4.0, 0.5), (0.3, 0.8), (-0.3, 0.8)]
    y += rng.uniform(0.7, 1.3) * ramps(t, 0.86 * d, 0.99 * d, legs)
    return _finish(y, rate)


def check_record(
    rng: np.random.Generator, rate: float, duration: float, richness: str, top: float
) -> Trajectory:
    """Chirp, steps, other sines at other amplitudes, a slow triangle."""
    t = np.arange(round(duration * rate)) / rate
    d = duration
    if richness == "poor":
        y = 0.7 * sines(t, rng, 0.5, min(5.0, top), 4, 1.5) * edge(t, 0.3, d - 0.2, 0.5)
        return _finish(y, rate)
    y = rng.uniform(0.8, 1.6) * chirp(t, 0.04 * d, 0.32 * d, 0.7, top)
    sizes = rng.choice([-1, 1], 5) * rng.uniform(0.3, 0.9, 5)
    y += steps(t, 0.34 * d, 0.60 * d, sizes, rng.uniform(0.1, 0.18))
    gain = rng.uniform(0.5, 0.9)
    y += (
        gain
        * sines(t, rng, 0.5, top * 0.95, 9, rng.uniform(2.0, 3.5))
        * edge(t, 0.66 * d, 0.84 * d)
    )
    legs = [(1.0, 1.0), (-1.0, 2.0), (1.0, 1.0), (0.15, 1.0), (-0.15, 1.0)]
    y += rng.uniform(0.8, 1.5) * ramps(t, 0.85 * d, 0.985 * d, legs)
    return _finish(y, rate)


RECORDS: dict[str, Callable[..., Trajectory]] = {"fit": fit_record, "check": check_record}
