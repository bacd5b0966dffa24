"""Real remainders, known effects: how large must an effect be on a real machine to be named?

Between simulated cases, where all is known, and real ones, where nothing is: onto a real recording
the force of a known effect is grafted, by formulas of this file. The model that the diagnosis of
the bare recording ends with is the user's model. What it leaves, R (rms, below the bandwidth), is
the machine's own: grafts are so many times R. The user's model, estimated again, takes up a part of
a graft; the rest can be seen. Right is the grafted effect and no other; without a graft no name.

Source: recordings of single bodies that others published, or folders of one's own. The machine's
motion is as it was: a graft stands for a machine whose controller made up for the effect. Where
the machine stands still a friction may be anything, and none is grafted.

What was found is in docs/recovery_study.md, "Effects grafted onto real records".

    python studies/grafted_effects.py [NAME ...] [--quick] [--folder DIR] [--source DIR]
                                      [--size R ...] [--graft EFFECT ...] [--output DIR]

What is finished stays in DIR, a row a diagnosis: the same command goes on from there.
"""

from __future__ import annotations

import argparse
import itertools
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from recordings import experiment_of, names_in
from scipy.signal import butter, sosfiltfilt

import teleopdesign as td
from teleopdesign.base.errors import TeleopDesignError
from teleopdesign.diagnose.search_plan import PLAN, QUICK
from teleopdesign.show import save_figure

NAME = "grafted_effects"
#: times what the last model leaves
SIZES = (1.0, 2.0, 4.0)
#: times R: what is left of a graft is told in these steps
STEPS_OF_VISIBILITY = (0.5, 1.0, 2.0)
#: of the median speed: slower than that a machine stands still
STANDSTILL = 0.02
#: share of the command that a graft takes at most: no motor's torque varies by more, and a gear
#: that loses more is worn out
MOST_OF_COMMAND = 0.5
#: bandwidths up to which the motion of a graft is taken
MOTION = 3.0
Array = np.ndarray


@dataclass(frozen=True)
class Graft:
    """Force (N or N m) that a machine with the effect would take more, for a strength of one.

    force: of the motion (position, velocity, direction, command) and the recording's scales
    needs: effects that the model must have;  axis: on which it is an effect ("": either)
    of_command: the force is in proportion to the new command, and `force` is that of the old one
    """

    force: Callable[[SimpleNamespace, SimpleNamespace], Array]
    needs: frozenset[str] = frozenset()
    axis: str = ""
    of_command: bool = False


def _load_dependent(now: SimpleNamespace, of: SimpleNamespace) -> Array:
    """Level per force carried, by the command."""
    return np.abs(now.command) * now.direction


GRAFTS: Mapping[str, Graft] = {
    "spring": Graft(lambda now, of: now.position - of.middle),
    "hardening_spring": Graft(lambda now, of: (now.position - of.middle) ** 3),
    "cogging": Graft(lambda now, of: np.sin(2 * np.pi * 5 * now.position / of.travel)),
    "gravity": Graft(lambda now, of: np.sin(now.position + 0.4), axis="revolute"),
    "torque_ripple": Graft(
        lambda now, of: now.command * np.sin(2 * np.pi * 5 * now.position / of.travel),
        of_command=True,
    ),
    "stribeck": Graft(
        lambda now, of: np.exp(-((now.velocity / of.slow) ** 2)) * now.direction,
        needs=frozenset({"coulomb"}),
    ),
    "quadratic_drag": Graft(lambda now, of: now.velocity * np.abs(now.velocity)),
    "viscous_asymmetry": Graft(lambda now, of: np.abs(now.velocity), needs=frozenset({"viscous"})),
    "position_dependent_friction": Graft(
        lambda now, of: np.sin(2 * np.pi * 4 * now.position / of.travel) * now.direction,
        needs=frozenset({"coulomb"}),
    ),
    "load_dependent_friction": Graft(
        _load_dependent, needs=frozenset({"coulomb"}), of_command=True
    ),
}


