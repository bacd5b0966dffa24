"""Which effect is missing: how often does the diagnosis name the right one, and how sure is it?

Cases are drawn by a simulator that shares no code with the package (`tests/hidden`): devices and
teleoperators, prismatic and revolute, all effects of the catalogue at all places, clear and weak,
two at once, none, and ones that no catalogue has; encoders, sensors, sample rates and excitations
from poor to rich. Each is diagnosed as a user would, and judged by the rules in `_scoring.py`.
PySINDy and SysIdentPy (extra `bench`), where they are installed, answer on the same files.

How it is judged, what the baselines get and what was found is in docs/recovery_study.md.

    python studies/hidden_effects.py [--quick] [--cases N] [--seed S] [--loggers]
                                     [--folder DIR] [--output DIR]

Cases and answers stay in DIR: what is there is not made again.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Sequence
from functools import partial
from importlib.util import find_spec
from pathlib import Path

from _campaign import EXCITATIONS, KINDS, LEVELS, Planned, duration, plan, run_campaign
from _recovery_figures import plot_calibration, plot_confusion
from _recovery_tables import (
    METHODS,
    Campaign,
    calibrations,
    collect,
    effects_table,
    main_table,
    outcomes_table,
    row_of,
    strata_table,
    write_rows,
)
from _scoring import load_answer, load_truth

from teleopdesign.show import save_figure

NAME = "hidden_effects"
BASELINES = tuple(m for m in METHODS if m != "answers")
#: a device at the lowest rate that lacks one effect
QUICK = {"levels": ("clear",), "kinds": ("device",), "excitations": ("normal",)}
QUICK_CASES = 1


def installed() -> list[str]:
    """The baselines that can be run."""
    return [name for name in BASELINES if find_spec(name) is not None]


def _describe(folder: Path, case: Planned) -> str:
    """What was hidden, what was said, and how that is judged."""
    if not (folder / "truth" / f"{case.name}.json").exists():
        return f"{case.level}: no machine meets this level"
    truth = load_truth(folder, case.name)
    row = row_of(case, truth, load_answer(folder / "answers" / f"{case.name}.json"), "answers")
    answer = row.named or row.groups or row.verdict
    return f"{case.level:<8}{row.true or '-'} -> {answer}: {row.outcome} ({row.seconds:.0f} s)"


def write(campaign: Campaign, output: Path) -> str:
    """Tables, rows and figures into a folder; returns the main table."""
    from _baselines import CANNOT

    output.mkdir(parents=True, exist_ok=True)
    path = output / NAME
    table = main_table(campaign)
    path.with_suffix(".md").write_text(table + "\n", encoding="utf-8")
    more = [outcomes_table(campaign), effects_table(campaign, CANNOT), strata_table(campaign)]
    path.with_name(f"{NAME}_more.md").write_text("\n\n".join(more) + "\n", encoding="utf-8")
    write_rows(campaign, path)
    save_figure(plot_confusion(campaign.of("answers")), output / f"{NAME}_confusion")
    save_figure(plot_calibration(calibrations(campaign)), output / f"{NAME}_calibration")
    return table


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="one case in a temporary folder")
    parser.add_argument("--cases", type=int, default=100, help="how many (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--folder", type=Path, help="of cases and answers (default: in the output)")
    parser.add_argument(
        "--levels", nargs="+", choices=sorted(set(LEVELS)), default=LEVELS, help="in turn"
    )
    parser.add_argument("--kind", choices=["device", "teleoperator", "both"], default="both")
    parser.add_argument(
        "--excitation", nargs="+", choices=sorted(set(EXCITATIONS)), default=EXCITATIONS
    )
    parser.add_argument(
        "--baselines", nargs="*", choices=BASELINES, help="default: those that are installed"
    )
    parser.add_argument(
        "--loggers",
        action="store_true",
        help="half of the cases: commands up to a row late or early, jitter, lost rows",
    )
    parser.add_argument("--workers", type=int, default=1, help="cases at a time")
    parser.add_argument("--score-only", action="store_true", help="of what is there already")
    parser.add_argument("--output", type=Path, default=Path(__file__).parent / "output")
    return parser


def _planned(options: argparse.Namespace) -> list[Planned]:
    if options.quick:
        return plan(QUICK_CASES, seed=options.seed, rates=(500.0,), **QUICK)
    return plan(
        options.cases,
        seed=options.seed,
        levels=options.levels,
        kinds=KINDS if options.kind == "both" else (options.kind,),
        excitations=options.excitation,
        loggers=options.loggers,
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Make, diagnose and judge; see the module's docstring."""
    options = _parser().parse_args(arguments)
    began = time.perf_counter()
    baselines = installed() if options.baselines is None else options.baselines
    cases = _planned(options)
    with tempfile.TemporaryDirectory() as scratch:
        # a quick run shows that all of it works today: it takes up nothing that is there
        folder = Path(scratch) if options.quick else options.folder or options.output / NAME
        folder.mkdir(parents=True, exist_ok=True)
        if not options.score_only:
            run_campaign(
                folder,
                cases,
                workers=options.workers,
                baselines=baselines,
                describe=partial(_describe, folder),
            )
        print(write(collect(folder, cases, ["answers", *baselines]), options.output))
    print(
        f"written: {options.output / NAME}.md and others; {duration(time.perf_counter() - began)}"
    )


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        raise SystemExit("\nstopped; the same command goes on from here") from None
