"""Controllers that read one signal and act along the velocity of another signal."""

from __future__ import annotations

import sympy as sp

from ..base.errors import ModelError
from ..controllers import Controller
from .parts import Control
from .wiring import Diagram


def acts_along_another(diagram: Diagram, part: Control) -> bool:
    """Whether the law uses the velocity of a motion that is not its input.

    Its linear form then has two transfer functions: from the input, and from that motion.
    """
    if not part.motion or part.input == part.motion:
        return False
    if not isinstance(part.controller, Controller) or not part.controller.sees_velocity:
        return False
    if not (diagram.is_position(part.input) and diagram.is_position(part.motion)):
        return True
    apart = diagram.position(part.input) - diagram.position(part.motion)
    return bool(sp.expand(apart) != 0)


def without_motion(where: str) -> ModelError:
    """The error for a law that uses a velocity when no motion is wired to it."""
    return ModelError(
        f'{where}: its law sees a velocity, and no motion is wired: motion="X" says along which'
    )
