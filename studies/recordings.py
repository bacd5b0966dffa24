"""Real devices: is the diagnosis as good as a black box, and which physics does it name?

Each recording is diagnosed as its experiment describes it. Beside the error of the user's model and
of the answer stands that of boosted trees which learned the force from the motion of the other
records (extra `learn`): a model of physics should leave no more. Errors are of check records.

Source: recordings that others published, `teleopdesign fetch`; others in folders of one's own.
Finding: docs/recordings.md is printed from what this study writes, by docs/make_recordings.py.

    python studies/recordings.py [NAME ...] [--quick] [--folder DIR] [--source DIR] [--output DIR]
                                 [--only EFFECT ...]

Rows of recordings that are not asked for stay in the output. One that is not here is downloaded
once; where that fails its row says why. A whole catalogue takes minutes a recording: --only names
the effects that are tried, and the row says so.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from _one_case import processor_seconds

import teleopdesign as td
from teleopdesign.base.errors import TeleopDesignError
from teleopdesign.diagnose.search_plan import PLAN, QUICK
from teleopdesign.measurement import Experiment
from teleopdesign.measurement.recordings import RECORDINGS
from teleopdesign.show import save_figure
from teleopdesign.unexplained import where_it_fails

NAME = "recordings"
#: what a quick run tries, on the first recording that is here
QUICK_EFFECTS = ("viscous", "bias")
#: sentences of what the last model leaves that a row keeps
SENTENCES = 4


def names_in(folder: Path | None) -> list[str]:
    """The recordings of a folder, then the public ones that it lacks."""
    names = sorted(p.parent.name for p in folder.glob("*/experiment.toml")) if folder else []
    return [*names, *(n for n in RECORDINGS if n not in names)]


def experiment_of(name: str, folder: Path | None, source: str | None) -> Experiment:
    """The experiment of that name: of the folder where it has one, else as published.

    raises ExperimentError: neither is there
    """
    if folder is not None and (folder / name / "experiment.toml").is_file():
        return td.load_experiment(folder / name)
    return td.load_experiment(td.fetch(name, **({"source": source} if source else {})))


def row_of(
    experiment: Experiment, output: Path, name: str, *, quick: bool, only: Sequence[str]
) -> dict[str, Any]:
    """What is found on one recording; its figure and its text beside the table."""
    wall, processor = time.perf_counter(), processor_seconds()
    plan, among = (QUICK if quick else PLAN), (only or None)
    diagnosis = td.find_missing(experiment, plan=plan, among=among)
    seconds = time.perf_counter() - wall, processor_seconds() - processor
    return described(diagnosis, output, name) | {
        "seconds": {"wall": seconds[0], "processor": seconds[1]},
        "only": list(only),
        "quick": quick,
    }


def described(diagnosis: Any, output: Path, name: str) -> dict[str, Any]:
    """What a diagnosis, or that of an arm, says of a recording; its figure beside the table."""
    is_arm, learned = diagnosis.experiment.arm is not None, diagnosis.learnable
    save_figure(diagnosis.plot(), output / name)
    row = {
        "verdict": diagnosis.verdict,
        "ladder": [
            {"added": rung.title or None, "check_error": rung.check_error}
            for rung in diagnosis.rungs
        ],
        "missing": [str(c) for c in diagnosis.missing],
        "text": str(diagnosis).replace(str(diagnosis.experiment.folder), name),
        "floor": diagnosis.floor.value,
        "trees": None if learned is None else learned.alone,
        "learnable": None if learned is None else learned.error,
    }
    if is_arm:
        return row
    left = where_it_fails(diagnosis.model, diagnosis.prepared, diagnosis.floor)[:SENTENCES]
    return row | {
        "indistinguishable": [[str(c) for c in group] for group in diagnosis.groups],
        "cannot_tell": [str(one) for one in diagnosis.undetermined],
        "left": [one.sentence for one in left],
    }


def table(rows: Mapping[str, Mapping[str, Any]]) -> str:
    """The rows as a table of Markdown: errors in percent, names, processor time."""
    lines = [
        "| recording | your model | answer | boosted trees | named | time |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for name, row in rows.items():
        if "skipped" in row:
            lines.append(f"| `{name}` | not here: {row['skipped']} | | | | |")
            continue
        first, last = (row["ladder"][i]["check_error"] for i in (0, -1))
        trees = "-" if row["trees"] is None else f"{100 * row['trees']:.2f} %"
        selection = f", of {len(row['only'])} effects" if row["only"] else ""
        lines.append(
            f"| `{name}` | {100 * first:.2f} % | {100 * last:.2f} % | {trees} | {_named(row)} | "
            f"{row['seconds']['processor']:.0f} s{selection} |"
        )
    return "\n".join(lines)


def _named(row: Mapping[str, Any]) -> str:
    """What is named; each with those that the records do not tell from it."""
    alike = {group[0]: group for group in row.get("indistinguishable", ())}
    names = [" or ".join(f"`{c}`" for c in alike.get(one, [one])) for one in row["missing"]]
    if names:
        return ", ".join(names).replace(" at device", "")
    unnamed = [f"`{r['added']}`" for r in row["ladder"] if r["added"]]
    leading = f", not named: {', '.join(unnamed)}" if unnamed else ""
    return f"{row['verdict'].replace('_', ' ')}{leading}".replace(" at device", "")


def _saved(path: Path) -> dict[str, Any]:
    return dict(json.loads(path.read_text(encoding="utf-8"))) if path.is_file() else {}


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="recordings (default: all)")
    parser.add_argument("--quick", action="store_true", help="two effects on the first one here")
    parser.add_argument("--folder", type=Path, help="folder of folders with experiment.toml")
    parser.add_argument("--source", help="folder of copies of the public files, not downloads")
    parser.add_argument(
        "--only", nargs="+", default=[], metavar="EFFECT", help="the effects that are tried"
    )
    parser.add_argument("--output", type=Path, default=Path(__file__).parent / "output" / NAME)
    return parser


def main(arguments: Sequence[str] | None = None) -> None:
    """Diagnose and write table, rows, texts and figures; see the module's docstring."""
    options = _parser().parse_args(arguments)
    options.output.mkdir(parents=True, exist_ok=True)
    path = options.output / f"{NAME}.json"
    rows = {} if options.quick else _saved(path)
    only = options.only or (QUICK_EFFECTS if options.quick else [])
    for name in options.names or names_in(options.folder):
        try:
            experiment = experiment_of(name, options.folder, options.source)
            rows[name] = row_of(experiment, options.output, name, quick=options.quick, only=only)
        except TeleopDesignError as error:
            rows[name] = {"skipped": str(error).splitlines()[0]}
        path.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
        print(rows[name].get("text", f"{name}: {rows[name].get('skipped')}"), flush=True)
        if options.quick and "skipped" not in rows[name]:
            break
    made = table(rows)
    (options.output / f"{NAME}.md").write_text(made + "\n", encoding="utf-8")
    print(made)


if __name__ == "__main__":
    main()
