"""Answers of `teleopdesign diagnose`, each by a process of its own, kept until the package changes.

A case that is done is not computed again: its answer lies in a folder that is named by the content
of the package, so that a run which was broken off goes on, and one of another state begins anew.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
#: measurements that are not part of the project: beside it, or where a variable says
SHARED = Path(os.environ.get("TELEOPDESIGN_SHARED", ROOT.parent / "shared"))
#: simulated cases whose answers are asked each time: of each kind of what is missing at least one
#: (outside the catalogue, nothing, actuation, inertia, force, friction, two at once)
CASES = ("001", "004", "005", "006", "007", "010", "012", "016", "022", "024", "025", "027")
#: real recordings whose diagnosis takes seconds
RECORDINGS = ("cicese_gravity", "cicese_presliding", "ur10e_joint1")
#: effects that these diagnoses choose from; the whole catalogue takes five times as long
CANDIDATES = (
    "viscous", "coulomb", "coulomb_asymmetry", "stribeck", "presliding", "bias", "spring",
    "added_inertia", "actuation_delay", "actuator_lag", "cogging", "friction_drift", "gravity",
    "shear_thinning",
)  # fmt: skip
#: cases drawn by the simulator of the tests, every second pair with a bad logger
DRAWN, SEED = 60, 20521129
#: characters of the hash of the data
DIGEST = 12
#: candidates of an answer that are kept, best first
BEST = 5
#: processes at a time, each with one thread
JOBS = 2
#: parts of an answer that are judged from outside
KEPT = (
    "verdict", "missing", "ladder", "noise_floor", "indistinguishable", "cannot_tell", "set_aside",
    "repeats", "record_shift", "model_parameters", "blind", "learnable",
)  # fmt: skip
#: a place in the code, which a change of structure moves
PLACE = re.compile(r" in \S+\.py:\d+")


class NotThere(Exception):
    """What a part needs is not on this machine."""


def digest_of(folders: Sequence[Path]) -> str:
    """A hash of the files of some folders, or of single files."""
    state = hashlib.sha256()
    for folder in folders:
        files = [folder] if folder.is_file() else sorted(folder.rglob("*"))
        for path in files:
            if path.is_file() and "__pycache__" not in path.parts:
                state.update(path.name.encode() + path.read_bytes())
    return state.hexdigest()[:16]


def shared(part: str) -> Path:
    """A folder of the shared measurements; raises NotThere."""
    folder = SHARED / part
    if not folder.is_dir():
        raise NotThere(f"{folder}: not there; TELEOPDESIGN_SHARED names another place")
    return folder


def quick_answers(work: Path) -> dict[str, Any]:
    """Answers on 12 simulated cases, among few effects."""
    cases = shared("hidden/cases")
    return _diagnosed({c: cases / c for c in CASES}, work / "few", CANDIDATES)


def quick_recordings(work: Path) -> dict[str, Any]:
    """Answers on 3 real recordings, among few effects."""
    data = shared("data")
    return _diagnosed({name: data / name for name in RECORDINGS}, work / "few", CANDIDATES)


def whole_hidden(work: Path) -> dict[str, Any]:
    """Answers on all simulated cases, among the whole catalogue."""
    folders = [f.parent for f in shared("hidden/cases").glob("*/experiment.toml")]
    return _diagnosed({f.name: f for f in sorted(folders)}, work / "hidden")


def whole_data(work: Path) -> dict[str, Any]:
    """Answers on all real recordings, among the whole catalogue."""
    folders = [f.parent for f in shared("data").glob("*/experiment.toml")]
    return _diagnosed({f.name: f for f in sorted(folders)}, work / "data")


def whole_drawn(work: Path) -> dict[str, Any]:
    """Answers on drawn cases, half of them with bad loggers, among the whole catalogue."""
    sources = [ROOT / "tests" / "hidden", *(ROOT / "studies").glob("_*.py")]
    drawn = work.parent / f"drawn-{digest_of(sources)}"
    draw(drawn)
    folders = sorted(f.parent for f in (drawn / "cases").glob("*/experiment.toml"))
    return _diagnosed({f.name: f for f in folders}, work / "drawn")


def draw(folder: Path) -> None:
    """Draw the cases that are not there yet: cases/NAME and truth/NAME.json.

    Where no machine meets the level of a case, truth/NAME.none says so in its place.
    """
    sys.path[:0] = [str(ROOT / "studies"), str(ROOT / "tests")]
    from _campaign import plan
    from _one_case import make

    folder.mkdir(parents=True, exist_ok=True)
    for case in plan(DRAWN, seed=SEED, loggers=True):
        truth = folder / "truth" / case.name
        if not any(truth.with_suffix(end).exists() for end in (".json", ".none")):
            make(folder, case.name, dict(vars(case)))


def _diagnosed(folders: dict[str, Path], work: Path, effects: Sequence[str] = ()) -> dict[str, Any]:
    work.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(max_workers=JOBS) as pool:
        each = pool.map(lambda name: answer_on(name, folders[name], work, effects), folders)
        return {name: kept(answer) for name, answer in zip(folders, each, strict=True)}


def answer_on(name: str, folder: Path, work: Path, effects: Sequence[str] = ()) -> dict[str, Any]:
    """The answer on one case as it is saved, or {"status", "said"} where there is none."""
    path, part = work / f"{name}.json", work / f"{name}.part.json"
    if not path.exists():
        words = [sys.executable, "-m", "teleopdesign", "diagnose", str(folder), "--json", str(part)]
        done = subprocess.run(
            [*words, *(["--only", *effects] if effects else [])],
            env=_environment(), capture_output=True, text=True, check=False,
        )  # fmt: skip
        if done.returncode != 0:
            part.write_text(json.dumps(failure(done.returncode, done.stderr, folder)))
        part.replace(path)
        print(f"  {work.name} {name}: {done.returncode}", file=sys.stderr, flush=True)
    answer: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return answer


def failure(status: int, errors: str, folder: Path) -> dict[str, Any]:
    """What is kept of a diagnosis that ended with an error: its status and its last line."""
    line = (errors.strip().splitlines() or [""])[-1]
    return {"status": status, "said": PLACE.sub("", line.replace(str(folder), folder.name))}


def _environment() -> dict[str, str]:
    """One thread each: processes share the cores between them."""
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    alone = dict.fromkeys(names, "1")
    return {**os.environ, **alone, "MPLBACKEND": "Agg", "PYTHONPATH": path}


def kept(answer: dict[str, Any]) -> dict[str, Any]:
    """What is judged from outside of an answer, and the digest of the data that it is about."""
    if "status" in answer:
        return answer
    if "joints" in answer:  # an arm: an answer for each joint
        joints = {k: _kept(v) for k, v in answer["joints"].items()}
        for joint in joints.values():
            del joint["candidates"]  # those of all joints stand in one list
        return {**_kept(answer), "joints": joints}
    return _kept(answer)


def _kept(answer: dict[str, Any]) -> dict[str, Any]:
    judged = {name: answer[name] for name in KEPT if name in answer}
    for name in ("model_parameters", "record_shift"):
        judged[name] = _parameters(answer.get(name) or {})
    judged["cannot_tell"] = _without_sentences(answer.get("cannot_tell") or [])
    judged["set_aside"] = _without_sentences(answer.get("set_aside") or [])
    judged["candidates"] = [_candidate(c) for c in answer.get("candidates", [])[:BEST]]
    if "digest" in answer.get("experiment", {}):
        judged["digest"] = answer["experiment"]["digest"][:DIGEST]
    return judged


def _candidate(candidate: dict[str, Any]) -> dict[str, Any]:
    names = ("effect", "at", "probability", "check_error")
    return {
        **{name: candidate[name] for name in names if name in candidate},
        "is_refused": bool(candidate.get("refused")),
        "parameters": _parameters(candidate.get("parameters") or {}),
    }


def _without_sentences(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """What a row is about; how it is worded is no result."""
    return [{k: v for k, v in row.items() if not (isinstance(v, str) and " " in v)} for row in rows]


def _parameters(entries: dict[str, Any]) -> dict[str, Any]:
    """Values with their standard errors, without units."""
    return {
        name: {k: entry[k] for k in ("value", "stderr") if k in entry}
        if isinstance(entry, dict)
        else entry
        for name, entry in entries.items()
    }


PARTS: dict[str, Callable[[Path], dict[str, Any]]] = {
    "answers": quick_answers,
    "recordings": quick_recordings,
}
WHOLE: dict[str, Callable[[Path], dict[str, Any]]] = {
    "hidden": whole_hidden,
    "data": whole_data,
    "drawn": whole_drawn,
}
