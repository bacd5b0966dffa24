"""Haptic interface of Bernstein, Lawrence, Pao, World Haptics 2005, at the readings used."""

from ..wiring import Diagram
from ..world_haptics_2005 import world_haptics_2005


def diagram() -> Diagram:
    """With the position loop of its experiments."""
    return world_haptics_2005(position_loop=True)
