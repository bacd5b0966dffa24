"""The command `teleopdesign`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from . import __version__
from .errors import ExperimentError, TeleopDesignError


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns the exit status: 0, or 2 for bad input (one line says which)."""
    try:
        options = _parser().parse_args(arguments)
        status: int = options.run(options)
        return status
    except TeleopDesignError as error:
        print(f"teleopdesign: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("teleopdesign: stopped", file=sys.stderr)
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="teleopdesign",
        description="Friction in haptic interfaces and teleoperators: find what a model lacks.",
    )
    parser.add_argument("--version", action="version", version=f"teleopdesign {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    diagnose = commands.add_parser(
        "diagnose", help="compare a model with a recording and find the missing effect"
    )
    diagnose.add_argument("folder", type=Path, help="folder with experiment.toml and its records")
    _add_outputs(diagnose)
    diagnose.set_defaults(run=_diagnose)

    effects = commands.add_parser("effects", help="list the physical effects, or show one")
    effects.add_argument("name", nargs="?", help="show this effect's page")
    effects.add_argument("--effect", action="append", default=[], type=Path, metavar="FILE")
    effects.set_defaults(run=_effects)

    fetch = commands.add_parser("fetch", help="download a public recording of a real device")
    fetch.add_argument("name", help="emps, psm_insertion, mtm_wrist or hsm150")
    fetch.add_argument("--folder", type=Path, help="where to put it; default: the user's cache")
    fetch.set_defaults(run=_fetch)

    demo = commands.add_parser("demo", help="diagnose the experiment that ships with the package")
    demo.add_argument("--output", type=Path, default=Path("demo"), help="folder for what it writes")
    demo.set_defaults(run=_demo)
    return parser


def _add_outputs(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", type=Path, metavar="F", help="write the answer there")
    parser.add_argument(
        "--predictions",
        type=Path,
        metavar="F",
        help="write measured and modelled forces (.csv[.gz])",
    )
    parser.add_argument(
        "--figure", type=Path, metavar="F", help="write the figure (.png, .pdf, .svg)"
    )
    parser.add_argument(
        "--effect",
        action="append",
        default=[],
        type=Path,
        metavar="FILE",
        help="an effect file of your own that takes part (may be repeated)",
    )


def _diagnose(options: argparse.Namespace) -> int:
    for path, endings in (
        (options.json, (".json",)),
        (options.predictions, (".csv", ".csv.gz")),
        (options.figure, (".png", ".pdf", ".svg")),
    ):
        if path is not None:
            _check_output(path, endings)
    from .diagnose import find_missing
    from .diagnose.answer import write_answer, write_predictions
    from .effects import catalogue
    from .measurement import load_experiment
    from .model import Model

    experiment = load_experiment(options.folder)
    model = Model.from_experiment(experiment, catalogue(options.effect))
    print(experiment)
    print()
    diagnosis = find_missing(experiment, model, progress=_say)
    _say("")
    print(diagnosis)
    if options.json is not None:
        write_answer(diagnosis, options.json)
    if options.predictions is not None:
        write_predictions(diagnosis, options.predictions)
    if options.figure is not None:
        diagnosis.plot().savefig(options.figure)
    return 0


def _check_output(path: Path, endings: tuple[str, ...]) -> None:
    """Say before the work, not after it, that a result could not be written."""
    if not path.name.endswith(endings):
        raise ExperimentError(f"{path}: found {path.suffix!r}, expected {' or '.join(endings)}")
    if not path.parent.is_dir():
        raise ExperimentError(f"{path}: there is no folder {str(path.parent)!r}")
    if path.is_dir():
        raise ExperimentError(f"{path}: is a folder, expected a file")


def _say(text: str) -> None:
    """Progress on one line of the terminal; nothing where nobody watches."""
    if sys.stderr.isatty():
        print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)


def _effects(options: argparse.Namespace) -> int:
    from .effects import catalogue, find_effect

    known = catalogue(options.effect)
    if options.name is None:
        for name, effect in known.items():
            print(f"{name:<20} {effect.role:<15} {effect.title}")
        return 0
    effect = find_effect(options.name, known, "effects")
    print(f"{effect.name}  ({effect.role})\n\n{effect.text.strip()}\n")
    for name, parameter in effect.parameters.items():
        print(f"  {name:<22} {parameter.quantity:<14} {parameter.meaning}")
    print(f"\nSource: {effect.source}")
    return 0


def _fetch(options: argparse.Namespace) -> int:
    from .measurement.recordings import fetch

    print(fetch(options.name, options.folder))
    return 0


def _demo(options: argparse.Namespace) -> int:
    """Diagnose the shipped experiment; answer, predictions and figure go into one folder."""
    from .examples import example

    folder = example("rod")
    output: Path = options.output
    try:
        output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ExperimentError(f"{output}: {error.strerror}") from error
    written = [output / n for n in ("answer.json", "predictions.csv.gz", "ladder.png")]
    print(
        "The experiment that ships with the package, held against a model that lacks an effect:\n"
    )
    status = main(
        [
            "diagnose",
            str(folder),
            *("--json", str(written[0])),
            *("--predictions", str(written[1])),
            *("--figure", str(written[2])),
        ]
    )
    if status == 0:
        print("\nwritten: " + ", ".join(map(str, written)))
    return status


if __name__ == "__main__":
    sys.exit(main())
