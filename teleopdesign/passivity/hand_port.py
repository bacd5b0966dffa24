"""The impedance that a hand feels at a haptic interface, from its diagram, in exact numbers.

With R_D = 0 the hand's force on the device is Zhat_M L, so force over velocity is Zhat_M/s. Blocks
are linear forms: what has none (Coulomb friction among them) is left out, and named.
"""

from __future__ import annotations

import sympy as sp

from ..derive import block_symbol, transfer
from ..diagrams import Diagram
from ..realise.lti import linear_blocks
from .impedance import Impedance, impedance


def hand_port(diagram: Diagram, *, speed: float = 0.0) -> tuple[Impedance, tuple[str, ...]]:
    """Force over velocity at the hand (N s/m), and the names of what has no linear form.

    diagram: a haptic interface without position loop;  speed: where smoothed friction and schedules
    are frozen, m/s: what holds there is a statement about that linear system only
    raises ModelError: a block without values, or with a dead time
    """
    linear = linear_blocks(diagram, speed=speed)
    form = transfer(diagram.opened("K"), "E", ("L",), given="L")["L"]
    values = {block_symbol(n): e for n, e in linear.blocks.items()}
    values |= {block_symbol(f"A_{n}"): e for n, e in linear.actuation.items()}
    return impedance(sp.sympify(form).subs(values), motion="position"), linear.left_out
