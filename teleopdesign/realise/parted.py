"""Responses of a device with a compliance or backlash, as two bodies.

A hand moves the tip, so a prescribed motion is that of the tip.
"""

from __future__ import annotations

from collections.abc import Mapping

from ..blocks import Body
from ..diagrams import Diagram
from .simulated import without_absent
from .tips import led_motion, linear_tips, with_tips


def linear_parted(diagram: Diagram, motions: tuple[str, ...]) -> tuple[Diagram, Mapping[str, str]]:
    """The diagram with linear structures as two bodies, and each prescribed motion -> the led one.

    Backlash has no linear form: there the body stays whole, and its left-out effects name it.
    """
    apart = linear_tips(diagram)
    there = {name: led_motion(diagram, name) for name in motions}
    return apart, {name: tip if tip in apart.signals else name for name, tip in there.items()}


def simulated_parted(diagram: Diagram, motion: str) -> tuple[Diagram, str]:
    """The diagram with every structure as two bodies, and the motion that a hand leads."""
    for part in diagram.bodies:
        if isinstance(part.body, Body) and any(e.role == "structure" for e in part.body.effects):
            diagram = diagram.with_block(part.name, without_absent(part.body))
    return with_tips(diagram), led_motion(diagram, motion)
