"""Smoothed Coulomb cancellation: adds the expected friction, smoothed near rest.

    F = F_C v / (a + abs(v))

The law leaves F_C sgn(v) a/(a + abs(v)) of Coulomb friction. This has the same shape as
`velocity_schedule`, so the two complement each other. The force never exceeds F_C, so it releases
no energy where the true level is at least F_C.
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
        "smoothing_velocity": Parameter(
            "velocity", "a: speed at which half of the level is reached"
        ),
    },
    bound="level",
    smoothing="smoothing_velocity",
    source="Bernstein, Lawrence, Pao, World Haptics 2005, eq (6)",
)
