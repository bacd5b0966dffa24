"""Lead compensator: a spring with damping.

output = g (s + z)/(s + p) input,   written  g (input + w),  dw/dt = -p w + (z - p) input
"""

from ..effects import Parameter
from ._controller import ControlLaw, ControllerState


def law(now, p):
    return p.gain * (now.input + now.memory)


def memory(now, p):
    return (p.zero - p.pole) * now.input - p.pole * now.memory


CONTROLLER = ControlLaw(
    law=law,
    states={"memory": ControllerState("position", memory)},
    linear=True,
    parameters={
        "gain": Parameter("stiffness", "g: stiffness at high frequency"),
        "zero": Parameter("frequency", "z: zero at s = -z, rad/s"),
        "pole": Parameter("frequency", "p: pole at s = -p, rad/s"),
    },
    source="Bernstein, Lawrence, Pao, World Haptics 2005, eq (8)",
)
