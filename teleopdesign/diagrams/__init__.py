"""Block diagrams: blocks that are wired by the names of their signals."""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .arms import Arm as Arm
    from .arms import joint as joint
    from .arms import teleoperator_of_arms as teleoperator_of_arms
    from .arms import tip_coordinates as tip_coordinates
    from .control_parts import controller_parts as controller_parts
    from .control_parts import plant_parts as plant_parts
    from .coupled_plants import coupled_plant_parts as coupled_plant_parts
    from .disturbance_observer import disturbance_observer as disturbance_observer
    from .energy_tanks import energy_tanks as energy_tanks
    from .junctions import Junction as Junction
    from .junctions import Kinematics as Kinematics
    from .junctions import position_symbol as position_symbol
    from .parallel_rods import FeltFriction as FeltFriction
    from .parallel_rods import felt_friction as felt_friction
    from .parallel_rods import parallel_rods as parallel_rods
    from .parts import ANY as ANY
    from .parts import AnyBlock as AnyBlock
    from .parts import Attached as Attached
    from .parts import Block as Block
    from .parts import Control as Control
    from .parts import Linked as Linked
    from .parts import Moving as Moving
    from .parts import Part as Part
    from .shared_states import with_shared_states as with_shared_states
    from .shipped import SHIPPED as SHIPPED
    from .shipped import load_shipped as load_shipped
    from .shipped.admittance_device import admittance_device as admittance_device
    from .shipped.four_channel import four_channel as four_channel
    from .shipped.haptic_interface import four_cases as four_cases
    from .shipped.haptic_interface import haptic_interface as haptic_interface
    from .shipped.teleoperator import teleoperator as teleoperator
    from .shipped.wave_variables import wave_variables as wave_variables
    from .shipped.world_haptics_2005 import READINGS as READINGS
    from .shipped.world_haptics_2005 import Reading as Reading
    from .shipped.world_haptics_2005 import read_open_number as read_open_number
    from .shipped.world_haptics_2005 import world_haptics_2005 as world_haptics_2005
    from .toml_reading import read_diagram as read_diagram
    from .toml_writing import write_diagram as write_diagram
    from .wiring import Diagram as Diagram

__getattr__, __dir__, __all__ = lazy_face(__name__)
