"""All checks of a recording in turn: those that need no fit, then those that need one."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ..base.finding import Finding, Findings
from ..base.folders import Shelf
from ..check import RecordingCheck, findings_of, in_turn, look_at, not_checked
from ..measurement.experiment import Experiment
from ..model import Model

FITTED_CHECKS: Mapping[str, RecordingCheck] = Shelf(
    __package__,
    Path(__file__).parent,
    lambda module: module.CHECK,
    "fitted check",
    defined_in=__name__,
)


def check_experiment(
    experiment: Experiment, model: Model | None = None, *, seed: int = 0
) -> Findings:
    """Findings on a recording in plain sentences: soundness, signs and units, what it can show.

    model: the user's present model; None: the experiment's
    seed: of the random numbers for the noise floor
    Signs, units, shifts and effects of a long experiment are checked on windows (`excerpt`).
    A reason why nothing can be checked (no inertia, a bandwidth too high) is a finding, no error.

        >>> findings = td.check_experiment(td.load_experiment(td.example("rod")))
        >>> print(findings[0])
        fine    the time stamps are uniform, 1000 Hz.
    """
    recording = look_at(experiment, model, seed=seed)
    findings = findings_of(recording)
    if recording.refused is not None:
        return Findings((*findings, recording.refused))
    _, prepared = recording.compared
    if prepared.experiment is not experiment:
        findings.append(_windows(experiment, prepared.experiment))
    # where no model is tested none is fitted; which sign makes the work negative shows in a fit
    if any(f.stops and f.topic != "work" for f in findings):
        return Findings(findings)
    for check in in_turn(FITTED_CHECKS, experiment.kind):
        wrong = {f.topic for f in findings if f.concern == "warning"}
        if first := [what for topic, what in check.unless.items() if topic in wrong]:
            findings.append(not_checked(f"first {first[0]}", "note"))
            break
        findings += check.find(recording)
    return Findings(findings)


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
