"""Frequencies between the steps of a sweep where a resonance may lie."""

from __future__ import annotations

import numpy as np
import sympy as sp

from .delayed_two_port import late_terms
from .growth_points import roots_of
from .two_port import TwoPort

#: places across a resonance, in half widths from its frequency: the real part of an entry changes
#: its sign within the first half width
_ACROSS = (-30.0, -10.0, -3.0, -1.0, -0.5, -0.2, 0.0, 0.2, 0.5, 1.0, 3.0, 10.0, 30.0)


def resonances(system: TwoPort) -> np.ndarray:
    """Frequencies across the width of each resonance, Hz, (n,): a grid alone may miss one.

    system: a two-port whose entries may have dead times. Poles on the axis have no width and are
    left out
    """
    terms = [late_terms(e) if e.has(sp.exp) else () for e in system.z]
    ratios = [t.ratio for entry in terms for t in entry or ()]
    poles = np.array([p for _, q in ratios for p in roots_of(q)], dtype=complex)
    poles = poles[poles.real < -1e-12 * np.abs(poles)]  # those on the axis have no width
    across = poles.imag[:, None] + poles.real[:, None] * np.array(_ACROSS)
    f = across.ravel() / (2 * np.pi)
    return np.asarray(f[(f > 0) & np.isfinite(f)])
