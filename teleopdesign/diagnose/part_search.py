"""One part during the search; a joint of an arm with what the others tell about the links."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..blocks import Value
from ..measurement.prepare import Prepared
from ..model import Model
from .fit import Fit, estimate, fit_squares
from .ladder_state import LadderSearch, LadderState, look
from .link_knowledge import joint_knowledge, with_others
from .other_motion import most_coupled, with_other_motion
from .parts import PreparedParts
from .parts_fit import PartsFit, estimate_parts
from .record_shift import shifts_of
from .rung import Rung


@dataclass(frozen=True)
class PartSearch:
    """State of the search in one part.

    is_stale: whether effects of other joints have changed the information on the links
    other: the joint whose motion is its channel `other_position`; None: none was chosen
    rungs: of its ladder, with their final errors; empty before it was climbed
    """

    name: str
    search: LadderSearch
    state: LadderState
    is_stale: bool = False
    other: str | None = None
    rungs: tuple[Rung, ...] = ()

    @property
    def gain(self) -> float:
        """Largest decrease of squares by a supported effect, over the joint's measured squares."""
        base = fit_squares(self.state.fit)
        fits = [r.fit for r in self.state.supported]
        whole = sum(s.measured for s in self.search.prepared.of("fit"))
        return max((base - fit_squares(f) for f in fits), default=0.0) / whole


def begin_part(
    name: str, search: LadderSearch, records: Prepared, model: Model, prepared: PreparedParts
) -> PartSearch:
    """A joint at the start of its search, with the present information on the links.

    records: of the joint, with this information;  prepared: of the arm
    """
    fit = estimate(model, records)
    other = most_coupled(name, records, fit, prepared)
    if other is not None:
        records = with_other_motion(records, prepared.parts[other])
    search = replace(search, whole=records, prepared=records)
    return PartSearch(name, search, look(search, (Rung(None, fit),)), other=other)


def others_of(joints: Mapping[str, PartSearch]) -> dict[str, str]:
    """Joint -> the joint whose motion is its channel `other_position`, where one was chosen."""
    return {name: one.other for name, one in joints.items() if one.other is not None}


def with_shifts_of(
    joints: Mapping[str, PartSearch], fit: PartsFit, prepared: PreparedParts
) -> PartsFit:
    """The arm's fit, with those shifts of records held that the searches hold.

    A shift that raises the check error of its joint is held in the search at this joint. The fit of
    all joints estimates it again unless it is held there, too.
    returns: the fit itself where the same shifts are held, or where no less is left
    """
    models = {j: one.model for j, one in fit.fits.items()}
    changed = dict[str, Model]()
    for j, model in models.items():
        shifts = joints[j].state.fit.model.record_shift
        if _list_held(shifts) != _list_held(model.record_shift):
            changed[j] = model.with_record_shift(shifts)
    if not changed:
        return fit
    again = estimate_parts({**models, **changed}, prepared)
    return again if again.check_error < fit.check_error else fit


def _list_held(shifts: Mapping[str, Value]) -> list[tuple[str, float]]:
    """The logs whose shift is held, and this shift."""
    return sorted((log, late.value) for log, late in shifts.items() if late.fixed)


def with_clock_of_others(
    records: Mapping[str, Prepared], fits: Mapping[str, Fit], joint: str
) -> Prepared:
    """Records of a joint with the shift of the logs of the other joints, by their fits.

    It is the median of the shifts that were estimated, weighted by their information: one joint
    whose drive is late does not move it. A shift at its bound is no estimate.
    """
    shifts = [
        (shift.late, shift.stderr**-2)
        for j, fit in fits.items()
        for shift in shifts_of(fit.model, records[j].stretches)
        if j != joint and shift.at == j and not (shift.held or shift.at_bound)
        if shift.stderr > 0.0
    ]
    late = _weighted_median(shifts) if shifts else None
    return replace(records[joint], late_beside=late)


def _weighted_median(pairs: Sequence[tuple[float, float]]) -> float:
    """The value up to which half of the weight lies; pairs: value and weight."""
    values, weights = np.array(sorted(pairs)).T
    return float(values[np.searchsorted(np.cumsum(weights), 0.5 * weights.sum())])


def with_known(
    records: dict[str, Prepared], fits: dict[str, Fit], prepared: PreparedParts, joint: str
) -> Prepared:
    """Records of a joint with what the fits of the other joints say of the links and the clock."""
    mine = with_clock_of_others(records, fits, joint)
    if prepared.base is None:
        return mine
    known, sizes = joint_knowledge({j: f.model for j, f in fits.items()}, records, prepared)
    return with_others(mine, known, sizes[joint], fits[joint].model)
