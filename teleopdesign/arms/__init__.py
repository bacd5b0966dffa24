"""Arms: chains of links on joints, their kinematics, and the joint forces of their motion."""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .chain import INERTIAL as INERTIAL
    from .chain import Chain as Chain
    from .chain import Link as Link
    from .chain import inertia_about as inertia_about
    from .chain import rotation_of as rotation_of
    from .regressor import BaseParameters as BaseParameters
    from .regressor import base_parameters as base_parameters
    from .regressor import force_columns as force_columns
    from .urdf import read_urdf as read_urdf

__getattr__, __dir__, __all__ = lazy_face(__name__)
