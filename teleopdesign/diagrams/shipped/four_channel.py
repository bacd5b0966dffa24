"""Lawrence's four-channel teleoperator with 20 ms of delay in each channel, no other values."""

from ..four_channel import four_channel as wired
from ..parts import ANY
from ..wiring import Diagram


def diagram() -> Diagram:
    """The wiring with all optional blocks except scales; motions and forces are not scaled."""
    return wired(hand=ANY, environment=ANY, delay=0.02)
