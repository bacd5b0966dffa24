"""Teleoperator of wave variables with 20 ms of delay each way, no other values."""

from ..parts import ANY
from ..wave_variables import wave_variables as wired
from ..wiring import Diagram


def diagram() -> Diagram:
    """The wiring with every block that it can have."""
    return wired(hand=ANY, environment=ANY, delay=0.02)
