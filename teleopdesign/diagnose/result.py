"""The result of a search: what its end states, without the state of the search."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from ..check.log_reading import short_segment_lines
from ..effects import CONTACT_ROLES, EFFECTS
from ..measurement.bandwidth import slower_sensors
from ..measurement.experiment import Experiment
from ..measurement.motion import Motion
from ..measurement.prepare import Prepared
from ..measurement.reading import reading_data
from ..model import Model
from .answer import with_recording
from .candidates import Candidate, is_static, list_look_alikes
from .conclusion import check_error_on_all
from .diagnosis import Diagnosis
from .error import error_near_reversals
from .evidence import records_differ, whole_score
from .fit import Fit
from .friction_cells import all_friction_cells
from .ladder_state import LadderEnd
from .learnable import learnable
from .no_named_law import free_form
from .open_questions import nearest, not_accepted, open_questions
from .parts import PreparedParts
from .probability import CandidateEvidence, evidence_of, leave_unnamed, probable, verdict
from .ranking import Ranked
from .record_offsets import offsets_of
from .record_shift import shifts_of
from .recording import DiagnosedRecording, fingerprint_of
from .repeats import repeatability
from .rung import Rung
from .statements import (
    Alternative,
    CandidateResult,
    LadderRow,
    StepEvidence,
    StepResult,
    Undetermined,
    estimate_of,
    finite,
)
from .undetermined import find_undetermined


def diagnosis_of(end: LadderEnd, *, beside: Sequence[Sequence[Motion]] = ()) -> Diagnosis:
    """What a search states at its end.

    Effects that stay but are not probable enough are called unexplained.
    beside: of each stretch, the motions of an arm's other joints, from which trees learn too
    """
    search, whole, last = end.search, end.search.whole, end.after
    prepared, model, experiment = search.prepared, last.model, search.experiment
    timed = not whole.is_curve
    search.progress("what could be learned")
    trees = learnable(model, whole, beside=beside, seed=search.seed) if timed else None
    curve, named = None, tuple[Candidate, ...]()
    if not end.silence:
        if end.more_is_missing:
            search.progress("a force without a named law")
            curve = free_form(last, end.floor, prepared)
        named = probable(end)
        end = replace(end, rungs=tuple(leave_unnamed(r, named) for r in end.rungs))
    stated = verdict(end.rungs, end.floor)
    if end.silence or (stated == "effects_missing" and not named):
        stated, named = "undecided", ()
    evidence = evidence_of(end)
    undetermined = find_undetermined(end.rungs, whole, estimated_on=prepared)
    diagnosis = Diagnosis(
        verdict=stated,
        rungs=tuple(_row(r, named) for r in end.rungs),
        floor=end.floor,
        candidates=_candidates(end, evidence),
        indistinguishable=_indistinguishable(end, undetermined),
        check="records" if experiment.check_records else "blocks of fit",
        held_out=not whole.of("check"),
        kind=experiment.kind,
        bandwidth=finite(whole.bandwidth),
        bandwidth_source=_bandwidth_source(experiment, whole.bandwidth),
        undetermined=undetermined,
        set_aside=end.set_aside,
        offsets=offsets_of(model, whole.stretches),
        record_shift={shift.at: shift for shift in shifts_of(model, whole.stretches)},
        learnable=trees,
        near_reversals=error_near_reversals(model, whole) if timed else None,
        repeats=repeatability(model, whole, beside=beside) if timed else None,
        on_all_records=check_error_on_all(last, prepared) if records_differ(last) else None,
        at_bound=last.at_bound,
        evidence=tuple(_evidence(one) for one in evidence if one.share > 0),
        fingerprint=fingerprint_of(experiment),
        reading=tuple(reading_data(experiment.reading)),
        estimated=end.estimated.model,
        open=open_questions(end, stated),
        not_accepted=not_accepted(end),
        nearest=nearest(end),
        no_named_law=curve,
        silence=end.silence,
        remarks=(*_without_law(model), *_of_segments(experiment)),
        left_out=(*search.plan.omissions(), *_needs_time(experiment)),
        considered=tuple(model.known),
        friction_cells={} if experiment.is_curve else all_friction_cells(model, whole),
    )
    return with_recording(diagnosis, recording_of(experiment, whole))


def recording_of(experiment: Experiment, prepared: Prepared) -> DiagnosedRecording:
    """The recording of a search, whose records are prepared already."""
    recording = DiagnosedRecording(stated=experiment)
    recording.__dict__["parts"] = PreparedParts(
        experiment, prepared.bandwidth, None, {"": prepared}
    )
    return recording


def _without_law(model: Model) -> tuple[str, ...]:
    """A sentence on each curve of the model that has no named law."""
    return tuple(
        f"no named law: {name} at {place} follows a force through its values and explains none"
        for name, place in model.effects
        if model.body(place).effect(name).free
    )


def _of_segments(experiment: Experiment) -> tuple[str, ...]:
    return () if experiment.is_curve else tuple(short_segment_lines(experiment))


def _needs_time(experiment: Experiment) -> tuple[str, ...]:
    """The effects of a body that a friction curve cannot test, in words."""
    if not experiment.is_curve:
        return ()
    axis = experiment.axis("device")
    names = [
        n
        for n, e in EFFECTS.items()
        if not (is_static(e) or e.free or e.role in CONTACT_ROLES or axis in e.counterparts)
    ]
    return (f"not tested, because a friction curve has no time: {', '.join(names)}",)


def _bandwidth_source(experiment: Experiment, used: float) -> str:
    """Where the frequencies that the errors include come from, in words."""
    if experiment.is_curve:
        return "none: the points of a friction curve have no time"
    stated = experiment.bandwidth
    if stated is None:
        return "chosen: up to there the positions show motion"
    if used < stated:
        name, rate = min(slower_sensors(experiment), key=lambda one: one[1])
        return f"stated: {stated:.3g} Hz, but {name} has {rate:.4g} readings in a second"
    return "stated"


def _row(rung: Rung, named: Collection[Candidate]) -> LadderRow:
    fit, instead = rung.fit, rung.instead_of
    return LadderRow(
        added=rung.added,
        fit_error=finite(fit.fit_error),
        check_error=finite(fit.check_error),
        fitted=fit.model,
        instead_of=None if instead is None else instead.effect.name,
        check_error_at_command=finite(fit.at_command.error),
        blind=finite(fit.at_command.blind),
        could_be=rung.could_be,
        alternatives=tuple(_alternative(rung, other) for other in rung.alternatives),
        named=rung.added in named,
    )


def _alternative(rung: Rung, other: Candidate) -> Alternative:
    """A look-alike of an accepted effect, with the numbers of the step that compared the two."""
    ranking, added = rung.ranking, rung.added
    ranked = {} if ranking is None else {r.candidate.key: r for r in ranking.ranked}
    if ranking is None or added is None or not {added.key, other.key} <= ranked.keys():
        return Alternative(other)
    first, second = ranked[added.key].fit, ranked[other.key].fit
    return Alternative(
        other,
        finite(second.check_error),
        finite(abs(whole_score(second, first))),
        finite(_likeness(ranking.base, first, second)),
    )


def _likeness(base: Fit, one: Fit, other: Fit) -> float:
    """Correlation of the changes that two candidates make to the residual of the check records."""
    a = base.check_residual - one.check_residual
    b = base.check_residual - other.check_residual
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    return float(a @ b) / size if size > 0 else float("nan")


def _indistinguishable(
    end: LadderEnd, undetermined: Sequence[Undetermined]
) -> tuple[tuple[Candidate, ...], ...]:
    """Each accepted effect with those as good, and those that the travel hardly separates from it.

    One of the latter is the commoner by its file (`Effect.commoner`), so that it is named
    nonetheless. The links of an arm include gravity, so there are none at its joints.
    """
    groups = {r.added: list(r.alternatives) for r in end.rungs if r.added}
    for one in () if end.search.whole.is_linked else undetermined:
        more = list_look_alikes(one.candidate, end.after.model)
        groups[one.candidate] += [c for c in more if c not in groups[one.candidate]]
    return tuple((one, *others) for one, others in groups.items() if others)


def _candidates(end: LadderEnd, evidence: list[CandidateEvidence]) -> tuple[CandidateResult, ...]:
    """Every candidate, most probable first, with its fit at one step of the ladder.

    The step is the one that accepted the candidate, else the one where it was most probable.
    """
    best: dict[tuple[str, str], CandidateEvidence] = {}
    for one in evidence:
        before = best.setdefault(one.ranked.candidate.key, one)
        if (one.accepted, one.probability()) > (before.accepted, before.probability()):
            best[one.ranked.candidate.key] = one
    steps = _steps(end)
    rows = [_result(end, one, steps[key]) for key, one in best.items()]
    # rounded: candidates of equal probability keep the order of the rankings on every machine
    return tuple(sorted(rows, key=lambda row: -round(row.probability, 6)))


def _result(
    end: LadderEnd, one: CandidateEvidence, steps: tuple[StepResult | None, ...]
) -> CandidateResult:
    candidate, fit = one.ranked.candidate, one.ranked.fit
    effect, at = candidate.key
    if one.accepted:  # the fit of the ladder: later exchanges and removals changed it
        fit = next(r.fit for r in end.rungs if r.added == candidate)
    model, last = fit.model, end.after.model
    if one.accepted and last.body(at).has(effect):
        model = last  # each later rung estimates all parameters again
    believed = one.belief if one.accepted else None
    return CandidateResult(
        candidate=candidate,
        probability=one.probability(),
        check_error=finite(fit.check_error),
        parameters={
            n: estimate_of(model, f"{at}.{effect}.{n}") for n in candidate.effect.parameters
        },
        check_error_at_command=finite(fit.at_command.error),
        blind=finite(fit.at_command.blind),
        refused=one.barred or None,
        rho=None if believed is None else finite(believed.rho),
        lambda_=None if believed is None else finite(believed.lambda_),
        free_function="" if believed is None else believed.best,
        steps=steps,
    )


def _evidence(one: CandidateEvidence) -> StepEvidence:
    return StepEvidence(
        candidate=one.ranked.candidate,
        accepted=one.accepted,
        as_good=one.as_good,
        score=finite(one.ranked.score),
        share=float(one.share),
        explained=float(one.explained),
    )


def _steps(end: LadderEnd) -> dict[tuple[str, str], tuple[StepResult | None, ...]]:
    """Candidate (name, place) -> its result on each step; None: it was not fitted there."""
    rankings = [*((r, r.ranking) for r in end.rungs[1:]), (None, end.last)]
    results: dict[tuple[str, str], list[StepResult | None]] = {}
    for i, (rung, ranking) in enumerate(rankings):
        if ranking is None:
            continue
        for ranked in ranking.ranked:
            outcome = _outcome(rung, ranking.base, ranked)
            # what was added may have been fitted again since: one error for one model
            fit = rung.fit if rung is not None and outcome == "added" else ranked.fit
            known = ranked.is_identifiable or ranked.candidate.key in ranked.fit.model.absent
            result = StepResult(finite(fit.check_error), finite(ranked.score), outcome, known)
            results.setdefault(ranked.candidate.key, [None] * len(rankings))[i] = result
    return {key: tuple(steps) for key, steps in results.items()}


def _outcome(rung: Rung | None, base: Fit, ranked: Ranked) -> str:
    """Outcome of a candidate at a step, if the error alone does not show it; else ""."""
    key = ranked.candidate.key
    if rung is not None and rung.added is not None and rung.added.key == key:
        return "added"
    if rung is not None and key in {c.key for c in rung.alternatives}:
        return "as good"
    if key in ranked.fit.model.absent:
        return "no gain"
    if ranked.refused:
        return ranked.refused
    if ranked.implausible:
        return "implausible"
    if not ranked.is_identifiable:
        return "open"
    return "displaces" if set(ranked.fit.at_bound) - set(base.at_bound) else ""
