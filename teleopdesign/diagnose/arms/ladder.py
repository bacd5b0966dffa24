"""The ladder of an arm: effects at its joints, in the order of their gain for the whole arm.

A missing effect at one joint gives wrong parameters of the links, so other joints seem to lack
effects too. So the first joint is the one whose effect removes most of the squares of all joints.
The other joints are searched again with the new information on the links.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace

from ...effects import SIGNALS, Effect
from ...measurement.experiment import Experiment
from ...model import Model
from ..conclusion import conclude
from ..diagnosis import Diagnosis
from ..fit import Fit, fit_squares
from ..ladder import climb
from ..ladder_end import LadderEnd
from ..ladder_state import LadderSearch, LadderState, restrict_candidates
from ..moves import add
from ..rung import Rung
from ..search_plan import PLAN, SearchPlan
from .bodies import as_bodies
from .fit import ArmFit, estimate_arm
from .joint import (
    Joint,
    begin_joint,
    others_of,
    with_clock_of_others,
    with_known,
    with_shifts_of,
)
from .other_motion import with_other_motions
from .other_way import undetermined_coupling
from .prepared import PreparedArm, isolate_joint, prepare_arm
from .refusal import hold_against_arm
from .result import arm_diagnosis_of
from .rung import ArmRung


def find_missing_in_arm(
    experiment: Experiment,
    model: Model | None = None,
    *,
    progress: Callable[[str], None] | None = None,
    seed: int = 0,
    plan: SearchPlan = PLAN,
    among: Collection[str] | None = None,
) -> Diagnosis:
    """Compare an arm with an experiment and add the effects that its check records support.

    model: with a body for each joint; None: the model that the experiment describes
    progress: called with a line of text at each step
    seed: of the random numbers for the noise floor
    plan: extent of the search, such as `QUICK`
    among: names of the candidate effects; None: all that the model knows
    raises ExperimentError: the experiment has no arm, or lacks what the comparison needs
    raises ModelError: `among` holds an unknown name
    """
    report = progress or (lambda _: None)
    stated = model or Model.from_experiment(experiment)
    if among is not None:
        stated = restrict_candidates(among, stated)
    report("forces of the links along the measured motion")
    prepared = prepare_arm(experiment, seed=seed)
    known = stated.known if prepared.base is None else _select_beyond_links(stated.known)
    models = {
        j: Model({j: body}, known).with_links(prepared.initial) for j, body in stated.bodies.items()
    }
    report("re-estimating the model")
    first = estimate_arm(models, prepared)
    prepared, models = as_bodies(prepared, first)
    first = estimate_arm(models, prepared, rounds=1)
    joints: dict[str, Joint] = {}
    for j in prepared.joints:
        search = LadderSearch(
            experiment=isolate_joint(experiment, j),
            whole=first.prepared[j],
            prepared=first.prepared[j],
            stated=models[j],
            seed=seed,
            plan=plan.for_joints(len(prepared.joints)),
            progress=lambda text, j=j: report(f"{j}: {text}"),  # type: ignore[misc]
        )
        records = with_clock_of_others(first.prepared, first.fits, j)
        joints[j] = begin_joint(j, search, records, first.fits[j].model, prepared)
    rungs = _climb(joints, with_shifts_of(joints, first, prepared), prepared, report)
    prepared = with_other_motions(prepared, others_of(joints))
    last = with_shifts_of(joints, rungs[-1].fit, prepared)
    rungs = (*rungs[:-1], replace(rungs[-1], fit=last))
    ends = _conclude(prepared, joints, rungs)
    motors = {j: stated.parameters[f"{j}.inertia"].value for j in joints}
    return arm_diagnosis_of(prepared, rungs, ends, motors, among=among)


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


def _climb(
    joints: dict[str, Joint],
    first: ArmFit,
    prepared: PreparedArm,
    report: Callable[[str], None],
) -> tuple[ArmRung, ...]:
    """Climb the ladder of each joint.

    joints: replaced in place by their final states
    returns: the ladder of the arm, its rungs in the order of the climbs
    """
    waiting: list[str] = list(joints)
    rungs: tuple[ArmRung, ...] = (ArmRung(None, first),)
    while waiting:
        j = max(waiting, key=lambda name: joints[name].gain)
        here = joints[j]
        if here.is_stale:
            records = {n: x.search.prepared for n, x in joints.items()}
            beside = with_other_motions(prepared, others_of(joints))
            fresh = with_known(records, {n: x.state.fit for n, x in joints.items()}, beside, j)
            joints[j] = begin_joint(j, here.search, fresh, here.state.fit.model, prepared)
            continue
        astray = _astray(here)
        if astray is not None:
            here = _begin_joint_again(joints, astray, prepared, j)
        beside = with_other_motions(prepared, others_of(joints))
        joints[j], rungs = _climb_joint(here, rungs, beside, report)
        waiting.remove(j)
        if len(joints[j].state.rungs) > 1:
            for other in waiting:
                joints[other] = replace(joints[other], is_stale=True)
    return rungs


def _climb_joint(
    joint: Joint,
    rungs: tuple[ArmRung, ...],
    prepared: PreparedArm,
    report: Callable[[str], None],
) -> tuple[Joint, tuple[ArmRung, ...]]:
    """Climb the ladder of a joint, and test its effects on the whole arm.

    Where an effect is refused on the arm, the ladder continues without it, and later effects may be
    added again. It ends where no further effect is refused.
    returns: the joint at the end of its ladder, and the ladder of the arm with its rungs
    """
    while True:
        state, _ = climb(joint.search, joint.state, _as_they_are)
        report(f"{joint.name}: all joints together")
        gone = {one.candidate.key for one in state.set_aside}
        joint, rungs = hold_against_arm(replace(joint, state=state), rungs, prepared)
        if gone.issuperset(one.candidate.key for one in joint.state.set_aside):
            return joint, rungs


def _astray(joint: Joint) -> Model | None:
    """The model with the joint's first effect, if it removes most squares: the links were misled.

    returns: None where it does not, or where no base parameters are estimated
    """
    if len(joint.state.rungs) > 1 or not joint.state.fit.model.links:
        return None
    moved = add(joint.search, joint.state)
    if moved is None or fit_squares(moved.fit) > (1.0 - joint.search.plan.astray) * fit_squares(
        joint.state.fit
    ):
        return None
    return moved.fit.model


def _begin_joint_again(
    joints: dict[str, Joint], model: Model, prepared: PreparedArm, joint: str
) -> Joint:
    """A joint whose ladder starts anew, with the information on the links beside its first effect.

    joints: those that wait get their models of these fits, in place;  model: from `_astray`
    Before, the base parameters had to imitate that effect. Shifts of records that were held at zero
    then are estimated again.
    """
    models = {n: x.state.fit.model.with_record_shift({}) for n, x in joints.items()}
    beside = with_other_motions(prepared, others_of(joints))
    arm = estimate_arm({**models, joint: model.with_record_shift({})}, beside)
    for n, other in joints.items():
        if n != joint and len(other.state.rungs) == 1:
            rungs = [replace(other.state.rungs[0], fit=arm.fits[n])]
            joints[n] = replace(other, state=other.state.with_rungs(rungs))
    here = joints[joint]
    records = {**arm.prepared, joint: here.search.prepared}
    fresh = with_known(records, {**arm.fits, joint: here.state.fit}, beside, joint)
    late = arm.fits[joint].model.record_shift
    model = here.state.fit.model.with_record_shift(late)
    return begin_joint(joint, here.search, fresh, model, prepared)


def _as_they_are(_: LadderSearch, state: LadderState) -> tuple[Rung, ...]:
    """The rungs of a joint's ladder; for an arm the errors of readings are not simulated."""
    return state.rungs


def _conclude(
    prepared: PreparedArm, joints: dict[str, Joint], rungs: tuple[ArmRung, ...]
) -> dict[str, LadderEnd]:
    """The end of each joint's ladder, with the final links."""
    last = rungs[-1].fit
    ends = {j: _conclude_joint(joints[j], last.fits[j], prepared) for j in prepared.joints}
    for rung in rungs:
        if rung.added is None or rung.follows is None:
            continue
        at = rung.added.at
        relevant = joints[at].search.criteria.relevant
        coupling = undetermined_coupling(rung, last, prepared, relevant=relevant)
        if coupling is not None:
            more = (*ends[at].undetermined, coupling)
            ends[at] = replace(ends[at], undetermined=more)
    return ends


def _conclude_joint(joint: Joint, fit: Fit, prepared: PreparedArm) -> LadderEnd:
    """The end of one joint's ladder, its last rung with the final links."""
    rungs = (*joint.state.rungs[:-1], replace(joint.state.rungs[-1], fit=fit))
    return conclude(joint.search, joint.state, rungs, beside=prepared.beside(joint.name))
