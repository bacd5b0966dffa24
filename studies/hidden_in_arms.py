"""Which effect does which joint of an arm lack: is the right one named at the right joint?

Arms of 2 to 4 joints, a few of 6, are drawn by a simulator that shares no code with the package
(`tests/arms/arm_simulator.py`): links in any direction, Fourier paths of all joints at once. The
user knows the kinematics, no inertial value, and states `coulomb` and `viscous` at each joint. In
two cases of three one joint has one effect more, in the third none has. The joints are recorded at
100 Hz with 1 % of noise on the force, in every second case with all commands up to a row late or
early; the parameters of all are estimated on one path, and effects are judged on another. Right is:
that effect at that joint and nothing else; without one, no name and the verdict that the model is
adequate.

What was found is in docs/arms.md.

    python studies/hidden_in_arms.py [--quick] [--cases N] [--seed S] [--folder DIR] [--output DIR]

Cases and answers stay in DIR: what is there is not made again.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from _one_case import processor_seconds, write_json
from _recovery_tables import line
from _scoring import Truth, judge, load_answer, share
from matplotlib.figure import Figure

import teleopdesign as td
from teleopdesign.diagnose import write_answer
from teleopdesign.show import save_figure

NAME = "hidden_in_arms"
#: the simulator of arms: code that shares nothing with the package
MAKER = Path(__file__).resolve().parents[1] / "tests" / "arms"
#: joints in turn: with three levels, every number of joints meets every level
JOINTS = (2, 3, 4, 2, 3, 2, 4, 3, 2, 6)
LEVELS = ("clear", "null", "clear")
#: strengths that a hidden effect is drawn from: about one is a third of the friction there
STRENGTH = (0.7, 1.5)
#: effects that are one force while a joint slides with `coulomb`: right is to list them together
SAME = ("bias", "coulomb_asymmetry")
#: outcomes that count: it alone, or listed with the one that is the same force
RIGHT = ("right", "look-alike")
#: s of each record
SECONDS = 30.0
#: among which a quick run searches; the first is what its arm hides
QUICK_EFFECTS = ("position_dependent_friction", "spring")
#: Hz, of the rows
RATE = 100.0


@dataclass(frozen=True)
class Case:
    """One arm: its number, joints, and what is hidden (name, number of the joint, strength).

    late: rows by which its commands are logged late
    """

    number: int
    joints: int
    hidden: tuple[str, int, float] | None
    late: float = 0.0

    @property
    def name(self) -> str:
        """Of its folder."""
        return f"{self.number + 1:04d}"

    @property
    def truth(self) -> Truth:
        """What an answer is judged by."""
        if self.hidden is None:
            return Truth(self.name, "null", (), (), {})
        effect, at = _place(self.hidden)
        alike = frozenset((name, at) for name in SAME)
        return Truth(self.name, "clear", ((effect, at),), (alike,), {})


@dataclass(frozen=True)
class Row:
    """A judged case.

    size: rms of the hidden force over that of the joint's, check record; 0 where none is hidden
    name: verdict or names;  before, after: check errors of the arm;  seconds: of processor time
    """

    case: Case
    size: float
    outcome: str
    name: str
    before: float
    after: float
    floor: float
    seconds: float


def plan(number: int, seed: int, joints: Sequence[int] = JOINTS) -> list[Case]:
    """The first cases of a campaign; a longer one begins with the same. Effects come in turn."""
    from arm_simulator import HIDDEN

    cases, count = [], 0
    for k in range(number):
        generator = np.random.default_rng([seed, k])
        n, hidden = joints[k % len(joints)], None
        if LEVELS[k % len(LEVELS)] == "clear":
            turn, place = divmod(count, len(HIDDEN))
            order = np.random.default_rng([seed, 1000 + turn]).permutation(len(HIDDEN))
            strength = float(generator.uniform(*STRENGTH))
            hidden = (HIDDEN[order[place]], int(generator.integers(n)), strength)
            count += 1
        late = float(generator.integers(-4, 5)) / 4.0 if k // 2 % 2 else 0.0
        cases.append(Case(k, n, hidden, late))
    return cases


def run(case: Case, seed: int, folder: Path, *, quick: bool = False) -> None:
    """Make and diagnose a case whose answer is not there yet; quick: shorter, among few effects."""
    from arm_simulator import random_arm, write_experiment

    path = folder / "answers" / f"{case.name}.json"
    if path.exists():
        return
    generator = np.random.default_rng([seed, case.number, 1])
    arm = random_arm(generator, case.joints)
    experiment = folder / "cases" / case.name
    write_experiment(
        experiment,
        arm,
        generator,
        case.hidden,
        seconds=10.0 if quick else SECONDS,
        rate=RATE,
        late=case.late,
    )
    among = QUICK_EFFECTS if quick else None
    begin = processor_seconds()
    diagnosis = td.find_missing(td.load_experiment(experiment), among=among)
    spent = processor_seconds() - begin
    path.parent.mkdir(parents=True, exist_ok=True)
    write_answer(diagnosis, path)
    write_json(folder / "facts" / f"{case.name}.json", {"seconds": spent})


def judged(case: Case, folder: Path) -> Row | None:
    """The row of a case; None where it has no answer yet."""
    answer = load_answer(folder / "answers" / f"{case.name}.json")
    if answer is None:
        return None
    facts, hidden = (
        json.loads((folder / place).read_text(encoding="utf-8"))
        for place in (f"facts/{case.name}.json", f"cases/{case.name}/truth.json")
    )
    ladder: list[dict[str, Any]] = answer.content["ladder"]
    named = ", ".join(f"{effect} at {at}" for effect, at in answer.named)
    return Row(
        case=case,
        size=hidden["size"],
        outcome=judge(case.truth, answer),
        name=named or answer.verdict,
        before=ladder[0]["check_error"],
        after=ladder[-1]["check_error"],
        floor=answer.content["noise_floor"],
        seconds=facts["seconds"],
    )


def summary(rows: Sequence[Row]) -> str:
    """A line for each number of joints, and one for all."""
    lines = []
    for n in [*sorted({r.case.joints for r in rows}), None]:
        mine = [r for r in rows if n in (None, r.case.joints)]
        hidden = [r for r in mine if r.case.hidden is not None]
        adequate = [r for r in mine if r.case.hidden is None]
        lines.append(
            [
                "all" if n is None else str(n),
                str(share(r.outcome in RIGHT for r in hidden)),
                str(share(r.outcome != "right" for r in adequate)),
                f"{np.median([r.seconds for r in mine]):.0f} s",
            ]
        )
    head = ["joints", "right effect at the right joint", "false alarms", "processor time, median"]
    return _table(head, lines)


def details(rows: Sequence[Row]) -> str:
    """A line a case."""
    lines = []
    for r in rows:
        hidden = "-" if r.case.hidden is None else "{} at {}".format(*_place(r.case.hidden))
        errors = [f"{100 * x:.2f}" for x in (r.before, r.after, r.floor)]
        size = f"{100 * r.size:.1f}"
        about = [r.case.name, str(r.case.joints), f"{r.case.late:g}", hidden, size]
        lines.append([*about, r.name, r.outcome, *errors])
    head = ["case", "joints", "rows late", "hidden", "its force, %", "said", "outcome"]
    return _table([*head, "before, %", "after, %", "floor, %"], lines)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    return "\n".join([line(head), line(["---"] * len(head)), *map(line, rows)])


def _place(hidden: tuple[str, int, float]) -> tuple[str, int]:
    return hidden[0], f"joint{hidden[1] + 1}"


def plot(rows: Sequence[Row]) -> Figure:
    """Error of the arm before and after, over the size of what is hidden."""
    figure, axes = plt.subplots(figsize=(4.2, 3.2), layout="constrained")
    for mark, is_right, label in (("o", True, "right"), ("x", False, "not right")):
        mine = [r for r in rows if (r.outcome in RIGHT) == is_right]
        size, before, after = (
            [100 * getattr(r, name) for r in mine] for name in ("size", "before", "after")
        )
        axes.plot(size, before, mark, color="0.6", ms=4)
        axes.plot(size, after, mark, color="C0", ms=4, label=f"with what was named: {label}")
    axes.set_yscale("log")
    axes.set_xlabel("hidden force over that of its joint (%)")
    axes.set_ylabel("check error of the arm (%)")
    axes.legend(frameon=False)
    return figure


def write(rows: Sequence[Row], output: Path) -> str:
    """Tables, numbers and the figure; returns the tables."""
    output.mkdir(parents=True, exist_ok=True)
    path = output / NAME
    text = f"{summary(rows)}\n\n{details(rows)}\n"
    path.with_suffix(".md").write_text(text, encoding="utf-8")
    content = [
        {
            "case": r.case.name,
            "joints": r.case.joints,
            "hidden": r.case.hidden,
            "late": r.case.late,
            "outcome": r.outcome,
            "said": r.name,
            "errors": [r.before, r.after, r.floor],
            "size": r.size,
            "seconds": r.seconds,
        }
        for r in rows
    ]
    write_json(path.with_suffix(".json"), content)
    save_figure(plot(rows), path)
    return text


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0] if __doc__ else "")
    parser.add_argument("--quick", action="store_true", help="one small arm, not kept")
    parser.add_argument("--cases", type=int, default=30, help="how many (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--folder", type=Path, help="of cases and answers (default: in the output)")
    parser.add_argument("--score-only", action="store_true", help="of what is there already")
    parser.add_argument("--output", type=Path, default=Path(__file__).parent / "output")
    return parser


def main(arguments: Sequence[str] | None = None) -> None:
    """Make, diagnose and judge; see the module's docstring."""
    options = _parser().parse_args(arguments)
    sys.path.insert(0, str(MAKER))
    cases = plan(1, options.seed, (2,)) if options.quick else plan(options.cases, options.seed)
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) if options.quick else options.folder or options.output / NAME
        rows = []
        for case in cases:
            if not options.score_only:
                run(case, options.seed, folder, quick=options.quick)
            if (row := judged(case, folder)) is not None:
                rows.append(row)
                print(case.name, case.joints, case.hidden, row.name, row.outcome, flush=True)
        print(write(rows, options.output))
    print(f"written: {options.output / NAME}.md and others")


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        raise SystemExit("\nstopped; the same command goes on from here") from None
