"""Dahl cancellation: the friction of a bristle that follows the measured position.

    F = sigma z,   dz/dt = v - (sigma / F_D) abs(v) z

The law is that of the effect `presliding` without bristle damping. In the sampled law the bristle
moves exactly by the travel of the last sample, with the sign of that travel. So F stays within F_D
for any sequence of positions.
"""

from types import SimpleNamespace

from ..effects import EFFECTS, Parameter
from ._controller import ControlLaw, ControllerState

_DAHL = EFFECTS["presliding"].without("bristle_damping")


def _here(now, p):
    return SimpleNamespace(velocity=now.travel_rate, level=p.level, bristle=now.bristle)


def law(now, p):
    return _DAHL.law(_here(now, p), p)


def bristle(now, p):
    return _DAHL.states["bristle"].rate(_here(now, p), p)


CONTROLLER = ControlLaw(
    law=law,
    states={"bristle": ControllerState("position", bristle)},
    parameters={
        "level": Parameter("force", "F_D: level that is cancelled"),
        "stiffness": _DAHL.parameters["stiffness"],
    },
    bound="level",
    bristle_stiffness="stiffness",
    source="Mahvash, Okamura, ICRA 2006, eq (9), with the sign of the travel",
)
