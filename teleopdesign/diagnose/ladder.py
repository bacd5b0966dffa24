"""The ladder of a diagnosis, over the parts of an experiment.

A part is what is searched together: the one or two bodies of an experiment, or one joint of an arm.
The joints of an arm share the parameters of its links. A missing effect at one joint gives wrong
parameters of the links, so other joints seem to lack effects too. So the first joint is the one
whose effect removes most of the squares of all joints. The other joints are searched again with the
new information on the links.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace

from ..check import CheckedRecording, why_silent
from ..effects import SIGNALS, Effect
from ..measurement.experiment import Experiment, isolate_joint
from ..model import Model
from .climb import climb
from .conclusion import end_of
from .cores import one_thread_of_algebra
from .diagnosis import Diagnosis
from .ladder_state import LadderSearch, begin, restrict_candidates, search_for
from .narrower_band import choose_band, narrower_to_search
from .other_motion import undetermined_coupling, with_other_motions
from .part_search import (
    PartSearch,
    begin_part,
    hold_against_others,
    others_of,
    with_clock_of_others,
    with_known,
    with_shifts_of,
)
from .parts import PreparedParts, prepare_parts
from .parts_fit import PartsFit, PartsRung, as_bodies, estimate_parts
from .parts_result import diagnosis_of_parts
from .result import diagnosis_of
from .search_plan import PLAN, SearchPlan


@one_thread_of_algebra()
def find_missing(
    experiment: Experiment,
    model: Model | None = None,
    *,
    progress: Callable[[str], None] | None = None,
    seed: int = 0,
    plan: SearchPlan = PLAN,
    among: Collection[str] | None = None,
) -> Diagnosis:
    """Compare a model with an experiment and add the effects that its check records support.

    model: of an arm with a body for each joint; None: the model that the experiment describes
    Of more than `SearchPlan.long` samples, only `SearchPlan.windows` samples are searched, in
    windows spread evenly over the records; errors are those of the whole records. Those of an arm
    are searched whole.
    progress: called with a line of text at each step (a `ProgressLine` while candidates are fitted)
    seed: of the random numbers for the noise floor;  plan: extent of the search, such as `QUICK`
    among: names of the candidate effects; None: all that the model knows
    raises ExperimentError: the experiment lacks what the comparison needs
    raises ModelError: `among` holds an unknown name
    """
    stated, report = model or Model.from_experiment(experiment), progress or (lambda _: None)
    if among is not None:
        stated = restrict_candidates(among, stated)

    def search(bandwidth: float | None = None) -> Diagnosis:
        prepared, parts, first = begin_parts(
            experiment, stated, report, bandwidth=bandwidth, seed=seed, plan=plan
        )
        rungs = climb_parts(parts, first, prepared, report)
        return diagnosis_of_parts(*conclude_parts(prepared, parts, rungs), stated)

    diagnosis = search()
    if (band := narrower_to_search(diagnosis)) is not None:
        report(f"once more, up to {band.bandwidth:.3g} Hz")
        diagnosis = choose_band(diagnosis, search(band.bandwidth))
    return diagnosis if among is None else _with_candidates_named(among, diagnosis)


def _with_candidates_named(among: Collection[str], diagnosis: Diagnosis) -> Diagnosis:
    """The diagnosis, with the names of the candidates that its search was restricted to."""
    words = f"only these effects were candidates: {', '.join(sorted(among))}"
    joints = {j: _with_candidates_named(among, one) for j, one in diagnosis.joints.items()}
    return replace(diagnosis, left_out=(*diagnosis.left_out, words), joints=joints)


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
    silence = why_silent(CheckedRecording(prepared.experiment, stated))
    prepared = replace(prepared, silence=silence)
    known = stated.known if prepared.base is None else _select_beyond_links(stated.known)
    known = {} if silence else known
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
            silence="The records of the arm tell no effect." if silence else "",
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
) -> tuple[PreparedParts, tuple[PartsRung, ...], dict[str, Diagnosis]]:
    """What each part states, with the final links and the motions that couplings follow.

    joints: the parts;  rungs: of all parts
    returns: the records, the rungs, and the diagnosis of each part
    """
    prepared = with_other_motions(prepared, others_of(joints))
    last = with_shifts_of(joints, rungs[-1].fit, prepared)
    rungs = (*rungs[:-1], replace(rungs[-1], fit=last))
    ends = {}
    for j, fit in last.fits.items():
        ladder = (*joints[j].rungs[:-1], replace(joints[j].rungs[-1], fit=fit))
        end = end_of(joints[j].search, joints[j].state, ladder)
        ends[j] = diagnosis_of(end, beside=prepared.beside(j))
    for rung in rungs:
        if rung.added is None or rung.follows is None:
            continue
        at = rung.added.at
        coupling = undetermined_coupling(rung, last, prepared)
        if coupling is not None:
            more = (*ends[at].undetermined, coupling)
            ends[at] = replace(ends[at], undetermined=more)
    return prepared, rungs, ends
