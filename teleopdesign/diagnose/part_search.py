"""One part during the search; a joint of an arm with what the others tell about the links.

The records of one joint may support an effect that imitates a missing effect of another joint, or
an error of the links' parameters. When all joints are estimated together, such an effect no longer
lowers the error, and is set aside.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import takewhile

import numpy as np

from ..blocks import Value
from ..measurement.prepare import Prepared
from ..model import Model
from .climb import is_of_readings
from .criteria import CRITERIA
from .decision import is_better
from .fit import Fit, estimate, fit_squares
from .ladder_state import LadderSearch, LadderState, look
from .link_knowledge import joint_knowledge, with_others
from .noise_floor import noise_floor
from .other_motion import most_coupled, with_other_motion
from .parts import PreparedParts
from .parts_fit import PartsFit, PartsRung, estimate_parts
from .record_shift import shifts_of
from .rung import Rung
from .statements import SetAside


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
    if not shifts:
        return replace(records[joint], late_beside=None)
    late, weights = np.array(shifts).T
    middle = np.quantile(late, 0.5, weights=weights, method="inverted_cdf")
    return replace(records[joint], late_beside=float(middle))


def with_known(
    records: dict[str, Prepared], fits: dict[str, Fit], prepared: PreparedParts, joint: str
) -> Prepared:
    """Records of a joint with what the fits of the other joints say of the links and the clock."""
    mine = with_clock_of_others(records, fits, joint)
    if prepared.base is None:
        return mine
    known = joint_knowledge({j: f.model for j, f in fits.items()}, records, prepared)
    return with_others(mine, known, prepared.size[joint], fits[joint].model)


#: reason why an effect is refused although the records of one joint supported it
NO_HELP = "it lowers the error no more once all joints are estimated together"
#: the same reason for an effect that only attenuates readings: error and noise floor fall together
NO_MORE_THAN_NOISE = "it only weakens the noise of the sensors"


def hold_against_others(
    joint: PartSearch, rungs: tuple[PartsRung, ...], prepared: PreparedParts
) -> tuple[PartSearch, tuple[PartsRung, ...]]:
    """The rungs of a joint's ladder, each with all joints estimated again.

    rungs: the ladder of the arm so far, those of this joint last; rungs that the joint's ladder
        still starts with are not estimated again
    returns: the joint, its ladder cut at the first refused effect, which is set aside; and the
        ladder of the arm with the joint's remaining rungs
    """
    there = [r for r in rungs if r.added is not None and r.added.at == joint.name]
    kept = _count_held(joint, there)
    longer = list(rungs[: len(rungs) - len(there) + kept - 1])
    waiting, why = list[PartsRung](), ""
    for i, rung in enumerate(joint.state.rungs[kept:], kept):
        last = waiting[-1] if waiting else longer[-1]
        models = {n: f.model for n, f in last.fit.fits.items()} | {joint.name: rung.fit.model}
        fit = estimate_parts(models, prepared)
        waiting.append(PartsRung(rung.added, fit, rung.instead_of, joint.other))
        why = refusal(joint, last.fit, fit)
        if why:
            break
        # of two effects that mask each other only the second helps, when both are in the model
        before, after = longer[-1].fit.fits[joint.name], fit.fits[joint.name]
        if is_better(before, after, joint.state.floor):
            longer, waiting, kept = [*longer, *waiting], [], i + 1
    if waiting:
        joint = _cut_ladder(joint, kept, waiting, why or NO_HELP)
    return joint, tuple(longer)


def _count_held(joint: PartSearch, there: Sequence[PartsRung]) -> int:
    """Number of leading rungs that the ladders of joint and arm share; the user's model counts."""
    ours = ((r.added, r.instead_of) for r in joint.state.rungs[1:])
    held = ((r.added, r.instead_of) for r in there)
    pairs = zip(held, ours, strict=False)
    return 1 + sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], pairs))


def refusal(joint: PartSearch, before: PartsFit, after: PartsFit) -> str:
    """Why an effect is removed once all joints are estimated together; "": it stays.

    An effect may transmit less of the sensor noise: the hidden tip of a structure follows the
    measured force and a part of its noise. Such an effect must lower the error more than the noise,
    and where the readings alone explain the error before, it must leave surely fewer noise floors.
    """
    if after.check_error > before.check_error:
        return NO_HELP
    records, name = joint.search.prepared, joint.name
    sensors, there = (
        noise_floor(fit.fits[name].model, records, joint.search.generator()).drawn ** 2
        for fit in (before, after)
    )
    kept = 1.0 - CRITERIA.relative_improvement
    if there >= kept * sensors:
        return ""
    left, leaves = (fit.check_errors[name] ** 2 for fit in (before, after))
    of_readings = sensors > 0.0 and is_of_readings((left / sensors) ** 0.5)
    most = CRITERIA.weakened**2 if of_readings else kept
    explains = leaves * sensors <= most * there * left
    return "" if explains else NO_MORE_THAN_NOISE


def _cut_ladder(joint: PartSearch, kept: int, refused: Sequence[PartsRung], why: str) -> PartSearch:
    """The joint with the first `kept` rungs of its ladder; the refused effects are set aside.

    refused: with all joints estimated again
    """
    state = joint.state
    aside = [
        SetAside(
            r.added, r.fit.check_errors[joint.name], why, of_readings=why == NO_MORE_THAN_NOISE
        )
        for r in refused
        if r.added is not None
    ]
    fewer = replace(state.with_rungs(state.rungs[:kept]), set_aside=(*state.set_aside, *aside))
    return replace(joint, state=look(joint.search, fewer.rungs, fewer))
