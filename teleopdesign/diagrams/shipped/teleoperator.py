"""Teleoperator under position-position control with a cancellation on either side, no values."""

from ..parts import ANY
from ..teleoperator import teleoperator
from ..wiring import Diagram


def diagram() -> Diagram:
    """The wiring with every block that it can have."""
    return teleoperator(hand=ANY, environment=ANY, master_cancellation=ANY, slave_cancellation=ANY)
