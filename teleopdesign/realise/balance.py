"""Friction that balances where the position tells no motion.

Between its bounds friction takes the value that leaves least within the bandwidth: accelerated
projected steps (Beck, Teboulle, SIAM J. Imaging Sciences 2, 2009) on the low-passed difference to
what is needed. Clipping what is needed itself would turn its noise above the bandwidth into a bias
below it, and few plain steps stop short of what the edge of the band asks for: next to a turn a
right model then leaves two to four times its noise. Values and tangents go through together.
"""

from __future__ import annotations

import numpy as np

from ..machine_code import kept
from ..measurement.filtering import Array
from ..measurement.zero_phase import both_ways, margin, sections

#: projected steps: on 109 simulated records of right models the 95th percentile of what they leave,
#: over what the drawn sensor errors do, is 1.12 after these, 1.11 after twice as many
STEPS = 8


@kept
def _clip(f: Array, low: Array, high: Array) -> None:
    """Columns: the value, then its tangents; where the value is clipped they are the bound's."""
    n, r = f.shape
    for k in range(n):
        if f[k, 0] >= high[k, 0]:
            for j in range(r):
                f[k, j] = high[k, j]
        elif f[k, 0] <= low[k, 0]:
            for j in range(r):
                f[k, j] = low[k, j]


@kept
def _balance(needed: Array, low: Array, high: Array, sos: Array, steady: Array, m: int) -> Array:
    n, r = needed.shape
    friction = needed.copy()
    _clip(friction, low, high)
    ahead, before = friction.copy(), np.empty((n, r))
    left = np.empty((n, r))
    extended = np.empty((n + 2 * m, r))
    momentum = 1.0
    for _ in range(STEPS):
        for k in range(n):
            for j in range(r):
                left[k, j] = needed[k, j] - ahead[k, j]
        both_ways(left, extended, sos, steady)
        for k in range(n):
            for j in range(r):
                before[k, j] = friction[k, j]
                friction[k, j] = ahead[k, j] + left[k, j]
        _clip(friction, low, high)
        later = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * momentum**2))
        carried = (momentum - 1.0) / later
        momentum = later
        for k in range(n):
            for j in range(r):
                ahead[k, j] = friction[k, j] + carried * (friction[k, j] - before[k, j])
    return friction


def balanced(
    needed: Array, low: Array, high: Array, *, bandwidth: float, sample_time: float
) -> Array:
    """Friction with its tangents, (1 + p, n): first row the value, then its tangents.

    needed, low, high: likewise, (1 + p, n);  bandwidth: Hz;  sample_time: s
    """
    sos, steady = sections(bandwidth, sample_time)
    m = margin(needed.shape[1], sample_time)
    columns = [np.ascontiguousarray(a.T) for a in (needed, low, high)]
    friction = _balance(columns[0], columns[1], columns[2], sos, steady, m)
    return np.ascontiguousarray(friction.T)
