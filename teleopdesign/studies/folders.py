"""Diagnosis of many recordings: an answer file for each, kept from run to run.

Each folder is a point of a study. The number of the point comes from the content of the folder, the
search and the versions. So an unchanged folder is not diagnosed again, but a folder that has
changed or failed is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ExperimentError, ModelError
from ..base.files import follow_links
from ..base.frozen import ByValue
from ..effects import EFFECTS, Effect
from ..measurement.saving import content_digest
from .chosen_measures import measures_of
from .evaluate import StudyTask, Unit
from .fingerprint import fingerprint, versions
from .journal import Journal
from .outcomes import Clock, PointOutcome, Progress
from .points import points_of
from .processes import run_on_this_machine

if TYPE_CHECKING:
    from ..diagnose import Diagnosis

#: file of finished folders within the output folder
JOURNAL = "journal.part"
#: digits of base 16 of a folder's number: 60 bits, which JSON holds as a whole number
_DIGITS = 15


@dataclass(frozen=True)
class FolderSearch:
    """Settings of the diagnosis of each folder.

    known: effects by name;  among: names of the candidates, None: all;  quick: only a first look
    """

    known: Mapping[str, Effect] = field(default_factory=lambda: EFFECTS)
    among: tuple[str, ...] | None = None
    quick: bool = False


@dataclass(frozen=True, eq=False)
class DiagnosedFolder(ByValue):
    """Result of the diagnosis of a folder.

    answer: file of the answer;  verdict, missing: of the diagnosis; "" if it failed
    before, after: check error of the stated model, and with the added effects; NaN if it failed
    failure: reason of the failure; "" if there is none
    """

    folder: Path
    answer: Path
    verdict: str = ""
    missing: str = ""
    before: float = float("nan")
    after: float = float("nan")
    failure: str = ""


def diagnose_folders(
    folders: Sequence[Path],
    output: Path,
    *,
    search: FolderSearch | None = None,
    workers: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> tuple[DiagnosedFolder, ...]:
    """Diagnose the experiment of every folder; each answer is written to the output folder.

    workers: processes; None: as many as the machine has cores, if that is faster
    progress: called with the progress of the work
    Finished folders are kept in the output folder: the same call continues from there.
    raises ExperimentError: the same folder twice, an output that cannot be written
    """
    chosen = FolderSearch() if search is None else search
    answers = answer_files(folders, output)
    made_with = fingerprint(chosen.known, chosen.among, chosen.quick, versions())
    numbers = [
        int(fingerprint(made_with, answers[f].name, content_digest(f))[:_DIGITS], 16)
        for f in folders
    ]
    journal = Journal(output / JOURNAL, "diagnoses of folders", len(folders))
    try:
        journal.forget_failures()
        done = [
            n in journal.outcomes and answers[f].exists()
            for f, n in zip(folders, numbers, strict=True)
        ]
        clock = Clock(len(folders), sum(done), progress, "folders")
        outcomes = {n: journal.outcomes[n] for n, there in zip(numbers, done, strict=True) if there}

        def sink(outcome: PointOutcome) -> None:
            kept = replace(outcome, point=numbers[outcome.point])
            journal.add(kept)
            outcomes[kept.point] = kept
            clock.count(outcome)

        task = StudyTask(
            model=partial(
                _write_answer, files={str(f): a for f, a in answers.items()}, search=chosen
            ),
            case={},
            points=points_of({"experiment": [str(f) for f in folders]}),
            measures=measures_of("verdict"),
        )
        todo: list[Unit] = [(k,) for k, there in enumerate(done) if not there]
        if todo:
            run_on_this_machine(task, todo, sink, workers)
    finally:
        journal.close()
    return tuple(
        _diagnosed_folder(folder, answers[folder], outcomes[number])
        for folder, number in zip(folders, numbers, strict=True)
    )


def answer_files(folders: Sequence[Path], output: Path) -> dict[Path, Path]:
    """Folder -> file of its answer, named after the folder, with parents where names are equal.

    raises ExperimentError: the same folder twice, or two folders with the same file
    """
    parts = {f: follow_links(f).parts[1:] for f in folders}
    by_place: dict[tuple[str, ...], Path] = {}
    for folder, place in parts.items():
        if len(parts) < len(folders) or place in by_place:
            raise ExperimentError(f"{folder}: found twice, expected every folder once")
        by_place[place] = folder
    names: dict[Path, Path] = {}
    for folder, place in parts.items():
        others = [p for p in by_place if p != place]
        size = 1
        while any(p[-size:] == place[-size:] for p in others) and size < len(place):
            size += 1
        names[folder] = output / f"{'-'.join(place[-size:]) or 'root'}.json"
    if len(set(names.values())) < len(names):  # "a-b" beside "a/b"
        raise ExperimentError(f"{output}: two folders would have one answer: rename one of them")
    return names


def _write_answer(experiment: str, files: Mapping[str, Path], search: FolderSearch) -> Diagnosis:
    """Diagnose a folder and write the answer; returns the diagnosis."""
    from ..diagnose import find_missing, write_answer
    from ..diagnose.search_plan import PLAN, QUICK
    from ..measurement import load_experiment
    from ..model import Model

    recorded = load_experiment(experiment)
    model = Model.from_experiment(recorded, search.known)
    plan = QUICK if search.quick else PLAN
    diagnosis = find_missing(recorded, model, plan=plan, among=search.among)
    write_answer(diagnosis, files[experiment])
    return diagnosis


def _diagnosed_folder(folder: Path, answer: Path, outcome: PointOutcome) -> DiagnosedFolder:
    if outcome.reason:
        return DiagnosedFolder(folder, answer, failure=outcome.reason)
    values = {form[0]: value for form, value in zip(outcome.form, outcome.values, strict=True)}
    try:
        return DiagnosedFolder(
            folder,
            answer,
            verdict=str(values["verdict"]),
            missing=str(values["missing"]),
            before=float(values["check_error_before"]),
            after=float(values["check_error_after"]),
        )
    except (KeyError, TypeError) as error:
        raise ModelError(f"{folder}: its kept outcome lacks {error}: remove {JOURNAL}") from error
