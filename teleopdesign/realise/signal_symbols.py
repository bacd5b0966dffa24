"""The symbols that stand for the signals of a diagram in its equations."""

from __future__ import annotations

from collections.abc import Callable

import sympy as sp

from ..controllers import SIGNALS as CONTROL_SIGNALS
from ..controllers import parameter_symbol
from ..diagrams import Diagram

TIME = sp.Symbol("time", real=True)
#: duration of a sample, in the laws of what is sampled
PERIOD = CONTROL_SIGNALS["period"]


def signal(name: str) -> sp.Symbol:
    """Symbol of a signal; of a motion, its position."""
    return sp.Symbol(name, real=True)


def velocity(motion: str) -> sp.Symbol:
    return sp.Symbol(f"{motion}_velocity", real=True)


def acceleration(motion: str) -> sp.Symbol:
    return sp.Symbol(f"{motion}_acceleration", real=True)


def reading_symbol(name: str) -> sp.Symbol:
    """The reading of a sensor at a sample."""
    return sp.Symbol(f"{name}_measured", real=True)


def travel_rate(motion: str) -> sp.Symbol:
    """Measured travel of the last sample over its duration."""
    return sp.Symbol(f"{motion}_travel_rate", real=True)


def estimate(motion: str) -> sp.Symbol:
    """Velocity as the computer knows it: filtered travel rate."""
    return sp.Symbol(f"{motion}_velocity_estimate", real=True)


def rate_of(position: sp.Expr, rate: Callable[[str], sp.Expr]) -> sp.Expr:
    """Rate of a position that bodies determine;  rate: motion -> its velocity."""
    return sp.Add(*(sp.diff(position, x) * rate(x.name) for x in position.free_symbols))


def motion_of(diagram: Diagram, name: str) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Position, velocity and acceleration of a motion on those of the moving bodies."""
    position = diagram.position(name)
    speed = rate_of(position, velocity)
    bent = (sp.diff(speed, x) * velocity(x.name) for x in position.free_symbols)
    return position, speed, sp.Add(rate_of(position, acceleration), *bent)


def parameter_names(diagram: Diagram) -> dict[sp.Symbol, str]:
    """Symbol of each parameter -> its name in `Diagram.values`."""
    names = {}
    for full in diagram.values:
        block, _, local_name = full.partition(".")
        names[parameter_symbol(block, local_name)] = full
    return names
