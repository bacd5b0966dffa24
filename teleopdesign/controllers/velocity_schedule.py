"""Gain that falls with speed: strong force feedback near rest, little in fast motion.

output = k b / (b + abs(v)) input
"""

from ..effects import Parameter
from ._controller import ControlLaw


def law(now, p):
    return p.gain * p.scheduling_velocity / (p.scheduling_velocity + now.speed) * now.input


CONTROLLER = ControlLaw(
    law=law,
    linear=True,
    parameters={
        "gain": Parameter("dimensionless", "k: gain at rest"),
        "scheduling_velocity": Parameter("velocity", "b: speed at which the gain is halved"),
    },
    source="Bernstein, Lawrence, Pao, World Haptics 2005, section 5 (gain of H)",
)
