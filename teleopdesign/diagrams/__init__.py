"""Which blocks, wired by signal names."""

from .haptic_interface import four_cases, haptic_interface
from .shipped import SHIPPED, shipped
from .toml_reading import read_diagram
from .toml_writing import write_diagram
from .wiring import ANY, AnyBlock, Attached, Block, Control, Diagram, Junction, Moving
from .world_haptics_2005 import READINGS, Reading, reading, world_haptics_2005

__all__ = [
    "ANY",
    "READINGS",
    "SHIPPED",
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
    "read_diagram",
    "reading",
    "shipped",
    "world_haptics_2005",
    "write_diagram",
]
