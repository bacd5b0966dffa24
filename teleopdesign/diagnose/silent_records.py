"""Records that tell no effect, whatever is left: nothing is named then, and the reason is given."""

from __future__ import annotations

from ..measurement.encoder import rests
from ..model import Model
from .constant_force import describe_constant_force, lacks_scale
from .hidden_motion import describe_hidden_motion
from .jitter import describe_jitter, is_much_jitter
from .prepare import Prepared
from .unknown_drive import describe_work
from .unsigned_force import describe_unsigned


def why_silent(prepared: Prepared, model: Model) -> str:
    """Why these records tell no effect, as the end of a verdict; "" where they may tell one.

    model: of the user, with the inertias that are known
    """
    if lacks_scale(prepared.stretches, model):
        return describe_constant_force()
    if rests_throughout_check(prepared):
        return (
            "The body rests throughout the check records, where any friction explains the force: "
            "they cannot check a model."
        )
    if hidden := describe_hidden_motion(prepared, model):
        return hidden
    if prepared.is_linked:  # its accelerations come from all joints together
        return ""
    if work := describe_work(prepared.experiment):
        return work
    if size := describe_unsigned(prepared.experiment):
        return size
    much = is_much_jitter(prepared.of("fit"), prepared.experiment)
    return describe_jitter() if much else ""


def rests_throughout_check(prepared: Prepared) -> bool:
    """Whether no body moves by more than one step of its readings in any check record."""
    motions = [s.motion for s in prepared.of("check")]
    return bool(motions) and all(rests(m.position, m.step) for m in motions)
