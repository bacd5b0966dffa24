"""The symbols of a diagram's signals in its equations."""

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
    """Symbol of a signal; for a motion, of its position."""
    return sp.Symbol(name, real=True)


def velocity(motion: str) -> sp.Symbol:
    return sp.Symbol(f"{motion}_velocity", real=True)


def acceleration(motion: str) -> sp.Symbol:
    return sp.Symbol(f"{motion}_acceleration", real=True)


def reading_symbol(name: str) -> sp.Symbol:
    """Symbol of a sensor's reading at a sample."""
    return sp.Symbol(f"{name}_measured", real=True)


def travel_rate(motion: str) -> sp.Symbol:
    """Symbol of the measured travel of the last sample over its duration."""
    return sp.Symbol(f"{motion}_travel_rate", real=True)


def estimate(motion: str) -> sp.Symbol:
    """Symbol of the velocity as the computer estimates it: filtered travel rate, or an observer."""
    return sp.Symbol(f"{motion}_velocity_estimate", real=True)


def rate_of(position: sp.Expr, rate: Callable[[str], sp.Expr]) -> sp.Expr:
    """Rate of change of a position on motions of bodies;  rate: motion -> its velocity."""
    return sp.Add(*(sp.diff(position, x) * rate(x.name) for x in position.free_symbols))


def motion_of(diagram: Diagram, name: str) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Position, velocity and acceleration of a motion, written in those of the moving bodies."""
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
