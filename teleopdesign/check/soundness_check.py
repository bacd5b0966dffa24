"""Before a fit: is the recording sound, and what can it show?"""

from __future__ import annotations

from typing import Literal

import numpy as np

from ..base.errors import ExperimentError
from ..base.finding import Finding, Findings
from ..diagnose.constant_force import lacks_scale
from ..diagnose.silent_records import why_silent
from ..diagnose.unknown_drive import describe_work
from ..measurement.excerpt import excerpt
from ..measurement.experiment import Experiment
from ..measurement.first_guess import VARIES
from ..measurement.prepare import prepare
from ..measurement.soundness import check_signals
from ..model import Model
from .bandwidth_check import check_bandwidth
from .excitation import check_excitation
from .feedback_check import check_feedback
from .mixed_columns import check_clock_unit, check_mixed_columns
from .plausibility import check_plausibility

#: topics whose warnings make it pointless to ask what a record can show
_CONTRADICTIONS = ("signs", "units", "swapped columns")


def check_experiment(
    experiment: Experiment, model: Model | None = None, *, seed: int = 0
) -> Findings:
    """Findings on a recording in plain sentences: soundness, signs and units, what it can show.

    model: the user's present model; None: the experiment's
    seed: of the random numbers for the noise floor
    Signs, units, shifts and effects of a long experiment are checked on windows (`excerpt`).
    A reason why nothing can be checked (no inertia, a bandwidth too high) is a finding, no error.
    """
    return Findings(_findings(experiment, model, seed))


def _findings(experiment: Experiment, model: Model | None, seed: int) -> tuple[Finding, ...]:
    findings = [
        *_guesses(experiment),
        *check_clock_unit(experiment),
        *check_signals(experiment),
        *check_feedback(experiment),
    ]
    if model is None:
        try:
            model = Model.from_experiment(experiment)
        except ExperimentError as problem:
            return (*findings, _report_skipped(str(problem), "warning"))
    resting = _list_resting_bodies(experiment)
    if resting:
        names = " and ".join(resting)
        sentence = f"not checked which effects the record can show: {names} never moves."
        return (*findings, Finding("what the record can show", "note", sentence))
    part = excerpt(experiment)
    if part is not experiment:
        findings.append(_windows(experiment, part))
    try:
        prepared = prepare(part)
    except ExperimentError as problem:
        return (*findings, _report_skipped(str(problem), "warning"))
    if lacks_scale(prepared.stretches, model):
        return (*findings, _constant_force())
    work = describe_work(experiment)
    if work:
        findings.append(Finding("work", "warning", work))
    elif silent := why_silent(prepared, model):
        return (*findings, _report_skipped(silent.rstrip("."), "warning"))
    mixed = list(check_mixed_columns(part))
    if mixed:
        return (*findings, *mixed, _report_skipped("first make the columns agree", "note"))
    findings += (of_band := list(check_bandwidth(model, prepared)))
    if any(f.concern == "warning" for f in of_band):
        return (*findings, _report_skipped("first choose a bandwidth", "note"))
    agreement = check_plausibility(model, prepared)
    findings += agreement
    against = [f for f in agreement if f.concern == "warning" and f.topic in _CONTRADICTIONS]
    if against or work:
        sentence = (
            "not checked which effects the record can show: first make signs, units and columns "
            "agree."
        )
        return (*findings, Finding("what the record can show", "note", sentence))
    findings += check_excitation(model, prepared, np.random.default_rng(seed))
    return tuple(findings)


def _report_skipped(why: str, concern: Literal["note", "warning"]) -> Finding:
    return Finding(
        "what the record can show",
        concern,
        f"not checked which effects the record can show: {why}.",
    )


def _constant_force() -> Finding:
    return Finding(
        "constant force",
        "warning",
        f"the force varies by less than {100 * VARIES:g} %: a constant friction explains "
        "it along any motion, so that no inertia, no damping and no effect can be told. Record a "
        "motion under a force that varies, or one that also coasts; or state the inertia, with "
        "fixed = true.",
    )


def _guesses(experiment: Experiment) -> list[Finding]:
    """Findings on values that `teleopdesign new` guessed and the user has not confirmed."""
    return [
        Finding(
            "guesses",
            "note",
            f"{key} was guessed: {why}; correct it in experiment.toml, or take its line out of "
            "[guessed].",
        )
        for key, why in experiment.guesses.items()
    ]


def _list_resting_bodies(experiment: Experiment) -> list[str]:
    """Bodies whose position is constant throughout every fit record."""
    return [
        body
        for body in experiment.bodies
        if all(np.ptp(r.signals[f"{body}.position"]) == 0 for r in experiment.fit_records)
    ]


def _windows(whole: Experiment, part: Experiment) -> Finding:
    lengths = [(s.stop - s.start) * r.sample_time for r in part.records for s in r.segments]
    duration = sum(r.duration for r in whole.records)
    return Finding(
        "excerpt",
        "note",
        f"signs, units and what the record can show are judged on {len(lengths)} windows, "
        f"{sum(lengths):.3g} s of {duration:.4g} s.",
        {"windows": float(len(lengths)), "seconds": sum(lengths), "of": duration},
    )
