"""Smoothed Coulomb cancellation: adds the friction it expects, rounded off near rest.

    F = F_C v / (a + abs(v))

Leaves F_C sgn(v) a/(a + abs(v)) of Coulomb friction: the same shape as `velocity_schedule`, which
is why the two complement each other. Never more than F_C, so it releases no energy where the true
level is at least F_C.
"""

from ..effects import Parameter
from ._controller import ControlLaw


def law(now, p):
    return p.level * now.velocity / (p.smoothing_velocity + now.speed)


CONTROLLER = ControlLaw(
    law=law,
    linear=True,
    parameters={
        "level": Parameter("force", "F_C: level that is cancelled"),
        "smoothing_velocity": Parameter("velocity", "a: half of the level is reached there"),
    },
    bound="level",
    smoothing="smoothing_velocity",
    source="Bernstein, Lawrence, Pao, World Haptics 2005, eq (6)",
)