def _low_passed(y: Array, frequency: float, period: float) -> Array:
    return np.asarray(sosfiltfilt(butter(2, frequency, fs=1 / period, output="sos"), y))


@dataclass(frozen=True)
class Machine:
    """A real recording with the model that its own diagnosis ends with.

    left: rms of the force that the model leaves on check records (N or N m), below the bandwidth
    parts: motion along each segment: its record's number, its rows, seconds a row, signals
    scales: middle and length of the travel, a slow speed, the speed below which it stands still
    """

    name: str
    experiment: td.Experiment
    model: td.Model
    bandwidth: float
    left: float
    parts: tuple[tuple[int, slice, float, SimpleNamespace], ...]
    scales: SimpleNamespace

    def takes(self, effect: str) -> bool:
        """Whether the effect can be grafted: a name that the model lacks, on such an axis."""
        (body,) = self.experiment.bodies
        there = {one.name for one in self.model.body(body).effects}
        graft = GRAFTS[effect]
        fits = not graft.axis or graft.axis == self.experiment.axis(body)
        return fits and effect not in there and graft.needs <= there

    def force(self, experiment: td.Experiment) -> float:
        """Rms of the command on check records (N or N m), below the bandwidth."""
        (body,) = experiment.bodies
        records = experiment.records
        return _rms(
            [
                _low_passed(
                    records[k].signals[f"{body}.actuator_force"][rows], self.bandwidth, period
                )
                for k, rows, period, _ in self.parts
                if records[k].use == "check" or not experiment.check_records
            ]
        )


def machine_of(name: str, experiment: td.Experiment, quick: bool) -> Machine:
    """The recording diagnosed as it is; raises TeleopDesignError: it has not one body."""
    if len(experiment.bodies) != 1:
        raise td.ExperimentError(f"{name}: grafts are for recordings of a single body")
    (body,) = experiment.bodies
    diagnosis = td.find_missing(
        experiment, plan=QUICK if quick else PLAN, among=("viscous",) if quick else None
    )
    bandwidth = diagnosis.prepared.bandwidth
    parts = []
    for k, record in enumerate(experiment.records):
        for rows in record.segments:
            if (rows.stop - rows.start) * record.sample_time * bandwidth < 3:
                continue
            period, signals = record.sample_time, record.signals
            position = _low_passed(signals[f"{body}.position"][rows], MOTION * bandwidth, period)
            now = SimpleNamespace(
                position=position,
                velocity=np.gradient(position, period),
                command=signals[f"{body}.actuator_force"][rows],
            )
            parts.append((k, rows, period, now))
    position = np.concatenate([now.position for *_, now in parts])
    speed = np.abs(np.concatenate([now.velocity for *_, now in parts]))
    still = STANDSTILL * float(np.median(speed))
    for *_, now in parts:
        now.direction = np.clip(now.velocity / still, -1.0, 1.0)
    scales = SimpleNamespace(
        middle=float(np.median(position)),
        travel=float(np.ptp(position)),
        slow=float(np.quantile(speed[speed > still], 0.2)),
    )
    model = replace(diagnosis.model, known=td.EFFECTS)
    machine = Machine(name, experiment, model, bandwidth, 1.0, tuple(parts), scales)
    return replace(machine, left=diagnosis.after.check_error * machine.force(experiment))


def _rms(parts: Sequence[Array]) -> float:
    return float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))


