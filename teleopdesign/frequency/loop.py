"""The loop that a controller closes: its gain at each frequency, and the delay that it bears."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import sympy as sp

from ..derive import block_symbol, transfer
from ..diagrams import Diagram
from ..errors import ModelError
from ..realise.lti import as_transfer_function, linear_blocks
from ..realise.tips import linear_tips

if TYPE_CHECKING:
    import control


def loop_gain(
    diagram: Diagram, *, controller: str = "H", speed: float = 0.0
) -> control.TransferFunction:
    """Gain once round the loop of a controller, opened at its output; stable feedback is > 0.

    All other blocks at work, linear forms with smoothed friction and schedules frozen at `speed`.
    raises ModelError: no such controller
    """
    part = next((c for c in diagram.controls if c.name == controller), None)
    if part is None:
        diagram.block(controller)
        raise ModelError(f"{diagram.name}: {controller} is a body, expected a controller")
    diagram = linear_tips(diagram)
    linear = linear_blocks(diagram, speed=speed)
    opened = diagram.opened(controller)
    path = sp.sympify(transfer(opened, part.input, (part.output,))[part.output])
    values = {block_symbol(n): e for n, e in linear.blocks.items()}
    values |= {block_symbol(f"A_{n}"): e for n, e in linear.actuation.items()}
    return as_transfer_function(-(path * block_symbol(controller)).subs(values))


def delay_margin(loop: control.TransferFunction) -> float:
    """Dead time (s) in the loop at which it begins to oscillate; inf where its gain stays below 1.

    raises ModelError: the loop is unstable without any delay
    """
    import control

    if (np.real(control.feedback(loop, 1).poles()) >= 0).any():
        raise ModelError("delay margin: the loop is unstable without delay")
    _, phase, _, _, crossing, _ = control.stability_margins(loop, returnall=True)
    # a crossing is reached by turning back as far as its phase lies ahead of -180 degrees
    delays = np.radians(np.asarray(phase) % 360) / np.asarray(crossing)
    return float(delays.min()) if len(delays) else float("inf")
