"""Friction that balances where the position tells no motion.

Between its bounds friction takes the value that leaves least within the bandwidth: accelerated
projected steps (Beck, Teboulle, SIAM J. Imaging Sciences 2, 2009) on the low-passed difference to
what is needed. Clipping what is needed itself would turn its noise above the bandwidth into a bias
below it, and few plain steps stop short of what the edge of the band asks for: next to a turn a
right model then leaves two to four times its noise. Values and tangents go through together.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..machine_code import kept
from ..measurement.filtering import Array
from ..measurement.zero_phase import both_ways, columns, margin, sections
from .traced import Traced

#: projected steps: on 109 simulated records of right models the 95th percentile of what they leave,
#: over what the drawn sensor errors do, is 1.12 after these, 1.11 after twice as many
STEPS = 8


@kept
def _balance(
    left: Array,
    rows: NDArray[np.intp],
    there: Array,
    sos: Array,
    steady: Array,
    m: int,
) -> Array:
    """Friction at the rows where its bounds leave it open; columns: the value, then its tangents.

    left: needed less friction at all samples, changed in place
    there: (3, rows, columns), what is needed at these rows, least and largest friction
    """
    n, r = left.shape
    needed, low, high = there[0], there[1], there[2]
    extended = np.zeros((n + 2 * m, r))
    friction: Array = np.empty_like(needed)
    ahead = needed.copy()
    momentum, carried = 1.0, 0.0
    for turn in range(STEPS + 1):
        if turn > 0:
            both_ways(left, extended, sos, steady)
            later = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * momentum**2))
            carried = (momentum - 1.0) / later
            momentum = later
        for i, k in enumerate(rows):
            value = ahead[i, 0] + extended[m + k, 0]
            above, below = value >= high[i, 0], value <= low[i, 0]
            for j in range(r):  # where the value is clipped, its tangents are the bound's
                before, within = friction[i, j], ahead[i, j] + extended[m + k, j]
                now = high[i, j] if above else low[i, j] if below else within
                friction[i, j] = now
                ahead[i, j] = now + carried * (now - before) if turn > 0 else now
                left[k, j] = needed[i, j] - ahead[i, j]
    return friction


def balanced(
    needed: Traced, low: Traced, high: Traced, *, bandwidth: float, sample_time: float
) -> Traced:
    """Friction between its bounds, with its tangents; bandwidth: Hz;  sample_time: s."""
    is_open = (low.value != high.value) | (low.tangent != high.tangent).any(axis=0)
    rows = np.flatnonzero(is_open)
    sos, steady = sections(bandwidth, sample_time)
    left = columns((needed - low).rows())
    there = np.stack([columns(a.rows(rows)) for a in (needed, low, high)])
    m = margin(len(left), sample_time)
    friction = low.rows()
    friction[:, rows] = _balance(left, rows, there, sos, steady, m)[:, : len(friction)].T
    return Traced(friction[0], friction[1:])
