"""Which blocks, wired by signal names."""

from .haptic_interface import four_cases, haptic_interface
from .wiring import ANY, AnyBlock, Attached, Block, Control, Diagram, Junction, Moving
from .world_haptics_2005 import READINGS, Reading, reading, world_haptics_2005

__all__ = [
    "ANY",
    "READINGS",
    "AnyBlock",
    "Attached",
    "Block",
    "Control",
    "Diagram",
    "Junction",
    "Moving",
    "Reading",
    "four_cases",
    "haptic_interface",
    "reading",
    "world_haptics_2005",
]
