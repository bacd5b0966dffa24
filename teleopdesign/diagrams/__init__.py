"""Which blocks, wired by signal names."""

from .haptic_interface import four_cases, haptic_interface
from .parts import (
    ANY,
    AnyBlock,
    Attached,
    Block,
    Control,
    Junction,
    Kinematics,
    Linked,
    Moving,
    Part,
    position_symbol,
)
from .teleoperator import teleoperator
from .wiring import Diagram
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
    "Kinematics",
    "Linked",
    "Moving",
    "Part",
    "Reading",
    "four_cases",
    "haptic_interface",
    "position_symbol",
    "reading",
    "teleoperator",
    "world_haptics_2005",
]
