"""Smoothed Coulomb cancellation: adds the expected friction, smoothed near rest.

    F = F_C v / (a + abs(v))

The law leaves F_C sgn(v) a/(a + abs(v)) of Coulomb friction. This has the same shape as
`velocity_schedule`, so the two complement each other. The force never exceeds F_C, so it releases
no energy where the true level is at least F_C.
"""

from types import SimpleNamespace

from ..effects import EFFECTS, Parameter
from ._controller import ControlLaw

_SMOOTHED = EFFECTS["smoothed_coulomb"]


def law(now, p):
    force = _SMOOTHED.law(SimpleNamespace(velocity=now.velocity), p)
    return force.subs(abs(now.velocity), now.speed)


CONTROLLER = ControlLaw(
    law=law,
    linear=True,
    parameters={
        "level": Parameter("force", "F_C: level that is cancelled"),
        "smoothing_velocity": _SMOOTHED.parameters["smoothing_velocity"],
    },
    bound="level",
    smoothing="smoothing_velocity",
    source="Bernstein, Lawrence, Pao, World Haptics 2005, eq (6)",
)
