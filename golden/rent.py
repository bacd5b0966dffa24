"""Which rules of the diagnosis decide anything: rule, fires, decides, rightly, and its time.

Each experiment is diagnosed as it is, and once more without each rule that fired on it. A rule
decides where the answer without it names other effects, or says another verdict. It decides rightly
where the answer with it is nearer to the truth, as far as a truth is known.

    python golden/rent.py FOLDER [FOLDER ...] [--truth FOLDER] [--only EFFECT ...] [--jobs N]
                          [--json FILE]

FOLDER: an experiment, or a folder of experiments
--truth: a folder of NAME.json with "effects", a list of {"effect", "at"}
"""

from __future__ import annotations

import argparse
import importlib
import json
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = "teleopdesign"
#: what a rule's function returns where the rule is not there: nothing, or an argument as it came
Off = Callable[..., Any]


def _nothing(*_: Any) -> None:
    return None


def _argument(number: int) -> Off:
    return lambda *arguments: arguments[number]


def _no_tone(*_: Any) -> Any:
    return importlib.import_module(f"{PACKAGE}.diagnose.outside_tone").Tone()


#: rule -> its module and function in diagnose, and what stands for its absence
RULES: dict[str, tuple[str, Off]] = {
    "two at once": ("moves.add_two", _nothing),
    "swap": ("moves.swap", _nothing),
    "two in the place of one": ("swap_for_two.swap_for_two", _nothing),
    "superfluous is removed": ("moves.remove", _nothing),
    "transmission with friction": ("transmission.add_transmission", _nothing),
    "readings": ("climb.stands_in_for_readings", _nothing),
    "other values": ("climb.stands_in_for_values", _nothing),
    "doubtful at the end": ("conclusion.remove_doubtful_rung", _nothing),
    "shift must pay": ("stated_fit.with_paying_shift", _argument(0)),
    "late starts": ("stated_fit.with_late_starts", _argument(0)),
    "late hand": ("stated_fit.with_late_hand", _nothing),
    "tone": ("outside_tone.best_tone", _no_tone),
    "narrower band": ("narrower_band.narrower_to_search", _nothing),
    "needed strengths": ("linear_start.with_what_they_need", lambda *_: []),
    "smaller strengths": ("search.from_smaller_strengths", _argument(2)),
    "elements in order": ("search._sort_elements", _argument(0)),
    "draws": ("draws.search_among_draws", _argument(0)),
    "instead of": ("decision.find_superfluous_effect", _nothing),
    "open width": ("identifiability.explain_open_width", lambda *_: ""),
    "implausible": ("plausibility.implausible_effects", lambda *_: {}),
    "undetermined by its file": ("plausibility.undetermined_of", _nothing),
    "refused": ("decision.refusal", lambda *_: ""),
    "floor limited": ("evidence.limit_noise_floor", _argument(0)),
    "readings corrected": ("estimates.correct_fit", _argument(1)),
    "rarer": ("probability.list_rarer", lambda *_: []),
}


def _function(name: str) -> tuple[Any, str]:
    module, _, function = name.rpartition(".")
    return importlib.import_module(f"{PACKAGE}.diagnose.{module}"), function


def _replace(name: str, make: Callable[[Off], Off]) -> Off:
    """Put another function in the place of one, in every module that holds it; returns the old."""
    module, function = _function(name)
    old = getattr(module, function)
    new = make(old)
    for other in [m for n, m in sys.modules.items() if n.startswith(PACKAGE)]:
        for key, value in list(vars(other).items()):
            if value is old:
                setattr(other, key, new)
    return old


def _counts(rule: str, fired: Counter[str]) -> Callable[[Off], Off]:
    def make(old: Off) -> Off:
        def counted(*arguments: Any, **words: Any) -> Any:
            result, without = old(*arguments, **words), RULES[rule][1](*arguments)
            fired[rule] += result is not without and repr(result) != repr(without)
            return result

        return counted

    return make


