"""Blocks of a diagram: equations only."""

from ..arguments import check_arguments
from .arm import ARM
from .body import NINETY_FIVE, Body, BodyEquation, Value
from .contact_hysteresis import CONTACT_HYSTERESIS
from .environment import CONTACT
from .environments import free_space, hunt_crossley, soft_rubber, spring_damper
from .every_effect import BLOCK_EFFECTS, with_block_effects
from .hand import hand
from .impact_damping import IMPACT_DAMPING
from .matrix_impedance import MatrixImpedance, matrix_impedance

__all__ = [
    "ARM",
    "BLOCK_EFFECTS",
    "CONTACT",
    "CONTACT_HYSTERESIS",
    "IMPACT_DAMPING",
    "NINETY_FIVE",
    "Body",
    "BodyEquation",
    "MatrixImpedance",
    "Value",
    "free_space",
    "hand",
    "hunt_crossley",
    "matrix_impedance",
    "soft_rubber",
    "spring_damper",
    "with_block_effects",
]

check_arguments(globals(), __all__)