def grafted(machine: Machine, effect: str, size: float) -> td.Experiment | None:
    """The experiment as a machine with the effect gives it, of that many times what is left.

    Where the effect takes a share of the command, the command grows by the whole series; the size
    is that of its first term. None: the effect would take more than `MOST_OF_COMMAND`.
    """
    (body,) = machine.experiment.bodies
    forces = [GRAFTS[effect].force(now, machine.scales) for *_, now in machine.parts]
    visible_forces = [
        _low_passed(force, machine.bandwidth, period)
        for (_, _, period, _), force in zip(machine.parts, forces, strict=True)
    ]
    strength = size * machine.left / _rms(visible_forces)
    records = machine.experiment.records
    commands = [np.array(record.signals[f"{body}.actuator_force"]) for record in records]
    for (k, rows, _, now), force in zip(machine.parts, forces, strict=True):
        more = strength * force
        if GRAFTS[effect].of_command:
            share = np.divide(more, now.command, np.zeros_like(more), where=now.command != 0.0)
            if np.abs(share).max() > MOST_OF_COMMAND:
                return None
            more = more / (1.0 - share)  # what the new command takes, not the old one
        commands[k][rows] = now.command + more
    return replace(
        machine.experiment,
        records=tuple(
            replace(r, signals={**r.signals, f"{body}.actuator_force": command})
            for r, command in zip(records, commands, strict=True)
        ),
    )


def row_of(machine: Machine, effect: str, size: float, quick: bool) -> dict[str, Any] | None:
    """What the diagnosis says with this graft ("": none); the user's model is the machine's.

    None: so large a graft is no such effect.
    """
    experiment = grafted(machine, effect, size) if effect else machine.experiment
    if experiment is None:
        return None
    diagnosis = td.find_missing(
        experiment,
        machine.model,
        plan=QUICK if quick else PLAN,
        among=("viscous", "spring") if quick else None,
    )
    force = machine.force(experiment)
    alike = {group[0].effect.name: [c.effect.name for c in group] for group in diagnosis.groups}
    return {
        "recording": machine.name,
        "graft": effect,
        "size": size,
        "named": [c.effect.name for c in diagnosis.missing],
        "ladder": [rung.added.effect.name for rung in diagnosis.rungs if rung.added],
        "alike": alike,
        "verdict": diagnosis.verdict,
        "before": diagnosis.before.check_error * force / machine.left,
        "after": diagnosis.after.check_error * force / machine.left,
    }


def outcome(row: Mapping[str, Any]) -> str:
    """How the answer is judged: "right", "among others", "leading", "missed", "false name"."""
    graft, named, ladder = row["graft"], row["named"], row["ladder"]
    if not graft:
        return "false name" if named else "right"
    same = [name for name in named if graft in row["alike"].get(name, [name])]
    if named and same:
        return "right" if len(named) == 1 else "among others"
    if named:
        return "false name"
    leads = ladder and graft in row["alike"].get(ladder[0], [ladder[0]])
    return "leading" if leads else "missed"


OUTCOMES = ("right", "among others", "leading", "missed", "false name")
COLOURS = ("#1b7837", "#a6dba0", "#fdae61", "0.75", "#b2182b")


def visible_size(row: Mapping[str, Any]) -> float:
    """What the user's model, estimated again, leaves of a graft, times R.

    Its free parameters take up a part: a drag passes for friction, a spring for gravity.
    """
    return float(np.sqrt(max(row["before"] ** 2 - 1.0, 0.0)))


def table(rows: Sequence[Mapping[str, Any]]) -> str:
    """How often each outcome came, by what is seen of the graft, as a table of Markdown."""
    lines = [
        "| left of the graft | diagnoses | " + " | ".join(OUTCOMES) + " |",
        "| --- " * (len(OUTCOMES) + 2) + "|",
    ]
    groups = {"no graft": [outcome(row) for row in rows if not row["graft"]]}
    for low, high in itertools.pairwise((0.0, *STEPS_OF_VISIBILITY, float("inf"))):
        name = f"{low:g} R and more" if np.isinf(high) else f"{low:g} to {high:g} R"
        groups[name] = [outcome(r) for r in rows if r["graft"] and low <= visible_size(r) < high]
    for name, judged in groups.items():
        counts = " | ".join(str(judged.count(one)) for one in OUTCOMES)
        lines.append(f"| {name} | {len(judged)} | {counts} |")
    return "\n".join(lines)


