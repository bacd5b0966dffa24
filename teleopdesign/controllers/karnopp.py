"""Karnopp cancellation: within a band of velocities it balances the commanded force.

    F = F_C sgn(v)                     abs(v) > band
    F = u limited to -F_C ... F_C      abs(v) <= band,   u = input

At rest friction is no function of velocity: it balances the commanded force. A law of the velocity
alone has no force at rest that is right for both directions. So this law takes the commanded force
as its input: R_D in the haptic interface, not the motion. While the device is stuck, the law
doubles the command up to F_C. This halves the command that breaks the device away.

F_C sgn(u) would free the device at any command, but jumps by 2 F_C with the sign of a noisy
command. This law is continuous in u, and adds nothing where the command is zero. The force never
exceeds F_C, so it releases no energy where the true level is at least F_C.

A band below encoder step over period takes single encoder steps for motion. A band below the speeds
of presliding takes the bristle deflection of the contact for motion.
"""

from types import SimpleNamespace

from sympy import Piecewise

from ..effects import EFFECTS, Parameter
from . import coulomb
from ._controller import ControlLaw

_LIMITED = EFFECTS["actuator_saturation"]


def law(now, p):
    stuck = _LIMITED.law(SimpleNamespace(command=now.input), SimpleNamespace(limit=p.level))
    return Piecewise((stuck, now.speed <= p.band), (coulomb.law(now, p), True))


CONTROLLER = ControlLaw(
    law=law,
    takes="force",
    parameters={
        "level": coulomb.CONTROLLER.parameters["level"],
        "band": Parameter("velocity", "largest speed that counts as rest"),
    },
    bound="level",
    source="Karnopp, J. Dyn. Syst. Meas. Control 107 (1985) 100: the friction law, here added",
)
