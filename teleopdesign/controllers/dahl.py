"""Dahl cancellation: the friction of a bristle that follows the measured position.

    F = sigma z,   dz/dt = v - (sigma / F_D) abs(v) z

The law is that of the effect `presliding`. Sampled, the travel of the last sample moves the bristle
exactly, with the sign of the travel: F stays within F_D for any sequence of positions.
"""

from types import SimpleNamespace

from ..effects import EFFECTS, Parameter, State
from ._controller import ControlLaw

_PRESLIDING = EFFECTS["presliding"]


def law(now, p):
    return _PRESLIDING.law(now, p)


def bristle(now, p):
    here = SimpleNamespace(velocity=now.travel_rate, level=p.level, bristle=now.bristle)
    return _PRESLIDING.states["bristle"].rate(here, p)


CONTROLLER = ControlLaw(
    law=law,
    states={"bristle": State("position", bristle)},
    parameters={
        "level": Parameter("force", "F_D: level that is cancelled"),
        "stiffness": _PRESLIDING.parameters["stiffness"],
    },
    source="Mahvash, Okamura, ICRA 2006, eq (9), with the sign of the travel",
)
