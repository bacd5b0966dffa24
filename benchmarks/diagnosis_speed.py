"""What does a diagnosis cost, in time and memory, over the length of a record and over effects?

The rod of the examples, its records cut to a part of their length or given several times over,
with all effects of the catalogue or the first of them. Each diagnosis runs in a process of its own,
once unmeasured so that the machine code is kept; what counts is the processor time of the second,
threads included, and the most memory that it held. Ratios are to the rod as it is; they, not
seconds, are what another machine should see.

    python benchmarks/diagnosis_speed.py [--json FILE] [--quick]
    python benchmarks/diagnosis_speed.py FOLDER ...     # experiments as they are, whole catalogue
"""

from __future__ import annotations

import argparse
import gzip
import json
import multiprocessing
import resource
import sys
import tempfile
import time
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from teleopdesign import Experiment, Model

LENGTHS = (0.25, 0.5, 1.0, 2.0, 4.0)  # of the rod's own 12 and 8 s
EFFECTS = (1, 5, 10, 20)  # besides the user's own; all of them in any case


@dataclass(frozen=True)
class Cost:
    """Processor time (s) and most memory (bytes) of one diagnosis, with what it was made of."""

    part: float
    effects: int
    samples: int
    seconds: float
    memory: int
    verdict: str


def write_rod(folder: Path, part: float) -> Path:
    """The example's folder with its records cut to a part, or once more so many times."""
    example = Path(str(files("teleopdesign") / "examples" / "rod"))
    head, *entries = (example / "experiment.toml").read_text().split("[[records]]")
    times = max(1, round(part))
    for name in ("fit.csv.gz", "check.csv.gz"):
        lines = gzip.decompress((example / name).read_bytes()).decode().splitlines(keepends=True)
        text = "".join(lines[: 1 + round(min(part, 1.0) * (len(lines) - 1))])
        for i in range(times):
            (folder / f"{i}_{name}").write_bytes(gzip.compress(text.encode()))
    again = [e.replace('file = "', f'file = "{i}_') for i in range(times) for e in entries]
    (folder / "experiment.toml").write_text("[[records]]".join([head, *again]))
    return folder


def diagnose(folder: str, part: float, effects: int | None) -> Cost:
    """The cost of the diagnosis of a folder, in this process.

    effects: how many may be missing from the one body; None: all that the experiment's model knows
    """
    from teleopdesign import Model, load_experiment
    from teleopdesign.effects import EFFECTS as CATALOGUE

    experiment = load_experiment(folder)
    if effects is None:
        return cost_of(experiment, None, part, len(CATALOGUE))
    stated = [e.name for e in Model.from_experiment(experiment).body("device").effects]
    others = [n for n in CATALOGUE if n not in stated][:effects]
    model = Model.from_experiment(experiment, {n: CATALOGUE[n] for n in (*stated, *others)})
    return cost_of(experiment, model, part, len(others))


def cost_of(experiment: Experiment, model: Model | None, part: float, effects: int) -> Cost:
    """The cost of one diagnosis, in this process."""
    from teleopdesign import find_missing

    begin = time.process_time()
    diagnosis = find_missing(experiment, model)
    seconds = time.process_time() - begin
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    samples = sum(len(r.time) for r in experiment.records)
    unit = 1 if sys.platform == "darwin" else 1024
    return Cost(part, effects, samples, seconds, memory * unit, diagnosis.verdict)


def measured(part: float, effects: int) -> Cost:
    """What the second of two diagnoses of the rod costs."""
    with tempfile.TemporaryDirectory() as folder:
        return second(str(write_rod(Path(folder), part)), part, effects)


def second(folder: str, part: float = 1.0, effects: int | None = None) -> Cost:
    """The second of two diagnoses, each in a process of its own."""
    # a fresh process each: memory is that of one diagnosis
    with multiprocessing.get_context("spawn").Pool(1, maxtasksperchild=1) as pool:
        costs = [pool.apply(diagnose, (folder, part, effects)) for _ in range(2)]
    return costs[1]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    parser.add_argument("--quick", action="store_true", help="two lengths, one effect")
    parser.add_argument("folder", nargs="*", help="experiments to diagnose in place of the rod")
    arguments = parser.parse_args()
    whole = 1 if arguments.quick else 1000
    lengths = (0.25, 1.0) if arguments.quick else LENGTHS
    costs = [second(folder) for folder in arguments.folder]
    if not costs:
        costs = [measured(part, whole) for part in lengths]
        costs += [] if arguments.quick else [measured(1.0, count) for count in EFFECTS]
    one = next(c for c in costs if c.part == 1.0 and c.effects == max(x.effects for x in costs))
    print("samples  effects    time   ratio   memory  verdict")
    for c in costs:
        print(
            f"{c.samples:>7} {c.effects:>8} {c.seconds:>6.1f} s {c.seconds / one.seconds:>6.2f}"
            f" {c.memory / 1e6:>6.0f} MB  {c.verdict}"
        )
    if arguments.json:
        figures = [vars(c) | {"ratio": c.seconds / one.seconds} for c in costs]
        arguments.json.write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
