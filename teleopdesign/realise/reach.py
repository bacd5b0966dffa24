"""Reach of a motion: travel, speed, command, and the resulting ranges of signals."""

from __future__ import annotations

import math
from dataclasses import dataclass

import sympy as sp

from ..base.units import unit_of
from ..effects import SIGNALS

#: friction bounds are for speeds up to FASTER times the recorded speed, and for times up to LONGER
#: records: a controller moves a device faster and longer than the experiment that identified it
FASTER, LONGER = 10.0, 100.0
#: name of the reach of a law that is a constant
ANY_MOTION = "any motion"


@dataclass(frozen=True)
class Reach:
    """The recorded range of one body; SI.

    low, high: of its position;  command: largest commanded force
    duration: of the longest record;  sample_period: s;  step: of the position readings
    unresolved: length below which the deflection of a contact before it slides cannot be resolved:
        by the steps of the readings, or within half a period of the comparison's bandwidth after a
        reversal
    measures_force: whether the force of hand or environment is a channel
    both_ways: whether it moves forward and backward for at least `RARE` of the time it moves
    """

    low: float
    high: float
    peak_speed: float
    rms_speed: float
    command: float
    duration: float
    sample_period: float
    step: float
    unresolved: float
    measures_force: bool
    both_ways: bool = True

    @property
    def travel(self) -> float:
        """Length of the travel (m, rad)."""
        return self.high - self.low


def largest_speed(reach: Reach | None) -> float:
    """Largest speed for which friction is bounded; inf where no reach is known."""
    return math.inf if reach is None else FASTER * reach.peak_speed


def signal_ranges(reach: Reach | None) -> dict[sp.Symbol, tuple[float, float]]:
    """Symbol of a signal -> its range, except velocity and direction (see `largest_speed`).

    Signals without a known range are unbounded; time starts at zero.
    """
    ends = {name: (-math.inf, math.inf) for name in SIGNALS}
    ends["time"] = 0.0, math.inf
    if reach is not None:
        ends["position"] = reach.low, reach.high
        ends["time"] = 0.0, LONGER * reach.duration
        ends["acting_force"] = ends["command"] = -reach.command, reach.command
    return {SIGNALS[n]: r for n, r in ends.items() if n not in ("velocity", "direction")}


def unit_of_signal(name: str, axis: str) -> str:
    """Unit of a signal on which friction levels may depend; "" of a direction, which has none."""
    quantity = {"speed": "velocity", "penetration": "position", "level": "force"}.get(name, name)
    quantity = "force" if name.endswith(("force", "command")) else quantity.removeprefix("other_")
    return "" if name == "direction" else unit_of(quantity, axis)


def words_of(reach: Reach | None, law: sp.Expr, *, speed: bool, axis: str) -> str:
    """The ranges of a law's signals in words: "speeds up to 3 m/s, position -0.1 to 0.1 m".

    speed: whether the law depends on a speed, of the body or a lagging one
    """
    top = largest_speed(reach)
    parts = [_range("speed", 0.0, top, unit_of("velocity", axis))] if speed else []
    parts += ["both directions"] if law.has(SIGNALS["direction"]) else []
    for symbol, (low, high) in signal_ranges(reach).items():
        if law.has(symbol):
            unit = unit_of_signal(symbol.name, axis)
            parts.append(_range(symbol.name.replace("_", " "), low, high, unit))
    return ", ".join(parts) or ANY_MOTION


def _range(name: str, low: float, high: float, unit: str) -> str:
    if math.isinf(high):
        return f"any {name}"
    return f"{name} {low:.4g} to {high:.4g} {unit}"
