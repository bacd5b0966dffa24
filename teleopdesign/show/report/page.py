"""The data of a report's page: all its content, as plain numbers and texts."""

from __future__ import annotations

import dataclasses
import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from typing import Any

from ...base.files import make_plain
from ...base.finding import Finding, Graph
from ...base.units import unit_of
from ...diagnose import Diagnosis, SimulationComparison
from ...diagnose.answer import answer
from ...measurement.channel import BODY_QUANTITIES
from ...measurement.experiment import Experiment
from ...measurement.reading import ReadingStep, log_name
from ..diagnose.text import sentence
from ..figures.graph import thin_series
from .candidate_table import (
    CandidateRow,
    CandidateStep,
    LadderLine,
    candidate_rows,
    candidate_steps,
    describe_judgement,
    ladder_lines,
    sentence_of,
    verdict,
)
from .cannot_tell import cannot_tell
from .motion import ImpedanceView, MotionOverlay, impedance_views, simulated_motions
from .parameter_table import (
    AddedEffect,
    CorrelationRow,
    ParameterRow,
    added_effects,
    correlation_rows,
    parameter_rows,
)
from .residuals import BodyView, body_views

#: most points of one series of a finding's graph, drawn and in the page's data
POINTS = 400
#: significant digits of arrays in the page's data: finer than any figure shows
DIGITS = 5


#: findings on what is left; of an arm, joint -> such findings
Unexplained = Sequence[Finding] | Mapping[str, Sequence[Finding]]


@dataclass(frozen=True)
class JointPart:
    """A joint of an arm: its errors with all joints estimated together, and its own page.

    left: check error in noise floors of the joint;  sentence: the verdict on the joint in words
    """

    name: str
    before: float
    after: float
    floor: float
    left: float
    sentence: str
    page: Page


@dataclass(frozen=True)
class LinkRow:
    """A base parameter of an arm's links, SI; stderr: None if it is not determined."""

    name: str
    unit: str
    value: float
    stderr: float | None


@dataclass(frozen=True)
class Page:
    """The content of a report, from top to bottom. Errors are relative, everything else is SI.

    Of an arm, what is said of a body stands in the pages of its joints.
    """

    title: str
    folder: str
    verdict: str
    named: tuple[str, ...]
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
    ladder: tuple[LadderLine, ...]
    joints: tuple[JointPart, ...]
    links: tuple[LinkRow, ...]
    added: tuple[AddedEffect, ...]
    views: tuple[BodyView, ...]
    parameters: tuple[ParameterRow, ...]
    correlations: tuple[CorrelationRow, ...]
    simulated: tuple[MotionOverlay, ...]
    impedances: tuple[ImpedanceView, ...]
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
    unexplained: Unexplained = (),
    next_steps: Sequence[Finding] = (),
    simulation: SimulationComparison | None = None,
) -> Page:
    """The page of a diagnosis.

    soundness: findings on the recording;  unexplained: findings on the last residual
    next_steps: findings on what to measure next; a section without findings is left out
    simulation: of the final model, driven by the recorded forces
    """
    experiment, ladder = diagnosis.experiment, ladder_lines(diagnosis)
    left = unexplained if isinstance(unexplained, Mapping) else {"": unexplained}
    body = None if diagnosis.joints else diagnosis  # of one arm each joint is a body
    rows = () if body is None else parameter_rows(body)
    return Page(
        title=experiment.title,
        folder=experiment.folder.name,
        verdict=verdict(diagnosis),
        named=tuple(sorted({r.added.effect.name for r in diagnosis.rungs if r.added is not None})),
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
        joints=tuple(_joint(diagnosis, j, left.get(j, ()), simulation) for j in diagnosis.joints),
        links=tuple(
            LinkRow(name, one.unit, one.value, make_plain(one.stderr))
            for name, one in diagnosis.links.items()
        ),
        added=() if body is None else added_effects(body, rows),
        views=()
        if body is None or body.kind
        else body_views(body, tuple(line.name for line in ladder)),
        parameters=rows,
        correlations=() if body is None else correlation_rows(body.last_fit),
        simulated=() if body is None else simulated_motions(simulation, body.model.bodies),
        impedances=() if body is None or body.kind else impedance_views(body),
        candidate_steps=() if body is None else candidate_steps(body),
        candidates=() if body is None else candidate_rows(body),
        cannot_tell=() if body is None else cannot_tell(body),
        soundness=limit_size(soundness),
        unexplained=limit_size(left.get("", ())),
        next_steps=limit_size(next_steps),
        records=record_rows(experiment),
        reading=experiment.reading,
        channels=channel_rows(experiment),
        bandwidth=diagnosis.bandwidth,
        bandwidth_stated=experiment.bandwidth == diagnosis.bandwidth,
        version=version(),
    )


def _joint(
    diagnosis: Diagnosis,
    joint: str,
    left: Sequence[Finding],
    simulation: SimulationComparison | None,
) -> JointPart:
    one = diagnosis.joints[joint]
    return JointPart(
        name=joint,
        before=diagnosis.before.joints[joint].check_error,
        after=diagnosis.after.joints[joint].check_error,
        floor=one.floor.value,
        left=one.left,
        sentence=sentence(one).removeprefix("verdict: "),
        page=page_of(one, unexplained=left, simulation=simulation),
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


@dataclass(frozen=True)
class RecordRow:
    """A record and its content; duration: s, rate: Hz, NaN on friction curves; digest: SHA-256."""

    file: str
    use: str
    samples: int
    duration: float
    rate: float
    segments: int
    offset_names: tuple[str, ...]
    digest: str


@dataclass(frozen=True)
class ChannelRow:
    """A channel as described; resolution and noise in SI (`si_unit`), None if not stated."""

    name: str
    column: str
    unit: str
    resolution: float | None
    noise: float | None
    si_unit: str


def record_rows(experiment: Experiment) -> tuple[RecordRow, ...]:
    """Every record of the experiment."""
    return tuple(
        RecordRow(
            file=r.file,
            use=r.use,
            samples=len(r.time),
            duration=math.nan if r.is_curve else r.duration,
            rate=math.nan if r.is_curve else 1.0 / r.sample_time,
            segments=len(r.segments),
            offset_names=tuple(sorted(n.replace("_", " ") for n in r.offset_names)),
            digest=_digest(experiment, r.file),
        )
        for r in experiment.records
    )


def _digest(experiment: Experiment, file: str) -> str:
    """SHA-256 of a record's log; "" if the log no longer exists.

    For a folder (a bag): of its files one after the other, sorted by name.
    """
    path = experiment.folder / file
    if not path.exists():  # a part of a log
        path = experiment.folder / log_name(file)
    files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
    whole = hashlib.sha256()
    try:
        for one in files:
            with one.open("rb") as stream:
                hashlib.file_digest(stream, lambda: whole)
    except OSError:
        return ""
    return whole.hexdigest()


def channel_rows(experiment: Experiment) -> tuple[ChannelRow, ...]:
    """Every channel of the experiment."""
    return tuple(
        ChannelRow(
            name=name,
            column=c.column,
            unit=c.unit,
            resolution=c.resolution,
            noise=c.noise,
            si_unit=(
                ""
                if c.body is None
                else unit_of(BODY_QUANTITIES[c.quantity], experiment.axis(c.body))
            ),
        )
        for name, c in experiment.channels.items()
    )