def _diagnosed(folder: Path, only: Sequence[str]) -> dict[str, Any]:
    import teleopdesign as td

    began = time.process_time()
    try:
        diagnosis = td.find_missing(td.load_experiment(folder), among=only or None)
    except Exception as error:
        return {"named": [], "verdict": type(error).__name__, "error": 1.0, "seconds": 0.0}
    return {
        "named": sorted(f"{c.effect.name} at {c.at}" for c in diagnosis.missing),
        "verdict": diagnosis.verdict,
        "error": diagnosis.after.check_error,
        "seconds": time.process_time() - began,
    }


def of_case(folder: Path, only: Sequence[str]) -> dict[str, Any]:
    """The answer on one experiment, how often each rule fired, and the answers without each."""
    importlib.import_module(f"{PACKAGE}.diagnose.ladder")
    cores, _ = _function("cores.map_on_cores")
    cores.MOST = 1  # what a copy of this process counts is lost
    _diagnosed(folder, only)  # compiled code is there afterwards, so that times compare
    fired: Counter[str] = Counter()
    for rule in RULES:
        _replace(RULES[rule][0], _counts(rule, fired))
    answer = {"with": _diagnosed(folder, only), "fired": fired, "without": {}}
    for rule in [r for r in RULES if fired[r]]:
        absent = RULES[rule][1]
        old = _replace(RULES[rule][0], lambda _, absent=absent: lambda *a, **_: absent(*a))
        answer["without"][rule] = _diagnosed(folder, only)
        _replace(RULES[rule][0], lambda _, old=old: old)
    return answer


def table(cases: dict[str, dict[str, Any]], truths: dict[str, set[str]]) -> str:
    """One line a rule: cases where it fired and decided, rightly and wrongly, and its time."""
    head = ("fires in", "decides", "rightly", "wrongly", "% time")
    lines = [f"{'rule':<28}" + "".join(f"{word:>9}" for word in head) + "  where"]
    for rule in RULES:
        fires = [n for n, c in cases.items() if c["fired"].get(rule)]
        where, right, wrong, part = [], 0, 0, []
        for name in fires:
            before, after = cases[name]["with"], cases[name]["without"][rule]
            if before["seconds"]:
                part.append(1.0 - after["seconds"] / before["seconds"])
            if (before["named"], before["verdict"]) == (after["named"], after["verdict"]):
                continue
            where.append(name)
            if name in truths:  # effects that are named and not there, or there and not named
                with_it, alone = (len(set(a["named"]) ^ truths[name]) for a in (before, after))
                right, wrong = right + (with_it < alone), wrong + (with_it > alone)
        saved = 100 * sum(part) / len(part) if part else 0.0
        numbers = "".join(f"{n:>9}" for n in (len(fires), len(where), right, wrong, round(saved)))
        lines.append(f"{rule:<28}{numbers}  {' '.join(where)}")
    return "\n".join(lines)


def main() -> None:
    """Diagnose each experiment in a process of its own, then print the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--truth", type=Path)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--json", type=Path, help="what each case said; those in it are not redone")
    parser.add_argument("--one", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        print(json.dumps(of_case(options.folders[0], options.only)))
        return
    folders = [e.parent for f in options.folders for e in sorted(f.glob("**/experiment.toml"))]
    done = json.loads(options.json.read_text()) if options.json and options.json.exists() else {}

    def run(folder: Path) -> None:
        words = [sys.executable, __file__, str(folder), "--one", "--only", *options.only]
        ran = subprocess.run(words, capture_output=True, text=True, check=False)
        if ran.returncode:
            print(f"{folder.name}: {ran.stderr.strip().splitlines()[-1:]}", file=sys.stderr)
            return
        done[folder.name] = json.loads(ran.stdout.splitlines()[-1])
        if options.json:
            options.json.write_text(json.dumps(done))
        print(folder.name, done[folder.name]["with"], file=sys.stderr, flush=True)

    with ThreadPoolExecutor(options.jobs) as pool:
        list(pool.map(run, [f for f in folders if f.name not in done]))
    truths = {}
    for path in options.truth.glob("*.json") if options.truth else ():
        effects = json.loads(path.read_text())["effects"]
        truths[path.stem] = {f"{e['effect']} at {e['at']}" for e in effects}
    print(table(done, truths))


if __name__ == "__main__":
    main()
