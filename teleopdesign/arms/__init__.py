"""Arms: chains of links on joints, their kinematics, and the joint forces of their motion."""

from .base_parameters import BaseParameters, base_parameters
from .chain import INERTIAL, Chain, Link, inertia_about, rotation_of
from .regressor import force_columns
from .urdf import read_urdf

__all__ = [
    "INERTIAL",
    "Chain",
    "BaseParameters",
    "Link",
    "base_parameters",
    "force_columns",
    "inertia_about",
    "read_urdf",
    "rotation_of",
]
