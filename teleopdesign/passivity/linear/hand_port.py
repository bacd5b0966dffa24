"""The impedance that a hand feels at a haptic interface, from its diagram, in exact numbers.

With R_D = 0 the force of the hand on the device is Zhat_M L, so force over velocity is Zhat_M/s.
For a device with a compliant transmission the motion is that of the tip. Each block enters by its
linear form. An effect without a linear form, such as Coulomb friction, is left out and named. A
mode that a zero cancels is not in the impedance, and the hand does not feel this mode from rest.
`diagram_claims` checks that no such mode grows.
"""

from __future__ import annotations

import sympy as sp

from ...derive import symbol_values, transfer
from ...diagrams import Diagram
from ...realise.lti import linear_blocks
from ...realise.tips import led_motion, linear_tips
from ..declarations import falsely_linear
from .impedance import Impedance, impedance


def hand_port(diagram: Diagram, *, speed: float = 0.0) -> tuple[Impedance, tuple[str, ...]]:
    """Impedance at the hand (N s/m), and the names of parts without a linear form.

    The names include parts that are declared linear and are not; their form in Z has no meaning.

    diagram: a haptic interface without position loop
    speed: m/s, at which smoothed friction and schedules are linearised. A claim about the impedance
        is then about this linear system only
    raises ModelError: a block without values, or with a dead time
    """
    apart, motion = linear_tips(diagram), led_motion(diagram, "L")
    motion = motion if motion in apart.signals else "L"
    linear = linear_blocks(apart, speed=speed)
    form = transfer(apart.open_at("K"), "E", (motion,), given=motion)[motion]
    z = impedance(sp.sympify(form).subs(symbol_values(linear)), motion="position")
    return z, (*linear.left_out, *falsely_linear(apart))
