"""The one list of checks that need no fit, and who asks it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from ..base.finding import Finding
from ..base.folders import Shelf
from ..measurement.prepare import Prepared
from ..model import Model
from ._recording import CheckedRecording, RecordingCheck

CHECKS: Mapping[str, RecordingCheck] = Shelf(
    __package__,
    Path(__file__).parent,
    lambda module: module.CHECK,
    "check",
    defined_in=__name__,
)


def in_turn(checks: Mapping[str, RecordingCheck], kind: str = "") -> list[RecordingCheck]:
    """Checks of this kind of experiment, in the order in which they are asked."""
    return sorted((c for c in checks.values() if c.kind == kind), key=lambda check: check.order)


def findings_of(recording: CheckedRecording) -> list[Finding]:
    """What all checks of this folder find; also that the channels are in order, where they are."""
    checks = in_turn(CHECKS, recording.experiment.kind)
    by_check = [(check, list(check.find(recording))) for check in checks]
    findings = [f for _, some in by_check for f in some]
    of_channels = [(check, some) for check, some in by_check if check.in_order]
    if of_channels and not any(f.concern == "warning" for _, some in of_channels for f in some):
        names = ", ".join(dict.fromkeys(s.name for s in recording.signals))
        *first, last = (check.in_order for check, _ in of_channels)
        words = f"{', '.join(first)}; {last}"
        samples = float(sum(len(s.values) for s in recording.signals))
        findings.append(Finding("channels", "fine", f"{names}: {words}.", {"samples": samples}))
    return findings


def stopping_findings(recording: CheckedRecording) -> Iterator[Finding]:
    """Findings that end a diagnosis: these records tell no effect, whatever is fitted."""
    for check in in_turn(CHECKS, recording.experiment.kind):
        if check.may_stop:
            yield from (f for f in check.find(recording) if f.stops)


def why_silent(prepared: Prepared, model: Model) -> str:
    """Why these records tell no effect, as the end of a verdict; "" where they may tell one.

    model: of the user, with the inertias that are known
    """
    findings = stopping_findings(CheckedRecording(prepared.experiment, model, prepared))
    sentence = next((f.sentence for f in findings), "")
    return f"{sentence[:1].upper()}{sentence[1:]}"
