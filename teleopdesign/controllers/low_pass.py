"""First-order low-pass.

dw/dt = 2 pi f_c (input - w),   output = w
"""

from sympy import pi

from ..effects import Parameter
from ._controller import ControlLaw, ControllerState


def law(now, p):
    return now.output


def output(now, p):
    return 2 * pi * p.bandwidth * (now.input - now.output)


CONTROLLER = ControlLaw(
    law=law,
    states={"output": ControllerState("force", output)},
    linear=True,
    parameters={"bandwidth": Parameter("frequency", "f_c: -3 dB frequency in Hz")},
    filter_bandwidth="bandwidth",
    source="Bernstein, Lawrence, Pao, World Haptics 2005, section 5 (filter of H)",
)
