"""Ideal Coulomb cancellation: adds the whole friction level in the direction of motion.

    F = F_C sgn(v),   sgn(0) = 0

Where the sign of the velocity is known, this law removes Coulomb friction completely. It is the
bound for every law that is smoothed. Where the velocity is exactly zero, it adds nothing. With an
encoder the force changes by F_C at every encoder step near rest; `smoothed_coulomb` and `dahl`
avoid these jumps. The force never exceeds F_C, so it releases no energy where the true level is at
least F_C. In a loop in continuous time no step of a simulation resolves the jump of the sign:
sample the law.
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
