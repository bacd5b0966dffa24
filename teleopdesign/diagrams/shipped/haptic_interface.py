"""Haptic interface: device, hand, cancellation, force feedback, position loop; no values."""

from ..haptic_interface import haptic_interface
from ..parts import ANY
from ..wiring import Diagram


def diagram() -> Diagram:
    """The wiring with every block that it can have."""
    return haptic_interface(hand=ANY, cancellation=ANY, force_feedback=ANY, position_loop=ANY)