def plot(rows: Sequence[Mapping[str, Any]]) -> Figure:
    """Outcome of every graft: recordings beside each other, effects below, a mark a size."""
    recordings = list(dict.fromkeys(row["recording"] for row in rows if row["graft"]))
    effects = [e for e in GRAFTS if any(row["graft"] == e for row in rows)]
    sizes = sorted({row["size"] for row in rows if row["graft"]})
    figure, axes = plt.subplots(
        figsize=(2.6 + 1.2 * len(recordings), 1.6 + 0.28 * len(effects)), layout="constrained"
    )
    axes.tick_params(length=0)
    for one, colour in zip(OUTCOMES, COLOURS, strict=True):
        points = [
            (
                recordings.index(row["recording"])
                + 0.22 * (sizes.index(row["size"]) - (len(sizes) - 1) / 2),
                effects.index(row["graft"]),
                20 + 40 * sizes.index(row["size"]),
            )
            for row in rows
            if row["graft"] and outcome(row) == one
        ]
        if not points:
            continue
        x, y, area = np.array(points).T
        axes.scatter(x, y, s=area, color=colour, edgecolor="0.3", linewidth=0.4)
        axes.scatter([], [], s=40, color=colour, edgecolor="0.3", linewidth=0.4, label=one)
    axes.set_xticks(range(len(recordings)), [r.replace("_", "\n") for r in recordings])
    axes.set_yticks(range(len(effects)), [e.replace("_", " ") for e in effects])
    axes.set_xlim(-0.5, len(recordings) - 0.5)
    axes.invert_yaxis()
    marks = ", ".join(f"{size:g}" for size in sizes)
    figure.supxlabel(f"larger marks: larger grafts ({marks} times R)", fontsize="small")
    figure.legend(loc="outside upper center", ncols=2, frameon=False, fontsize="small")
    return figure


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="recordings (default: all)")
    parser.add_argument("--quick", action="store_true", help="one graft on the example that ships")
    parser.add_argument("--folder", type=Path, help="folder of folders with experiment.toml")
    parser.add_argument("--source", help="folder of copies of the public files, not downloads")
    parser.add_argument("--size", nargs="+", type=float, default=list(SIZES), metavar="R")
    parser.add_argument("--graft", nargs="+", choices=list(GRAFTS), default=list(GRAFTS))
    parser.add_argument("--output", type=Path, default=Path(__file__).parent / "output" / NAME)
    return parser


def main(arguments: Sequence[str] | None = None) -> None:
    """Graft, diagnose, judge; write rows, table and figure. See the module's docstring."""
    options = _parser().parse_args(arguments)
    options.output.mkdir(parents=True, exist_ok=True)
    path = options.output / f"{NAME}.json"
    rows = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else []
    done = {(row["recording"], row["graft"], row["size"]) for row in rows}
    if options.quick:
        names, plan = ["rod"], [("", 0.0), ("spring", 4.0)]
    else:
        names = options.names or names_in(options.folder)
        plan = [("", 0.0), *((g, size) for g in options.graft for size in options.size)]
    for name in names:
        try:
            if options.quick:
                experiment = td.load_experiment(td.example("rod"))
            else:
                experiment = experiment_of(name, options.folder, options.source)
            machine = machine_of(name, experiment, options.quick)
        except TeleopDesignError as error:
            print(f"{name}: not here: {str(error).splitlines()[0]}", flush=True)
            continue
        for effect, size in plan:
            if (name, effect, size) in done or (effect and not machine.takes(effect)):
                continue
            row = row_of(machine, effect, size, options.quick)
            if row is None:
                print(f"{name}: {effect} {size:g}: it would take half of the command: left out")
                continue
            rows.append(row)
            path.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
            last = rows[-1]
            print(
                f"{name}: {effect or 'no graft'} {size:g}: {outcome(last)}; "
                f"{', '.join(last['named'] or last['ladder']) or '-'} ({last['verdict']})",
                flush=True,
            )
    if not rows:
        return
    made = table(rows)
    (options.output / f"{NAME}.md").write_text(made + "\n", encoding="utf-8")
    if any(row["graft"] for row in rows):
        save_figure(plot(rows), options.output / NAME)
    print(made)


if __name__ == "__main__":
    main()
