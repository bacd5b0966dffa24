"""Gain margin and phase margin of the loop of a controller, dead times exact."""

from __future__ import annotations

import numpy as np
from sympy.core.function import AppliedUndef

from ..errors import ModelError
from ..realise.lti import numerical
from . import sampled_margins
from .late_loop import late_ratio
from .loop import LoopGain, unity_crossings

#: rad/s; where a loop without corners and without samples is searched
_SLOWEST, _FASTEST, _POINTS = 1e-4, 1e7, 4001
#: rad; a larger step of the phase is halved
_STEP = 0.5
#: share and rad; a gain counts as level, and its phase as -180 degrees, within this: a slope of one
#: changes it by eight times as much from point to point
_LEVEL = 1e-3
#: points; more are not looked at
_MOST = 2_000_000


def phase_margin(loop: LoopGain) -> float:
    """Degrees by which the phase may turn, either way, where the gain is 1; inf: it never is.

    raises ModelError: as `delay_margin`; of an unstable loop `UnstableLoop`
    """
    phase, *_ = unity_crossings(loop)
    turned = np.abs((phase + 180) % 360 - 180)
    return float(turned.min()) if len(turned) else np.inf


def gain_margin(loop: LoopGain) -> float:
    """Factor, at least 1, by which the gain may rise or fall; inf where none limits it.

    The smallest one: where the phase is -180 degrees, the gain or one over it. Of a loop with a
    dead time this happens at frequencies without number; those whose factor is larger are skipped.
    raises ModelError: as `delay_margin`; a response that was measured is part of the loop
    """
    from scipy.optimize import brentq

    unity_crossings(loop)
    if loop.sampled is not None:
        return sampled_margins.gain_margin(loop.sampled)
    if loop.expression.atoms(AppliedUndef):
        raise ModelError("gain margin: expected a loop without a measured response")
    call = numerical(loop.expression)

    def height(w: float) -> float:
        return float(np.imag(call(np.array([1j * w]))[0]))

    ratio = None if loop.held else late_ratio(loop.expression)
    w = _grid(loop, np.zeros(0) if ratio is None else ratio.corners())
    gain = call(1j * w)
    passes = ratio is not None and ratio.passes()
    best = _factors_at_the_ends(gain, passes, loop.has_delay)
    known = np.zeros(len(w) - 1, dtype=bool)
    while True:
        steps = np.abs(np.angle(gain[1:] / gain[:-1]))
        turns = (np.imag(gain[1:]) > 0) != (np.imag(gain[:-1]) > 0)
        turns &= (np.real(gain[1:]) < 0) & (np.real(gain[:-1]) < 0) & (steps <= _STEP) & ~known
        for k in np.flatnonzero(turns):
            at = brentq(height, w[k], w[k + 1], rtol=1e-12)
            best = min(best, _factor(call(np.array([1j * at]))[0]))
        known |= steps <= _STEP
        size = np.abs(np.log(np.abs(gain)))
        near = np.minimum(size[1:], size[:-1]) <= np.log(best) + 1
        wide = np.flatnonzero(~known & near)
        middle = (w[wide] + w[wide + 1]) / 2
        wide, middle = (x[(middle > w[wide]) & (middle < w[wide + 1])] for x in (wide, middle))
        if not len(wide):
            return best
        if len(w) + len(wide) > _MOST:
            raise ModelError("gain margin: the phase turns more often than can be followed")
        known[wide] = False
        w, gain = np.insert(w, wide + 1, middle), np.insert(gain, wide + 1, call(1j * middle))
        known = np.insert(known, wide + 1, False)


def _grid(loop: LoopGain, corners: np.ndarray) -> np.ndarray:
    """Frequencies to begin with, rad/s, corners and narrow resonances among them."""
    slowest, fastest = _SLOWEST, min(loop.fastest, _FASTEST)
    if len(corners):
        slowest, fastest = min(slowest, corners.min() / 1e4), max(fastest, corners.max() * 1e4)
    return np.unique(np.concatenate([np.geomspace(slowest, fastest, _POINTS), corners]))


def _factor(gain: complex) -> float:
    return float(max(abs(gain), 1 / abs(gain)))


def _factors_at_the_ends(gain: np.ndarray, passes: bool, late: bool) -> float:
    """Of a gain that is level at the slowest or the fastest point, and turns it by 180 degrees.

    passes: whether it is level at the fastest;  late: with a dead time all phases come there
    """
    least = np.inf
    if abs(abs(gain[1] / gain[0]) - 1) <= _LEVEL and abs(np.angle(-gain[0])) <= _LEVEL:
        least = _factor(gain[0])
    if passes and (late or abs(np.angle(-gain[-1])) <= _LEVEL):
        least = min(least, _factor(gain[-1]))
    return least
