"""Z-width of a haptic interface: the range from its free impedance to the stiffest passive wall.

The wall is a sampled law of stiffness K and damping B, with a delay of d samples:

    H(z) = z^-d (K + B (z - 1)/(T z))

Passive walls lie on one side of a curve K(B). Without delay the curve is K = 2 (b - |B|)/T. Colgate
and Schenkel, J. Robotic Systems 14 (1997) 37.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..base.finding import Graph, Series
from ..base.frozen import ByValue
from .linear.excess import is_passive
from .linear.impedance import exact
from .search.growing_wave import Z
from .theorems.sampled_data import travel_operator

_ANGLES = 20001  # angles w T from 0 to pi; the exact test then verifies the limit
#: distance from the limit, as a share of b/T, at which the exact test must agree on both sides
_AGREE = 1e-6


@dataclass(frozen=True, eq=False)
class ZWidth(ByValue):
    """Largest passive wall stiffness for each wall damping.

    wall_damping: B, N s/m, (n,)
    stiffness: largest passive K >= 0, N/m, (n,); NaN where no K >= 0 is passive
    damping: b of the device, N s/m;  inertia: of the device, kg;  sample_time: T, s
    verified: whether there are limits, and the exact test confirms each, just inside and outside
    """

    wall_damping: np.ndarray
    stiffness: np.ndarray
    damping: float
    inertia: float
    sample_time: float
    verified: bool

    @property
    def stiffest(self) -> tuple[float, float]:
        """(K, B) of the stiffest passive wall, N/m and N s/m; NaN where no wall is passive."""
        if np.isnan(self.stiffness).all():
            return float("nan"), float("nan")
        k = int(np.nanargmax(self.stiffness))
        return float(self.stiffness[k]), float(self.wall_damping[k])

    def width(self, frequency: float) -> float:
        """Z-width in dB at a frequency (Hz): abs(Z) of the stiffest wall over that of the device.

        Both impedances are continuous, m s + b + B + K/s and m s + b, so the frequency should be
        far below 1/T.
        """
        s = 2j * np.pi * frequency
        k, b = self.stiffest
        free = self.inertia * s + self.damping
        return float(20 * np.log10(abs(free + b + k / s) / abs(free)))

    def graph(self) -> Graph:
        """Limit of passive walls: wall stiffness over wall damping."""
        line = Series("limit of passive walls", self.wall_damping, self.stiffness, "model")
        return Graph("wall damping B (N s/m)", "wall stiffness K (N/m)", (line,))


def z_width(
    *,
    damping: Any,
    sample_time: Any,
    inertia: float = 0.0,
    delay: int = 0,
    wall_damping: np.ndarray | None = None,
) -> ZWidth:
    """Limits of the passive walls of a device.

    damping: b of the device, N s/m;  sample_time: T, s;  inertia: kg, used by `ZWidth.width` only
    delay: d, whole samples of computing time
    wall_damping: values of B, N s/m; default: 0 to b
    raises ModelError: damping or sample time not > 0
    """
    b, late = exact(damping, "z_width: damping: "), exact(sample_time, "z_width: sample_time: ")
    if b <= 0 or late <= 0:
        raise ModelError(f"z_width: damping and sample time must be > 0, found {b} and {late}")
    grid = np.linspace(0, float(b), 21) if wall_damping is None else np.asarray(wall_damping, float)
    theta = np.linspace(0, np.pi, _ANGLES)[1:]
    step = 1 - np.exp(-1j * theta)  # (z - 1)/z on the unit circle
    # damping of the device that one unit of K, and one of B, needs at each angle
    per_stiffness, per_damping = (
        float(late) / 2 * (step * h * np.exp(-1j * delay * theta)).real / (1 - np.cos(theta))
        for h in (1.0, step / float(late))
    )
    largest = np.array([_largest(per_stiffness, per_damping * x, float(b)) for x in grid])

    def is_wall_passive(stiffness: float, damping: float) -> bool:
        wall = (exact(stiffness) + exact(damping) * (Z - 1) / (late * Z)) * Z**-delay
        return is_passive(travel_operator(wall, b, late, sp.S(0)))

    margin, finite = _AGREE * float(b / late), np.isfinite(largest)
    verified = bool(finite.any()) and all(
        is_wall_passive(max(k - margin, 0.0), x) and not is_wall_passive(k + margin, x)
        for k, x in zip(largest[finite].tolist(), grid[finite].tolist(), strict=True)
    )
    return ZWidth(grid, largest, float(b), inertia, float(late), verified)


def _largest(per_stiffness: np.ndarray, spent: np.ndarray, b: float) -> float:
    """Largest K >= 0 with K per_stiffness + spent <= b at every angle; NaN where no K does."""
    left = b - spent
    left = np.where(np.abs(left) < 1e-9 * b, 0.0, left)  # rounding of the angles near 0
    more, less = per_stiffness > 0, per_stiffness < 0
    highest = np.min(left[more] / per_stiffness[more], initial=np.inf)
    lowest = np.max(left[less] / per_stiffness[less], initial=0.0)
    if np.any(left[per_stiffness == 0] < 0) or highest < lowest:
        return float("nan")
    return float(highest)
