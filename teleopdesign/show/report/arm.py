"""The report of an arm: one HTML page with the whole arm, and a part for each joint.

The diagnosis of a joint is that of a body, so its part is a page of a body. This module adds what
the joints share: the ladder of the arm, the joints in a table, the links, the recording.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...base.files import make_plain, write_text
from ...base.finding import Finding
from ...base.sentences import join_names
from ...base.sentences import percent_on_page as percent
from ...diagnose import ArmDiagnosis
from ...diagnose.arms.answer import arm_answer
from ...diagnose.diagnosis import Diagnosis
from ...diagnose.ladder_text import sentence
from ...measurement.reading import ReadingStep
from .candidate_table import LadderRow
from .figures import ladder_figure
from .page import DIGITS, Page, limit_size, page_of, version
from .parameter_table import AddedEffect
from .provenance import ChannelRow, RecordRow, channel_rows, record_rows
from .words import describe_judgement, sentence_of
from .write import Figures, figures_of, render_page


@dataclass(frozen=True)
class JointPart:
    """A joint: its errors with all joints estimated together, and its page.

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
    """A base parameter of the links, SI; stderr: None if the parameter is not determined."""

    name: str
    unit: str
    value: float
    stderr: float | None


@dataclass(frozen=True)
class ArmPage:
    """The content of an arm's report, from top to bottom. Errors are relative, the rest is SI."""

    title: str
    folder: str
    verdict: str
    named: tuple[str, ...]
    judged_on: str
    before: float
    after: float
    floor: float
    left: float
    learnable: str
    ladder: tuple[LadderRow, ...]
    added: tuple[AddedEffect, ...]
    joints: tuple[JointPart, ...]
    links: tuple[LinkRow, ...]
    soundness: tuple[Finding, ...]
    records: tuple[RecordRow, ...]
    reading: tuple[ReadingStep, ...]
    channels: tuple[ChannelRow, ...]
    bandwidth: float
    bandwidth_stated: bool
    version: str


@dataclass(frozen=True)
class ArmFigures:
    """Pictures of the whole arm, and those in the part of each joint."""

    whole: Figures
    joints: tuple[Figures, ...]


def arm_page_of(
    diagnosis: ArmDiagnosis,
    *,
    soundness: Sequence[Finding] = (),
    unexplained: Mapping[str, Sequence[Finding]] | None = None,
) -> ArmPage:
    """The page of an arm.

    soundness: findings on the recording;  unexplained: joint -> findings on its last residual
    """
    experiment, left = diagnosis.experiment, unexplained or {}
    return ArmPage(
        title=experiment.title,
        folder=experiment.folder.name,
        verdict=_verdict(diagnosis),
        named=tuple(sorted({c.effect.name for c in diagnosis.missing})),
        judged_on=describe_judgement(experiment),
        before=diagnosis.before.check_error,
        after=diagnosis.after.check_error,
        floor=diagnosis.floor,
        left=diagnosis.left,
        learnable=sentence_of(diagnosis.learnable),
        ladder=_ladder(diagnosis),
        added=(),  # each has its card in the part of its joint
        joints=tuple(
            _joint(diagnosis, j, one, left.get(j, ())) for j, one in diagnosis.joints.items()
        ),
        links=tuple(
            LinkRow(name, unit, value, make_plain(error))
            for name, (value, error, unit) in diagnosis.base_parameters.items()
        ),
        soundness=limit_size(soundness),
        records=record_rows(experiment),
        reading=experiment.reading,
        channels=channel_rows(experiment),
        bandwidth=diagnosis.prepared.bandwidth,
        bandwidth_stated=experiment.bandwidth == diagnosis.prepared.bandwidth,
        version=version(),
    )


def _joint(
    diagnosis: ArmDiagnosis, joint: str, one: Diagnosis, left: Sequence[Finding]
) -> JointPart:
    return JointPart(
        name=joint,
        before=diagnosis.before.check_errors[joint],
        after=diagnosis.after.check_errors[joint],
        floor=one.floor.value,
        left=one.left,
        sentence=sentence(one).removeprefix("verdict: "),
        page=page_of(one, unexplained=left),
    )


def _ladder(diagnosis: ArmDiagnosis) -> tuple[LadderRow, ...]:
    floor = diagnosis.floor
    return tuple(
        LadderRow(
            name=r.title or "your model, re-estimated",
            brief="your model" if r.added is None else r.added.effect.name,
            fit_error=r.fit.fit_error,
            check_error=r.fit.check_error,
            floors=r.fit.check_error / floor if floor else float("inf"),
        )
        for r in diagnosis.rungs
    )


def _verdict(diagnosis: ArmDiagnosis) -> str:
    """The verdict on the arm in one or two sentences."""
    before, after = percent(diagnosis.before.check_error), percent(diagnosis.after.check_error)
    where = describe_judgement(diagnosis.experiment)
    if diagnosis.verdict == "model_adequate":
        return (
            f"Your model of the arm is adequate: it leaves {after} of the forces unexplained on "
            f"{where}."
        )
    names = join_names([str(c) for c in diagnosis.missing])
    fell = f"the force error on {where} falls from {before} to {after}"
    if diagnosis.verdict == "effects_missing":
        return f"Your model of the arm lacks {names}. With all that was added {fell}."
    if len(diagnosis.rungs) > 1:
        added = join_names([r.title for r in diagnosis.rungs[1:]])
        return f"Undecided: with {added} {fell}, but these records do not show what is missing."
    return f"Undecided: something is missing, but no candidate effect explains the {after}."


def write_arm_report(
    diagnosis: ArmDiagnosis,
    path: str | Path,
    *,
    soundness: Sequence[Finding] = (),
    unexplained: Mapping[str, Sequence[Finding]] | None = None,
) -> None:
    """Write the page of an arm; the same diagnosis gives the same bytes.

    soundness, unexplained: as in `arm_page_of`
    """
    page = arm_page_of(diagnosis, soundness=soundness, unexplained=unexplained)
    data: dict[str, Any] = {
        "answer": make_plain(arm_answer(diagnosis)),
        "report": make_plain(page, digits=DIGITS),
    }
    whole = Figures(ladder_figure(page.ladder, page.floor), (), (), (), (), {})
    figures = ArmFigures(whole, tuple(figures_of(joint.page) for joint in page.joints))
    write_text(Path(path), render_page("arm.html.jinja", page, figures, data))
