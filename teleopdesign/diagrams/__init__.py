"""Block diagrams: blocks that are wired by the names of their signals."""

from ..base.arguments import check_arguments
from .admittance_device import admittance_device
from .arms import Arm, joint, teleoperator_of_arms, tip_coordinates
from .control_parts import controller_parts, plant_parts
from .coupled_plants import coupled_plant_parts
from .disturbance_observer import disturbance_observer
from .energy_tanks import energy_tanks
from .felt_friction import FeltFriction, felt_friction
from .four_channel import four_channel
from .haptic_interface import four_cases, haptic_interface
from .junctions import Junction, Kinematics, position_symbol
from .parallel_rods import parallel_rods
from .parts import ANY, AnyBlock, Attached, Block, Control, Linked, Moving, Part
from .shared_states import with_shared_states
from .shipped import SHIPPED, load_shipped
from .teleoperator import teleoperator
from .toml_reading import read_diagram
from .toml_writing import write_diagram
from .wave_variables import wave_variables
from .wiring import Diagram
from .world_haptics_2005 import READINGS, Reading, read_open_number, world_haptics_2005

__all__ = [
    "ANY",
    "READINGS",
    "SHIPPED",
    "AnyBlock",
    "Arm",
    "Attached",
    "Block",
    "Control",
    "Diagram",
    "FeltFriction",
    "Junction",
    "Kinematics",
    "Linked",
    "Moving",
    "Part",
    "Reading",
    "admittance_device",
    "tip_coordinates",
    "controller_parts",
    "coupled_plant_parts",
    "disturbance_observer",
    "energy_tanks",
    "felt_friction",
    "four_cases",
    "four_channel",
    "haptic_interface",
    "joint",
    "parallel_rods",
    "plant_parts",
    "position_symbol",
    "read_diagram",
    "read_open_number",
    "load_shipped",
    "teleoperator",
    "teleoperator_of_arms",
    "wave_variables",
    "with_shared_states",
    "world_haptics_2005",
    "write_diagram",
]

check_arguments(globals(), __all__)
