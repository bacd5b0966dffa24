"""The levels that identified friction can take, over its shape and its standard errors.

The level is that of the body's own effects (Stribeck, direction, position, load, drift, a user's
own), evaluated over speeds, directions, positions, loads and times that the records reach.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import sympy as sp

from ..blocks import Body
from ..by_value import ByValue
from ..effects import SIGNALS
from ..measurement.filtering import Array
from ..realise.law_along import law_along
from ..realise.simulated import without_absent
from .reach import Reach

#: levels are sought up to this many times the recorded speed, and at times up to so many records
FASTER, LONGER = 10.0, 100.0


@dataclass(frozen=True, eq=False)
class FrictionRange(ByValue):
    """Levels of friction while sliding, N or N m, and the stiffness before it slides.

    identified: `coulomb.level`, and its standard error;  lowest, highest: over the shape
    sure, most: the same at the ends of the interval of so many standard errors
    where_lowest: in words;  stiffness: sigma_p, N/m, inf: none; sure_stiffness: its lower end
    bristle_lengths: half of the recorded travel in bristle lengths, inf without presliding
    unknown: parameters of the level without a standard error
    """

    identified: float
    identified_error: float
    lowest: float
    highest: float
    sure: float
    most: float
    where_lowest: str
    stiffness: float
    sure_stiffness: float
    bristle_lengths: float
    unknown: tuple[str, ...] = ()

    @property
    def has_presliding(self) -> bool:
        """Whether friction is a spring before it slides."""
        return math.isfinite(self.stiffness)

    @property
    def slides(self) -> bool:
        """Whether friction comes near its level within the recorded travel: else it is a guess."""
        return self.bristle_lengths > 1.0


def friction_range(body: Body, reach: Reach, *, errors: float) -> FrictionRange | None:
    """The range of a body's friction level; None where it has no friction level at all.

    errors: standard errors to either side
    """
    body = without_absent(body)
    if not any(e.role == "friction_level" for e in body.effects):
        return None
    grid, axes = _grid(body, reach)
    level, error = law_along(body, body.level(), grid)
    low = np.unravel_index(int(np.argmin(level - errors * error)), level.shape)
    where = [f"{n} {float(a.ravel()[low[i]]):.3g}" for i, (n, a) in enumerate(axes.items())]
    stiffness = body.parameters.get("presliding.stiffness")
    known = body.parameters.get("coulomb.level")
    return FrictionRange(
        identified=known.value if known else math.nan,
        identified_error=known.stderr if known else math.nan,
        lowest=float(level.min()),
        highest=float(level.max()),
        sure=float((level - errors * error).min()),
        most=float((level + errors * error).max()),
        where_lowest=", ".join(where),
        stiffness=stiffness.value if stiffness else math.inf,
        sure_stiffness=_lower(stiffness.value, stiffness.stderr, errors) if stiffness else math.inf,
        bristle_lengths=(
            reach.travel / 2 * stiffness.value / float(level.max()) if stiffness else math.inf
        ),
        unknown=_without_error(body),
    )


def _lower(value: float, error: float, errors: float) -> float:
    return value - errors * error if math.isfinite(error) else value


def _without_error(body: Body) -> tuple[str, ...]:
    law, symbols = body.level(), body.symbols()
    return tuple(
        n
        for n, v in body.parameters.items()
        if law.has(symbols[n]) and not v.fixed and not math.isfinite(v.stderr)
    )


def _grid(body: Body, reach: Reach) -> tuple[dict[sp.Symbol, Array], dict[str, Array]]:
    """Values of every signal that the level depends on, one axis each, and the axes in words."""
    law = body.level()
    top = FASTER * reach.peak_speed
    speeds = np.concatenate([[0.0], np.geomspace(1e-3 * reach.peak_speed, top, 80)])
    film = {x for e in body.effects for x in e.state_symbols().values() if law.has(x)}
    axes: dict[str, Array] = {"direction": np.array([-1.0, 1.0])}
    if law.has(SIGNALS["velocity"]) or film:
        axes["speed"] = speeds
    for name, values in (
        ("position", np.linspace(reach.low, reach.high, 401)),
        ("time", np.array([0.0, 0.25, 0.5, 1.0, LONGER]) * reach.duration),
        ("acting_force", np.array([0.0, 0.5, 1.0]) * reach.command),
    ):
        if law.has(SIGNALS[name]):
            axes[name] = values
    mesh = np.meshgrid(*axes.values(), indexing="ij", sparse=True)
    open_axes = dict(zip(axes, mesh, strict=True))
    grid: dict[sp.Symbol, Array] = {SIGNALS["direction"]: open_axes["direction"]}
    if "speed" in axes:
        grid[SIGNALS["velocity"]] = open_axes["direction"] * open_axes["speed"]
        grid |= dict.fromkeys(film, open_axes["speed"])
    grid |= {SIGNALS[n]: open_axes[n] for n in open_axes if n not in ("direction", "speed")}
    return grid, open_axes
