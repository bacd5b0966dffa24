"""Admittance-controlled interface: device, virtual admittance, position loop, hand; no values."""

from ..admittance_device import admittance_device as wired
from ..parts import ANY
from ..wiring import Diagram


def diagram() -> Diagram:
    """The wiring with every block that it can have."""
    return wired(hand=ANY)
