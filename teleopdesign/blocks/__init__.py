"""Blocks of a diagram, as equations only: bodies, environments, hands, impedances."""

from ..base.arguments import check_arguments
from ..effects import BLOCK_EFFECTS, with_block_effects
from .body import Body
from .body_equation import CONTACT, BodyEquation, compose_equation, solve_carried_force
from .environments import free_space, hand, hunt_crossley, soft_rubber, spring_damper
from .matrix_impedance import MatrixImpedance, matrix_impedance
from .value import NINETY_FIVE, Value

ARM = BLOCK_EFFECTS["arm"]
CONTACT_HYSTERESIS = BLOCK_EFFECTS["contact_hysteresis"]
IMPACT_DAMPING = BLOCK_EFFECTS["impact_damping"]

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
    "compose_equation",
    "free_space",
    "hand",
    "hunt_crossley",
    "matrix_impedance",
    "soft_rubber",
    "solve_carried_force",
    "spring_damper",
    "with_block_effects",
]

check_arguments(globals(), __all__)
