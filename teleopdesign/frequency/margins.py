"""Gain margin and phase margin of the loop of a controller, with exact dead times."""

from __future__ import annotations

import numpy as np
from sympy.core.function import AppliedUndef

from ..base.errors import ModelError
from ..realise.lti import numerical
from . import sampled_margins
from .late_loop import (
    envelope,
    factor_far_out,
    halve_steps,
    is_followed,
    least_between,
    loop_as_written,
)
from .late_zeros import degree_of
from .loop import LoopGain, frequencies_of, unity_crossings

#: points of the first grid
_POINTS = 4001
#: more points are evaluated only if they may lower the factor by more than this share
_SMALLER = 1e-6
#: most steps that are halved at the same time
_AT_ONCE = 20_000
#: relative tolerance within which a gain counts as constant, and tolerance (rad) within which its
#: phase counts as -180 degrees. A slope of one changes the gain eight times as much from point to
#: point
_LEVEL = 1e-3


def phase_margin(loop: LoopGain) -> float:
    """Degrees by which the phase may turn, in either direction, at gain 1; inf: no crossing.

    raises ModelError: as `delay_margin`; for an unstable loop `UnstableLoop`
    """
    phase, *_ = unity_crossings(loop)
    turned = np.abs((phase + 180) % 360 - 180)
    return float(turned.min()) if len(turned) else np.inf


def gain_margin(loop: LoopGain) -> float:
    """Factor, at least 1, by which the gain may rise or fall; inf if nothing limits it.

    The smallest of the gain and its reciprocal where the phase is -180 degrees. A loop with a dead
    time has infinitely many such frequencies; those with larger factors are skipped.

    raises ModelError: as `delay_margin`; a measured response is part of the loop
    """
    from scipy.optimize import brentq

    unity_crossings(loop)
    if loop.sampled is not None:
        return sampled_margins.gain_margin(loop.sampled)
    if loop.expression.atoms(AppliedUndef):
        raise ModelError("gain_margin: expected a loop without a measured response")
    call = numerical(loop.expression)

    def height(w: float) -> float:
        return float(np.imag(call(np.array([1j * w]))[0]))

    ratio = None if loop.held else loop.counted or loop_as_written(loop.expression)
    if ratio is not None and not ratio.above:
        return np.inf  # a gain of 0 at every frequency
    w = frequencies_of(loop, ratio, _POINTS)

    def at(w: np.ndarray) -> np.ndarray:
        """Gain, and its envelope by dead times, (5, n)."""
        if ratio is not None:
            return np.array(envelope(ratio, w))
        gain = call(1j * w)
        return np.array([gain, *[np.log(np.abs(gain))] * 2, 0 * w, 0 * w])

    points = at(w)
    best, first = np.inf, points[0]  # level at the slowest point, with a phase of 180 degrees
    if abs(abs(first[1] / first[0]) - 1) <= _LEVEL and abs(np.angle(-first[0])) <= _LEVEL:
        best = _factor(first[0])
    if ratio is not None and degree_of(ratio.above) >= degree_of(ratio.below):
        far_out, number = factor_far_out(ratio, w, share=_LEVEL)
        best, w, points = min(best, far_out), w[:number], points[:, :number]
    followed = np.zeros(len(w) - 1, dtype=bool)
    while True:
        gain, (least, most, clear, rate) = points[0], points[1:].real
        left = np.abs(np.angle(-gain))
        known = is_followed(np.abs(np.angle(gain[1:] / gain[:-1])), left, rate, w)
        turns = known & ~followed & ((np.imag(gain[1:]) > 0) != (np.imag(gain[:-1]) > 0))
        for k in np.flatnonzero(turns & (left[1:] < np.pi / 2) & (left[:-1] < np.pi / 2)):
            crossing = brentq(height, w[k], w[k + 1], rtol=1e-12)
            best = min(best, _factor(call(np.array([1j * crossing]))[0]))
        followed |= known
        reach = np.fmax(least_between(-most), least_between(least))
        far = reach > np.log(best * (1 - _SMALLER))
        far |= np.minimum(np.abs(clear[1:]), np.abs(clear[:-1])) > np.abs(np.diff(clear))
        wide = np.flatnonzero(~known & ~far)
        # the smallest factors first, so that those that are larger need not be looked at
        wide = np.sort(wide[np.argsort(reach[wide])[:_AT_ONCE]])
        w, points, more = halve_steps(w, points, wide, at)
        if not len(more):
            return best
        followed = np.insert(followed, more + 1, False)


def _factor(gain: complex) -> float:
    return float(max(abs(gain), 1 / abs(gain)))
