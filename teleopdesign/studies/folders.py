"""Diagnosis of many recordings: an answer file for each, kept from run to run.

Each folder is a point of a study. A digest of its content, the search and the versions is kept for
its answer. So an unchanged folder is not diagnosed again, but a folder that has changed or failed
is.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ExperimentError
from ..base.files import follow_links, read_whole, write_json
from ..base.frozen import ByValue
from ..diagnose.answer import content_of_answer
from ..effects import Effect
from ..measurement.saving import content_digest
from .chosen_measures import measures_of
from .evaluate import StudyTask, Unit
from .fingerprint import fingerprint, versions
from .outcomes import Clock, PointOutcome, Progress
from .points import points_of
from .processes import run_on_this_machine

if TYPE_CHECKING:
    from ..diagnose import Diagnosis

#: file of the output folder: name of each answer, and a digest of what it was made of
FINISHED = "finished.json"


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
    known: Mapping[str, Effect],
    among: tuple[str, ...] | None = None,
    quick: bool = False,
    workers: int | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> tuple[DiagnosedFolder, ...]:
    """Diagnose the experiment of every folder; each answer is written to the output folder.

    known: effects by name;  among: names of the candidates, None: all;  quick: only a first look
    workers: processes; None: as many as the machine has cores, if that is faster
    progress: called with the progress of the work
    Finished folders are kept in the output folder: the same call continues from there.
    raises ExperimentError: the same folder twice, an output that cannot be written
    """
    answers = answer_files(folders, output)
    made_with = fingerprint(known, among, quick, versions())
    digests = {answers[f].name: fingerprint(made_with, content_digest(f)) for f in folders}
    finished = _read_digests(output / FINISHED)
    todo: list[Unit] = []
    for k, answer in enumerate(answers.values()):
        if not answer.exists() or finished.get(answer.name) != digests[answer.name]:
            todo.append((k,))
    clock = Clock(len(folders), len(folders) - len(todo), progress, "folders")
    failures: dict[int, str] = {}

    def sink(outcome: PointOutcome) -> None:
        name = answers[folders[outcome.point]].name
        if outcome.reason:
            failures[outcome.point] = outcome.reason
        else:
            finished[name] = digests[name]
            write_json(output / FINISHED, finished)
        clock.count(outcome)

    files = {str(f): answer for f, answer in answers.items()}
    task = StudyTask(
        model=partial(_write_answer, files=files, known=known, among=among, quick=quick),
        case={},
        points=points_of({"experiment": [str(f) for f in folders]}),
        measures=measures_of("verdict"),
    )
    if todo:
        run_on_this_machine(task, todo, sink, workers)
    return tuple(
        DiagnosedFolder(f, answers[f], failure=failures[k])
        if k in failures
        else _diagnosed_folder(f, answers[f])
        for k, f in enumerate(folders)
    )


def _read_digests(path: Path) -> dict[str, str]:
    """Name of an answer -> digest of what it was made of; none where there is no such file."""
    try:
        content = json.loads(read_whole(path))
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}


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


def _write_answer(
    experiment: str,
    files: Mapping[str, Path],
    known: Mapping[str, Effect],
    among: tuple[str, ...] | None,
    quick: bool,
) -> Diagnosis:
    """Diagnose a folder and write the answer; returns the diagnosis."""
    from ..diagnose import find_missing, write_answer
    from ..diagnose.search_plan import PLAN, QUICK
    from ..measurement import load_experiment
    from ..model import Model

    recorded = load_experiment(experiment)
    model = Model.from_experiment(recorded, known)
    diagnosis = find_missing(recorded, model, plan=QUICK if quick else PLAN, among=among)
    write_answer(diagnosis, files[experiment])
    return diagnosis


def _diagnosed_folder(folder: Path, answer: Path) -> DiagnosedFolder:
    """What the answer of a folder says."""
    content = content_of_answer(answer)
    errors = [row["check_error"] for row in content["ladder"]]
    before, after = (math.nan if e is None else float(e) for e in (errors[0], errors[-1]))
    missing = ", ".join(f"{one['effect']} at {one['at']}" for one in content["missing"])
    return DiagnosedFolder(folder, answer, content["verdict"], missing, before, after)
