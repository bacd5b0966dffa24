"""LuGre cancellation: a damped bristle that follows the measured position, its level by speed.

    F = sigma z + sigma_1 dz/dt,   dz/dt = v - (sigma / level) abs(v) z
    level = F_C + (F_S - F_C) exp(-(v / v_S)^2)

The laws are those of the effects `coulomb`, `stribeck` and `presliding`. With the parameters of a
diagnosis the force is the estimated friction without viscous friction, which the device keeps. In
the sampled law the bristle moves exactly by the travel of the last sample, with the level held over
the sample. The force of the bristle's spring stays within F_S. Bristle damping adds to this force,
and carries the noise of the differentiated position.
"""

from types import SimpleNamespace

from ..effects import EFFECTS
from ._controller import ControlLaw, ControllerState

_LEVELS = EFFECTS["coulomb"], EFFECTS["stribeck"]
_SHAPE = EFFECTS["presliding"]


def _here(now, p):
    level = sum(effect.law(now, p) for effect in _LEVELS)
    return SimpleNamespace(velocity=now.travel_rate, level=level, bristle=now.bristle)


def law(now, p):
    return _SHAPE.law(_here(now, p), p)


def bristle(now, p):
    return _SHAPE.states["bristle"].rate(_here(now, p), p)


CONTROLLER = ControlLaw(
    law=law,
    states={"bristle": ControllerState("position", bristle)},
    parameters={n: p for e in (*_LEVELS, _SHAPE) for n, p in e.parameters.items()},
    source="Canudas de Wit, Olsson, Astrom, Lischinsky, IEEE TAC 40 (1995) 419",
)
