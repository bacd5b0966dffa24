"""Corrections of a log as findings: lost rows, uneven stamps, wraps, pauses."""

from __future__ import annotations

from typing import Literal

from ...base.finding import Finding
from ..record import Record

#: a warning is given if the reading of a log may add more than this part of the force to the force
#: error: a tenth of the error of a plain friction model on the recordings of `fetch`
CARE = 0.02


def check_reading(record: Record) -> list[Finding]:
    """One finding for each reading step of a record."""
    findings = []
    for step in record.reading:
        concern: Literal["note", "warning"] = "warning" if step.size > CARE else "note"
        effect = "" if step.effect == "none" else f" ({step.effect})"
        sentence = f"{step.observed}: {step.rule}{effect}."
        findings.append(Finding(step.topic, concern, sentence, dict(step.numbers), record.file))
    return findings
