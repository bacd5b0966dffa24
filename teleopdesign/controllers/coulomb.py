"""Ideal Coulomb cancellation: adds the whole level in the direction of motion.

    F = F_C sgn(v),   sgn(0) = 0

Removes Coulomb friction completely wherever the sign of the velocity is known, and is the bound for
every law that is rounded off. Nothing is added where the velocity is exactly zero. With an encoder
it changes by F_C at every step that is read near rest; `smoothed_coulomb` or `dahl` are used for
that reason. Never more than F_C, so it releases no energy where the true level is at least that.
In a loop in continuous time no step of a simulation resolves the jump: sample it.
"""

from sympy import sign

from ..effects import EFFECTS, Parameter
from ._controller import ControlLaw

_LEVEL = EFFECTS["coulomb"]


def law(now, p):
    return _LEVEL.law(now, p) * sign(now.velocity)


CONTROLLER = ControlLaw(
    law=law,
    parameters={"level": Parameter("force", "F_C: level that is cancelled")},
    bound="level",
    source="Bernstein, Lawrence, Pao, World Haptics 2005, eq (1)",
)
