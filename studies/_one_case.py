"""Make one case of a campaign and diagnose it, each only where it is not there yet.

    python studies/_one_case.py FOLDER NAME [BASELINE ...]

FOLDER/plan.json says how the case is drawn. Runs in a process of its own, so that a case that
fails takes nothing else with it and every time is that of one diagnosis.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import sys
import traceback
from pathlib import Path
from typing import Any

import numpy as np
from _defects import log_as_loggers_do, rewrite_records

from teleopdesign.cli import main as teleopdesign

#: the simulator of cases: code that shares nothing with the package
MAKER = Path(__file__).resolve().parents[1] / "tests" / "hidden"


def write_json(path: Path, content: Any) -> None:
    """Write a file that is either whole or not there."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(f".part{os.getpid()}")
    part.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    part.replace(path)


def make(folder: Path, name: str, planned: dict[str, Any]) -> None:
    """Write cases/NAME and truth/NAME.json, or truth/NAME.none where no machine meets the level."""
    sys.path.insert(0, str(MAKER))
    from case_writer import write_files
    from cases import make_case

    generator = np.random.default_rng([planned["seed"], planned["index"]])
    effects = [planned["effect"]] if planned["effect"] else None
    truth = folder / "truth" / f"{name}.json"
    try:
        case = make_case(
            generator,
            planned["level"],
            effects,
            planned["kind"],
            planned["excitation"],
            planned["rate"],
        )
    except RuntimeError as error:  # the maker says so where its tries are used up
        truth.parent.mkdir(parents=True, exist_ok=True)
        truth.with_suffix(".none").write_text(f"{error}\n", encoding="utf-8")
        return
    case.name = name
    part = truth.with_suffix(f".part{os.getpid()}")
    write_files(case, folder / "cases" / name, part)
    if planned["logger"] is not None:
        shift = planned["logger"]
        rewrite_records(folder / "cases" / name, lambda t: log_as_loggers_do(t, generator, shift))
    part.replace(truth)  # last: a case is there when its truth is


def processor_seconds() -> float:
    """Seconds of the processor that this process has used, with copies of it that have ended."""
    return sum(os.times()[:4])


def diagnose(folder: Path, name: str) -> None:
    """Write answers/NAME.json as `teleopdesign diagnose` gives it, with the time it took."""
    answers = folder / "answers"
    answers.mkdir(parents=True, exist_ok=True)
    part = answers / f"{name}.part{os.getpid()}.json"
    began, messages = processor_seconds(), io.StringIO()
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(messages):
        status = teleopdesign(["diagnose", str(folder / "cases" / name), "--json", str(part)])
    if status != 0:
        raise RuntimeError(
            f"`teleopdesign diagnose` ended with {status}: {messages.getvalue().strip()}"
        )
    answer = json.loads(part.read_text(encoding="utf-8"))
    part.unlink()
    _write_timed(answers / f"{name}.json", answer, began)


def answer_with(baseline: str, folder: Path, name: str) -> None:
    """Write BASELINE/NAME.json in the same form."""
    from _baselines import BASELINES

    began = processor_seconds()
    answer = BASELINES[baseline](folder / "cases" / name)
    _write_timed(folder / baseline / f"{name}.json", answer, began)


def _write_timed(path: Path, answer: dict[str, Any], began: float) -> None:
    # of the processor, which other work on the machine does not change
    write_json(path, answer | {"processor_seconds": processor_seconds() - began})


def main(folder: Path, name: str, baselines: list[str]) -> int:
    """Do what is missing of a case; returns 1 if a method failed, whose traceback is kept."""
    planned = json.loads((folder / "plan.json").read_text(encoding="utf-8"))["cases"][name]
    truth = folder / "truth" / f"{name}.json"
    if not truth.exists():
        make(folder, name, planned)
    failed = []
    for method in ("answers", *baselines):
        if not truth.exists() or (folder / method / f"{name}.json").exists():
            continue
        try:
            diagnose(folder, name) if method == "answers" else answer_with(method, folder, name)
        except Exception as error:  # whatever it is, it is that method's failure on this case
            kept = folder / "failed" / f"{name}.{method}.txt"
            kept.parent.mkdir(exist_ok=True)
            kept.write_text(traceback.format_exc(), encoding="utf-8")
            failed.append(f"{method}: {error}")
    if failed:
        print("; ".join(failed), file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2], sys.argv[3:]))
