"""A loop gain with a measured response: its stability, and where its gain is 1.

Nyquist's criterion, from the lowest measured frequency to the highest. Outside this range it is
assumed that the gain stays below 1 above it, and that below it the phase goes to 0 at rest from
between -270 and +90 degrees: plants lag, and controllers lead by less than a quarter turn. With the
loop opened at the controller's output, the rest is assumed stable, as it was when it was measured.
"""

from __future__ import annotations

import numpy as np
import sympy as sp

from ..base.errors import ModelError, UnstableLoop
from ..controllers import measured_frequencies
from ..realise.lti import numerical

#: frequencies between two neighbouring measured ones. Between these the measured response is
#: interpolated by a line, and the rest of the loop is smooth. Fewer frequencies may miss a turn of
#: the phase, more take time
_BETWEEN = 8
#: rad: longest step of the phase whose direction is certain
_SURE = np.pi / 2


def measured_crossings(expression: sp.Expr, *, growing: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Phase above -180 degrees, and frequency (rad/s), where the gain is 1.

    expression: loop gain, stable feedback > 0
    growing: poles of the controller itself in the right half plane
    raises ModelError: the loop is unstable (`UnstableLoop`), or the measurement does not decide
    """
    from scipy.optimize import brentq

    call = numerical(expression)
    w = _frequencies(expression)
    gain = call(1j * w)
    size = np.abs(gain)
    if size[-1] >= 1:
        raise ModelError(
            f"the loop's gain is still {size[-1]:.3g} at {w[-1]:.4g} rad/s, the "
            "highest frequency that was measured: measure further"
        )
    angle = np.angle(1 + gain)
    if angle[0] > _SURE:  # of a plant that lags by more than half a turn
        angle[0] -= 2 * np.pi
    steps = (np.diff(angle) + np.pi) % (2 * np.pi) - np.pi
    if np.abs(steps).max() > _SURE:
        at = w[int(np.argmax(np.abs(steps)))]
        raise ModelError(
            f"too few frequencies were measured beside {at:.4g} rad/s to follow the phase there"
        )
    turns = round((angle[0] + steps.sum() - angle[-1]) / (2 * np.pi))
    if 2 * turns != growing:
        raise UnstableLoop("the loop is unstable without delay")

    def above(x: float) -> float:
        return float(np.log(np.abs(call(np.array([1j * x]))[0])))

    passed = np.flatnonzero((size[:-1] > 1) != (size[1:] > 1))
    crossing = np.array([brentq(above, w[k], w[k + 1], rtol=1e-12) for k in passed])
    return np.degrees(np.angle(call(1j * crossing))) + 180, crossing


def _frequencies(expression: sp.Expr) -> np.ndarray:
    """Frequencies that all measured responses cover, with points between neighbours, rad/s."""
    every = measured_frequencies(expression)
    low, high = max(w[0] for w in every), min(w[-1] for w in every)
    if low >= high:
        raise ModelError("measured responses have no frequencies in common")
    w = np.unique(np.concatenate([w[(w >= low) & (w <= high)] for w in every] + [[low, high]]))
    parts = np.arange(_BETWEEN) / _BETWEEN
    between = np.exp(np.log(w[:-1, None]) + np.diff(np.log(w))[:, None] * parts)
    return np.append(between.ravel(), high)
