"""Z-width of a haptic interface: the range from its free impedance to the stiffest passive wall.

The wall is a sampled law, linear in its stiffness K and damping B; by default

    H(z) = z^-d (K + B (z - 1)/(T z))

Passive walls lie on one side of a curve K(B). With this law and no delay the curve is
K = 2 (b - |B|)/T. Colgate and Schenkel, J. Robotic Systems 14 (1997) 37.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..base.finding import Graph, Series
from ..base.frozen import ByValue
from .linear.conditions import is_exactly_passive
from .linear.family import family_of_impedance
from .linear.impedance import exact
from .search.growing_wave import Z
from .theorems.sampled_data import travel_operator

WALL_STIFFNESS = sp.Symbol("K")
WALL_DAMPING = sp.Symbol("B")
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
    law: sp.Expr | None = None,
    wall_damping: np.ndarray | None = None,
) -> ZWidth:
    """Limits of the passive walls of a device.

    damping: b of the device, N s/m;  sample_time: T, s;  inertia: kg, used by `ZWidth.width` only
    delay: d, whole samples of computing time
    law: another H(z), linear in WALL_STIFFNESS and WALL_DAMPING
    wall_damping: values of B, N s/m; default: 0 to b
    raises ModelError: damping or sample time not > 0, or a law that is not linear in both
    """
    b, late = exact(damping, "z_width: damping: "), exact(sample_time, "z_width: sample_time: ")
    if b <= 0 or late <= 0:
        raise ModelError(f"z_width: damping and sample time must be > 0, found {b} and {late}")
    if law is None:
        law = WALL_STIFFNESS + WALL_DAMPING * (Z - 1) / (late * Z)
    law = sp.sympify(law, strict=True) * Z**-delay
    grid = np.linspace(0, float(b), 21) if wall_damping is None else np.asarray(wall_damping, float)
    per_stiffness, per_damping = _shares(law, late)
    largest = np.array([_largest(per_stiffness, per_damping * x, float(b)) for x in grid])
    verified = bool(np.isfinite(largest).any()) and all(
        _agrees(law, b, late, exact(float(x)), float(k))
        for x, k in zip(grid, largest, strict=True)
        if np.isfinite(k)
    )
    return ZWidth(grid, largest, float(b), inertia, float(late), verified)


def _shares(law: sp.Expr, late: sp.Expr) -> tuple[np.ndarray, np.ndarray]:
    """Damping of the device that one unit of K, and one unit of B, needs.

    returns: both at each angle w T, (n,)
    """
    theta = np.linspace(0, np.pi, _ANGLES)[1:]
    z = np.exp(1j * theta)
    out = []
    for symbol in (WALL_STIFFNESS, WALL_DAMPING):
        part = sp.diff(sp.expand(law), symbol)
        if part.free_symbols - {Z}:
            raise ModelError("z_width: the law must be linear in WALL_STIFFNESS and WALL_DAMPING")
        h = np.broadcast_to(np.asarray(sp.lambdify(Z, part, "numpy")(z), dtype=complex), z.shape)
        out.append(float(late) / 2 * ((1 - 1 / z) * h).real / (1 - np.cos(theta)))
    return out[0], out[1]


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


def _agrees(law: sp.Expr, b: sp.Expr, late: sp.Expr, x: sp.Expr, k: float) -> bool:
    """Whether the exact test accepts a little less stiffness, and refuses a little more."""

    def passive(stiffness: float) -> bool:
        wall = law.subs({WALL_STIFFNESS: exact(stiffness), WALL_DAMPING: x})
        operator = travel_operator(wall, b, late, sp.S(0))
        return is_exactly_passive(family_of_impedance(operator))

    margin = _AGREE * float(b / late)
    return passive(max(k - margin, 0.0)) and not passive(k + margin)
