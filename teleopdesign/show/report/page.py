"""The data of a report's page: all its content, as plain numbers and texts."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import metadata
from typing import Any

from ...base.files import make_plain
from ...base.finding import Finding, Graph
from ...diagnose import Diagnosis
from ...diagnose.answer import answer
from ...measurement.reading import ReadingStep
from ..figures.graph import thin_series
from .candidate_table import (
    CandidateRow,
    CandidateStep,
    LadderRow,
    candidate_rows,
    candidate_steps,
    ladder_rows,
)
from .cannot_tell import cannot_tell
from .parameter_table import AddedEffect, ParameterRow, added_effects, parameter_rows
from .provenance import ChannelRow, RecordRow, channel_rows, record_rows
from .residuals import BodyView, body_views
from .words import describe_judgement, sentence_of, verdict

#: most points of one series of a finding's graph, drawn and in the page's data
POINTS = 400
#: significant digits of arrays in the page's data: finer than any figure shows
DIGITS = 5


@dataclass(frozen=True)
class Page:
    """The content of a report, from top to bottom. Errors are relative, everything else is SI."""

    title: str
    folder: str
    verdict: str
    judged_on: str
    shown: str
    before: float
    after: float
    floor: float
    floor_source: str
    left: float
    learnable: str
    near_reversals: str
    repeats: str
    ladder: tuple[LadderRow, ...]
    added: tuple[AddedEffect, ...]
    views: tuple[BodyView, ...]
    parameters: tuple[ParameterRow, ...]
    candidate_steps: tuple[CandidateStep, ...]
    candidates: tuple[CandidateRow, ...]
    cannot_tell: tuple[Finding, ...]
    soundness: tuple[Finding, ...]
    unexplained: tuple[Finding, ...]
    next_steps: tuple[Finding, ...]
    records: tuple[RecordRow, ...]
    reading: tuple[ReadingStep, ...]
    channels: tuple[ChannelRow, ...]
    bandwidth: float
    bandwidth_stated: bool
    version: str


def page_of(
    diagnosis: Diagnosis,
    *,
    soundness: Sequence[Finding] = (),
    unexplained: Sequence[Finding] = (),
    next_steps: Sequence[Finding] = (),
) -> Page:
    """The page of a diagnosis.

    soundness: findings on the recording;  unexplained: findings on the last residual
    next_steps: findings on what to measure next; a section without findings is left out
    """
    experiment, rows = diagnosis.experiment, parameter_rows(diagnosis)
    ladder = ladder_rows(diagnosis)
    return Page(
        title=experiment.title,
        folder=experiment.folder.name,
        verdict=verdict(diagnosis),
        judged_on=describe_judgement(experiment),
        shown="check records" if experiment.check_records else "fit records",
        before=diagnosis.before.check_error,
        after=diagnosis.after.check_error,
        floor=diagnosis.floor.value,
        floor_source=diagnosis.floor.source,
        left=diagnosis.left,
        learnable=sentence_of(diagnosis.learnable),
        near_reversals=sentence_of(diagnosis.near_reversals),
        repeats=sentence_of(diagnosis.repeats),
        ladder=ladder,
        added=added_effects(diagnosis, rows),
        views=body_views(diagnosis, tuple(r.name for r in ladder)),
        parameters=rows,
        candidate_steps=candidate_steps(diagnosis),
        candidates=candidate_rows(diagnosis),
        cannot_tell=cannot_tell(diagnosis),
        soundness=limit_size(soundness),
        unexplained=limit_size(unexplained),
        next_steps=limit_size(next_steps),
        records=record_rows(experiment),
        reading=experiment.reading,
        channels=channel_rows(experiment),
        bandwidth=diagnosis.prepared.bandwidth,
        bandwidth_stated=experiment.bandwidth == diagnosis.prepared.bandwidth,
        version=version(),
    )


def version() -> str:
    """Version of the installed package."""
    try:
        return metadata.version("teleopdesign")
    except metadata.PackageNotFoundError:  # used from its folder, without an installation
        return "(not installed)"


def limit_size(findings: Sequence[Finding]) -> tuple[Finding, ...]:
    """The findings, with few enough points in their graphs that the page stays small."""
    return tuple(
        f if f.graph is None else dataclasses.replace(f, graph=_thin(f.graph)) for f in findings
    )


def _thin(graph: Graph) -> Graph:
    series = tuple(thin_series(s, POINTS) for s in graph.series)
    return dataclasses.replace(graph, series=series)


def page_data(page: Page, diagnosis: Diagnosis) -> dict[str, Any]:
    """Data embedded in the page: the answer, and every number that the page shows."""
    return {"answer": make_plain(answer(diagnosis)), "report": make_plain(page, digits=DIGITS)}
