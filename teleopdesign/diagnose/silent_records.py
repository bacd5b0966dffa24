"""Records that tell no effect, whatever is left: nothing is named then, and the reason is given."""

from __future__ import annotations

from ..model import Model
from .constant_force import describe_constant_force, lacks_scale
from .jitter import describe_jitter, is_much_jitter
from .prepare import Prepared


def why_silent(prepared: Prepared, model: Model) -> str:
    """Why these records tell no effect, as the end of a verdict; "" where they may tell one.

    model: of the user, with the inertias that are known
    """
    if lacks_scale(prepared.stretches, model):
        return describe_constant_force()
    if prepared.is_of_an_arm:  # its accelerations come from all joints together
        return ""
    much = is_much_jitter(prepared.of("fit"), prepared.experiment)
    return describe_jitter() if much else ""
