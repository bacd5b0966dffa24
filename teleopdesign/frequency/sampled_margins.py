"""Margins of a loop that samples and holds, from its gain on the unit circle.

A dead time that is a part of a sample changes the response between two samples. So the delay margin
is searched over the part d of a sample: where the gain is 1 at the angle a and its phase is p above
-180 degrees, m = p/a more samples turn the phase there, and m must be a whole number.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .sampled_loop import MOST_SAMPLES, SampledLoop

#: lowest angle w h on the grid, which reaches to pi, and its points
_SLOWEST, _POINTS = 1e-9, 6001
#: rad: on the grid, whole samples of dead time turn the phase by at most this in a step
_STEP = 0.2
#: parts of a sample as dead times at which crossings are searched, before they are refined
_PARTS = 8
#: part of a sample before a dead time at which a direct feedthrough comes a whole sample later
_HAIR = 1e-7
#: whole samples of short dead times that are tested one by one
_LOOKED = 6
#: parts of a sample as dead times at which the gain at half the sampling rate is evaluated
_FINE = 32
#: dead times at which the loop must decay: shares of the margin, or samples if there is no margin
_BEFORE, _SAMPLES = (0.25, 0.5, 0.75, 0.99), (0.5, 1.0, 3.0, 10.0, 30.0)
#: samples: longer dead times are not considered
_MOST = 1e6
#: share and rad, as in `margins`
_LEVEL = 1e-3


def grid_of(loop: SampledLoop) -> np.ndarray:
    """Angles w h up to half the sampling rate, with corners and narrow resonances."""
    number = int(np.pi * (loop.samples + 2) / _STEP) + 2
    angles = np.concatenate(
        [np.geomspace(_SLOWEST, np.pi, _POINTS), np.linspace(0, np.pi, number), loop.corners()]
    )
    return np.unique(angles[(angles >= _SLOWEST) & (angles <= np.pi)])


def unity_crossings(loop: SampledLoop) -> tuple[np.ndarray, np.ndarray]:
    """Phase above -180 degrees, and angle w h, where the gain is 1."""
    angles = grid_of(loop)
    return where_unity(loop, angles, loop(angles))


def gain_margin(loop: SampledLoop) -> float:
    """Factor, at least 1, by which the gain of a stable loop may rise or fall; inf: no limit."""
    angles = grid_of(loop)
    gain = loop(angles)
    at = _zeros(lambda a: loop(a).imag, angles, gain.imag > 0)
    values = loop(at)
    real = values.real[values.real < 0]
    # half the sampling rate, where it is real, and the slow end where it is level
    ends = [gain[-1].real] if gain[-1].real < 0 else []
    level = abs(abs(gain[1] / gain[0]) - 1) <= _LEVEL
    if level and abs(np.angle(-gain[0])) <= _LEVEL:
        ends.append(gain[0].real)
    sizes = np.abs(np.concatenate([real, ends]))
    sizes = sizes[sizes > 0]
    return float(np.maximum(sizes, 1 / sizes).min()) if len(sizes) else np.inf


def delay_margin(loop: SampledLoop) -> float:
    """Dead time (s) at which a stable loop begins to grow; inf if the search reaches none.

    If the path has a direct feedthrough, the loop changes by steps from one whole sample of dead
    time to the next. The result is checked by the modes at a few shorter dead times.
    """
    period = float(loop.period)
    longest = MOST_SAMPLES * period
    exact, near = _candidates(loop)
    best, low = np.inf, 0.0
    for time in sorted({*exact, *near}):
        if time > longest or loop.with_delay(time * (1 + 1e-9)).grows():
            if time <= longest and time not in exact:
                time = _bisect(loop, max(low, time - period / _PARTS), time)
            best = time
            break
        low = time
    times = [s * best for s in _BEFORE] if np.isfinite(best) else [n * period for n in _SAMPLES]
    # short dead times at which a loop may grow and then decay again at a slightly longer one: parts
    # of a sample, and those about which a dead time of the loop is whole samples, where the
    # response has a kink or, with a direct feedthrough, jumps
    parts = {*(k / _PARTS for k in range(_PARTS)), *_bends(loop), *_just_before_bends(loop)}
    times += [(n + part) * period for n in range(_LOOKED) for part in parts]
    decays = 0.0
    for time in sorted({t for t in times if 0 < t <= min(longest, best)}):
        if loop.with_delay(time).grows():
            return _bisect(loop, decays, time)
        decays = time
    return best


def _candidates(loop: SampledLoop) -> tuple[set[float], set[float]]:
    """Dead times (s) with a mode on the unit circle, and the next whole samples after them."""
    period = float(loop.period)
    exact, near = _crossings_at_half_the_rate(loop), set[float]()
    for part in sorted({*(np.arange(_PARTS) / _PARTS), *_just_before_bends(loop)}):
        phase, at = unity_crossings(loop.with_delay(part * period))
        for angle, whole in zip(at, np.radians(phase % 360) / at, strict=True):
            if whole > _MOST:
                continue
            near.add((float(np.ceil(whole)) + part) * period)
            on_circle = _follow(loop, float(angle), (float(whole) + part) * period)
            if on_circle is not None:
                exact.add(on_circle)
    return exact, {t for t in near if t > 0}


def _bends(loop: SampledLoop) -> set[float]:
    """Parts of a sample (0 to below 1) with which a dead time of the loop is whole samples."""
    return {float(-t % loop.period / loop.period) for t, _ in loop.above}


def _just_before_bends(loop: SampledLoop) -> set[float]:
    """Parts of a sample just below those of `_bends`.

    With a direct feedthrough the loop may grow there, and decay from the whole sample on.
    """
    return {(part or 1.0) - _HAIR for part in _bends(loop)}


def _crossings_at_half_the_rate(loop: SampledLoop) -> set[float]:
    """Dead times (s) with a mode at z = -1, where the gain is real for any dead time.

    Each whole sample changes its sign; only the part of a sample changes its magnitude.
    """
    from scipy.optimize import brentq

    period = float(loop.period)

    def gain(part: float) -> float:
        return float(loop.with_delay(part * period)(np.array([np.pi]))[0].real)

    parts = np.append(np.arange(_FINE) / _FINE, 1 - 1e-9)
    values = np.array([gain(part) for part in parts])
    times = set[float]()
    for size, samples in ((-1.0, 0), (1.0, 1)):
        for k in np.flatnonzero((values[1:] > size) != (values[:-1] > size)):
            part = brentq(lambda x, size=size: gain(x) - size, parts[k], parts[k + 1], xtol=1e-12)
            times.add((samples + part) * period)
    return {t for t in times if t > 0}


def _bisect(loop: SampledLoop, low: float, high: float) -> float:
    """A dead time above `low` at which the loop begins to grow; it decays at `low`."""
    while high - low > 1e-9 * high:
        middle = (low + high) / 2
        low, high = (low, middle) if loop.with_delay(middle).grows() else (middle, high)
    return high


def _follow(loop: SampledLoop, angle: float, time: float) -> float | None:
    """The dead time near `time` at which 1 + gain is 0 on the circle, by Newton's method."""
    period = float(loop.period)

    def wrong(time: float, angle: float) -> complex:
        turned = loop.with_delay(time % period)(np.array([angle]))[0]
        return complex(1 + turned * np.exp(-1j * angle * (time // period)))

    for _ in range(30):
        value = wrong(time, angle)
        if abs(value) < 1e-11:
            return time if time > 0 else None
        small = 1e-7 * period, 1e-7 * angle
        slopes = (
            (wrong(time + small[0], angle) - value) / small[0],
            (wrong(time, angle + small[1]) - value) / small[1],
        )
        matrix = np.array([[d.real for d in slopes], [d.imag for d in slopes]])
        try:
            step = np.linalg.solve(matrix, [-value.real, -value.imag])
        except np.linalg.LinAlgError:
            return None
        time += float(np.clip(step[0], -0.5 * period, 0.5 * period))
        angle += float(np.clip(step[1], -0.2 * angle, 0.2 * angle))
        if time < 0 or not 0 < angle <= np.pi:
            return None
    return None


def where_unity(
    gain: Callable[[np.ndarray], np.ndarray], grid: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Phase above -180 degrees, and place, where the size of a gain passes 1 on a grid."""
    at = _zeros(lambda x: np.log(np.abs(gain(x))), grid, np.abs(values) > 1)
    return np.degrees(np.angle(gain(at))) + 180, at


def _zeros(
    function: Callable[[np.ndarray], np.ndarray], angles: np.ndarray, above: np.ndarray
) -> np.ndarray:
    """Places at which a function changes sign between grid points, by bisection and secants."""
    from scipy.optimize import brentq

    def one(angle: float) -> float:
        return float(function(np.array([angle]))[0])

    turns = np.flatnonzero(above[1:] != above[:-1])
    return np.array([brentq(one, angles[k], angles[k + 1], rtol=1e-13) for k in turns])
