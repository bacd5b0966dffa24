"""The ladder over all parts: effects at the joints of an arm, by their gain for the whole arm.

A missing effect at one joint gives wrong parameters of the links, so other joints seem to lack
effects too. So the first joint is the one whose effect removes most of the squares of all joints.
The other joints are searched again with the new information on the links. The bodies of a plain
experiment are one part, which no links join to others.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from ..effects import SIGNALS, Effect
from ..measurement.experiment import Experiment
from ..model import Model
from .climb import climb
from .conclusion import conclude
from .fit import Fit
from .held_against_others import hold_against_others
from .ladder_end import LadderEnd
from .ladder_state import LadderSearch, begin, search_for
from .other_motion import undetermined_coupling, with_other_motions
from .part_search import (
    PartSearch,
    begin_part,
    others_of,
    with_clock_of_others,
    with_known,
    with_shifts_of,
)
from .parts import PreparedParts, isolate_joint, prepare_parts
from .parts_fit import PartsFit, PartsRung, as_bodies, estimate_parts
from .search_plan import SearchPlan


def begin_parts(
    experiment: Experiment,
    stated: Model,
    report: Callable[[str], None],
    *,
    bandwidth: float | None,
    seed: int,
    plan: SearchPlan,
) -> tuple[PreparedParts, dict[str, PartSearch], PartsFit]:
    """The records, each part with the user's model re-estimated, and the fit of all parts.

    bandwidth: Hz; None: that of the experiment;  the rest as in `find_missing`
    """
    prepared = prepare_parts(experiment, bandwidth=bandwidth, seed=seed)
    if prepared.joints:
        return _begin_joints(prepared, stated, report, seed=seed, plan=plan)
    (whole,) = prepared.parts.values()
    search = search_for(whole, stated, progress=report, seed=seed, plan=plan)
    part = PartSearch("", search, begin(search))
    return prepared, {"": part}, PartsFit({"": part.state.fit}, {"": search.prepared})


def _begin_joints(
    prepared: PreparedParts,
    stated: Model,
    report: Callable[[str], None],
    *,
    seed: int,
    plan: SearchPlan,
) -> tuple[PreparedParts, dict[str, PartSearch], PartsFit]:
    """As `begin_parts`, where links join the parts."""
    known = stated.known if prepared.base is None else _select_beyond_links(stated.known)
    models = {
        j: Model({j: body}, known).with_links(prepared.initial) for j, body in stated.bodies.items()
    }
    report("re-estimating the model")
    first = estimate_parts(models, prepared)
    prepared, models = as_bodies(prepared, first)
    first = estimate_parts(models, prepared, rounds=1)
    joints: dict[str, PartSearch] = {}
    for j in prepared.parts:
        search = LadderSearch(
            experiment=isolate_joint(prepared.experiment, j),
            whole=first.prepared[j],
            prepared=first.prepared[j],
            stated=models[j],
            seed=seed,
            plan=plan.for_joints(len(prepared.parts)),
            progress=lambda text, j=j: report(f"{j}: {text}"),  # type: ignore[misc]
        )
        records = with_clock_of_others(first.prepared, first.fits, j)
        joints[j] = begin_part(j, search, records, first.fits[j].model, prepared)
    return prepared, joints, with_shifts_of(joints, first, prepared)


def _select_beyond_links(known: Mapping[str, Effect]) -> dict[str, Effect]:
    """The effects that the base parameters cannot describe.

    A force that depends on the joint's acceleration alone is left out: the inertia of each motor is
    a base parameter already, and the two cannot be distinguished.
    """
    inertia = {SIGNALS["acceleration"]}
    return {
        name: effect
        for name, effect in known.items()
        if effect.role != "force"
        or effect.expression().free_symbols & set(SIGNALS.values()) != inertia
    }


def climb_parts(
    joints: dict[str, PartSearch],
    first: PartsFit,
    prepared: PreparedParts,
    report: Callable[[str], None],
) -> tuple[PartsRung, ...]:
    """Climb the ladder of each part.

    joints: the parts; replaced in place by their final states;  first: the user's model
    returns: the ladder of all parts, its rungs in the order of the climbs
    """
    waiting: list[str] = list(joints)
    rungs: tuple[PartsRung, ...] = (PartsRung(None, first),)
    while waiting:
        j = max(waiting, key=lambda name: joints[name].gain)
        here = joints[j]
        if here.is_stale:
            records = {n: x.search.prepared for n, x in joints.items()}
            beside = with_other_motions(prepared, others_of(joints))
            fresh = with_known(records, {n: x.state.fit for n, x in joints.items()}, beside, j)
            joints[j] = begin_part(j, here.search, fresh, here.state.fit.model, prepared)
            continue
        beside = with_other_motions(prepared, others_of(joints))
        joints[j], rungs = _climb_part(here, rungs, beside, report)
        waiting.remove(j)
        if len(joints[j].state.rungs) > 1:
            for other in waiting:
                joints[other] = replace(joints[other], is_stale=True)
    return rungs


def _climb_part(
    part: PartSearch,
    rungs: tuple[PartsRung, ...],
    prepared: PreparedParts,
    report: Callable[[str], None],
) -> tuple[PartSearch, tuple[PartsRung, ...]]:
    """Climb the ladder of a part, and test its effects on the whole arm.

    Where an effect is refused on the arm, the ladder continues without it, and later effects may be
    added again. It ends where no further effect is refused.
    returns: the part at the end of its ladder, and the ladder of all parts with its rungs
    """
    while True:
        state, final = climb(part.search, part.state)
        if not prepared.joints:  # one part alone: its ladder is that of the experiment
            records = {part.name: part.search.prepared}
            each = [PartsRung(r.added, PartsFit({part.name: r.fit}, records)) for r in final]
            return replace(part, state=state, rungs=final), tuple(each)
        report(f"{part.name}: all joints together")
        gone = {one.candidate.key for one in state.set_aside}
        part, rungs = hold_against_others(replace(part, state=state), rungs, prepared)
        if gone.issuperset(one.candidate.key for one in part.state.set_aside):
            return replace(part, rungs=part.state.rungs), rungs


def conclude_parts(
    prepared: PreparedParts, joints: dict[str, PartSearch], rungs: tuple[PartsRung, ...]
) -> tuple[PreparedParts, tuple[PartsRung, ...], dict[str, LadderEnd]]:
    """The end of each part's ladder, with the final links and the motions that couplings follow.

    joints: the parts;  rungs: of all parts
    returns: the records, the rungs, and the end of each part
    """
    prepared = with_other_motions(prepared, others_of(joints))
    last = with_shifts_of(joints, rungs[-1].fit, prepared)
    rungs = (*rungs[:-1], replace(rungs[-1], fit=last))
    ends = {j: _conclude_part(joints[j], last.fits[j], prepared) for j in prepared.parts}
    for rung in rungs:
        if rung.added is None or rung.follows is None:
            continue
        at = rung.added.at
        coupling = undetermined_coupling(rung, last, prepared)
        if coupling is not None:
            more = (*ends[at].undetermined, coupling)
            ends[at] = replace(ends[at], undetermined=more)
    return prepared, rungs, ends


def _conclude_part(part: PartSearch, fit: Fit, prepared: PreparedParts) -> LadderEnd:
    """The end of one part's ladder, its last rung with the final links."""
    rungs = (*part.rungs[:-1], replace(part.rungs[-1], fit=fit))
    return conclude(part.search, part.state, rungs, beside=prepared.beside(part.name))
