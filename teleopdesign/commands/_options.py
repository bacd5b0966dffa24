"""Arguments, paths and messages that several commands share.

Values on the command line: a number, and a unit unless the number is in SI.
"""

from __future__ import annotations

import argparse
import math
import shlex
from collections.abc import Callable, Iterable, Mapping
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ExperimentError
from ..base.files import check_writable, write_json
from ..base.units import AXES, QUANTITIES, to_si, unit_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def add_effect_files(parser: argparse.ArgumentParser) -> None:
    """Argument: the user's effect files."""
    add_repeated(parser, "--effect", "FILE", "file that defines a further effect", kind=Path)


def add_law_files(parser: argparse.ArgumentParser) -> None:
    """Argument: the user's files of control laws."""
    text = "file that defines a further control law for the diagram"
    add_repeated(parser, "--law", "FILE", text, kind=Path)


def add_repeated(
    parser: argparse.ArgumentParser, option: str, metavar: str, text: str, *, kind: type = str
) -> None:
    """Argument: an option that may be repeated; its values are a list."""
    parser.add_argument(
        option,
        action="append",
        default=[],
        type=kind,
        metavar=metavar,
        help=f"{text} (may be repeated)",
    )


#: option -> endings of its file, where no others are stated
ENDINGS = {"--json": (".json",), "--figure": (".png", ".pdf", ".svg")}


def add_output(parser: argparse.ArgumentParser, option: str, text: str, *endings: str) -> None:
    """Argument: a file that the command writes, which `check_outputs` checks before the work.

    text: the help;  endings: endings of the file name that are allowed, by default `ENDINGS`
    """
    endings = endings or ENDINGS[option]
    action = parser.add_argument(
        option, type=Path, metavar="F", help=f"{text} ({', '.join(endings)})"
    )
    parser.set_defaults(files={**(parser.get_default("files") or {}), action.dest: endings})


def check_outputs(options: argparse.Namespace) -> None:
    """Raise ExperimentError if a file of `add_output` cannot be written."""
    for name, endings in getattr(options, "files", {}).items():
        if (path := getattr(options, name)) is not None:
            check_output(path, endings)


def check_output(path: Path, endings: tuple[str, ...]) -> None:
    """Raise ExperimentError before the work, not after it, if a result cannot be written.

    endings: endings of the file name that are allowed
    """
    if not path.name.endswith(endings):
        raise ExperimentError(f"{path}: found {path.suffix!r}, expected {' or '.join(endings)}")
    if not path.parent.is_dir():
        raise ExperimentError(f"{path}: there is no folder {str(path.parent)!r}")
    if path.is_dir():
        raise ExperimentError(f"{path}: is a folder, expected a file")
    check_writable(path)


def count_argument(text: str) -> int:
    """A whole number from 1, as the type of an argument of argparse."""
    try:
        number = int(text)
    except ValueError:
        number = 0
    if number < 1:
        raise argparse.ArgumentTypeError(f"found {text!r}, expected a whole number from 1")
    return number


Writer = Callable[[Path], object]


def write_requested(
    options: argparse.Namespace,
    writers: Mapping[str, Writer] | None = None,
    *,
    json: Callable[[], object] | None = None,
    figure: Callable[[], Figure] | None = None,
) -> None:
    """Write each file that the options request, and print their names in one line.

    writers: option -> the function that writes its file
    json: gives plain data;  figure: draws; both are called only if their file is requested
    """
    from ..show import save_figure

    known = dict(writers or {})
    if json is not None:
        known["json"] = lambda path: write_json(path, json())
    if figure is not None:
        known["figure"] = lambda path: save_figure(figure(), path, suffixes=(path.suffix,))
    paths = {name: path for name in known if (path := getattr(options, name)) is not None}
    for name, path in paths.items():
        known[name](path)
    say_written(*paths.values())


def say_written(*paths: Path) -> None:
    """Print the names of the files that were written, in one line; nothing if there are none."""
    if paths:
        print(f"\nwritten: {', '.join(map(str, paths))}")


def refuse_options(options: argparse.Namespace, names: Iterable[str], why: str) -> None:
    """Raise ExperimentError for the first of these options that is stated.

    names: as the options are stored;  why: words after the option
    """
    for name in names:
        value = getattr(options, name, None)
        if not (value is None or value is False or value == []):
            raise ExperimentError(f"--{name.replace('_', '-')}: {why}")


def require_positive(options: argparse.Namespace, names: Iterable[str], unit: str = "") -> None:
    """Raise ExperimentError for the first of these options that is not above 0; None is allowed."""
    for name in names:
        value = getattr(options, name)
        if value is not None and not (math.isfinite(value) and value > 0):
            raise ExperimentError(f"--{name}: found {value:g}, expected more than 0{unit}")


def split_pairs(
    texts: Iterable[str], option: str, form: str = "NAME=VALUE", *, at_last: bool = False
) -> dict[str, str]:
    """Name -> value of texts "NAME=VALUE";  at_last: the name may hold signs of equality."""
    pairs = {}
    for text in texts:
        name, sign, value = text.rpartition("=") if at_last else text.partition("=")
        if not (sign and name and value):
            raise ExperimentError(f"{option}: found {text!r}, expected {form}")
        pairs[name] = value
    return pairs


def make_folder(path: Path) -> Path:
    """The folder, which is created if it does not exist.

    A file that exists in the folder may be replaced later.

    raises ExperimentError: the folder cannot be created, or no file can be written in it
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ExperimentError(f"{path}: {error.strerror}") from error
    check_writable(path / "trial")
    return path


def add_experiment(parser: argparse.ArgumentParser, *, answer: bool = True) -> None:
    """Arguments: the experiment's folder, the user's effects, and an answer to continue from."""
    parser.add_argument(
        "folder",
        type=Path,
        help="folder with experiment.toml and its records, or an answer of `teleopdesign "
        "diagnose --json`",
    )
    if answer:
        add_answer(parser)
    else:
        parser.set_defaults(answer=None)
    add_effect_files(parser)


def add_answer(parser: argparse.ArgumentParser) -> None:
    """Argument: an answer that replaces a diagnosis."""
    parser.add_argument(
        "--answer",
        type=Path,
        metavar="F",
        help="use this answer of `teleopdesign diagnose --json` for the folder, without a new "
        "diagnosis",
    )


def add_search(parser: argparse.ArgumentParser) -> None:
    """Arguments: the extent of a diagnosis's search, and its candidate effects."""
    parser.add_argument(
        "--quick",
        action="store_true",
        help="a fast first diagnosis: at most two effects, no pairs that mask each other, no "
        "exchange of effects, parts of long records; prints what was left out",
    )
    add_candidate_options(parser)


def add_candidate_options(parser: argparse.ArgumentParser) -> None:
    """Arguments: the effects that are candidates, and the effects that are not."""
    for option, text in (
        ("--only", "only these effects are candidates (default: all effects that the model lacks)"),
        ("--exclude", "these effects are no candidates"),
    ):
        parser.add_argument(
            option, action="extend", nargs="+", default=[], metavar="EFFECT", help=text
        )


def value_from(text: str, *, quantity: str, axis: str, where: str) -> float:
    """The value in SI of a text such as "0.2", "45deg" or "3 N".

    where: beginning of an error message
    raises ExperimentError: no number, or a unit of another quantity
    """
    from ..measurement.description import split_value  # heavy: not for --help

    parts = split_value(text)
    if parts is None:
        raise ExperimentError(f"{where}: found {text!r}, expected a number and a unit")
    size, unit = parts
    return to_si(size, unit, quantity=quantity, axis=axis, where=where) if unit else size


def value_in(text: str, *, unit: str, where: str) -> float:
    """The value of a text such as "0.2", "5 mm" or "45deg" in the SI unit `unit`.

    where: beginning of an error message
    raises ExperimentError: no number, or a unit of another quantity
    """
    of_unit = (q for q in product(QUANTITIES, AXES) if unit_of(*q) == unit)
    quantity, axis = next(of_unit, ("dimensionless", AXES[0]))
    return value_from(text, quantity=quantity, axis=axis, where=where)


def shell_word(path: Path | str) -> str:
    """A path as it is typed in a shell: in quotes if it contains spaces."""
    return shlex.quote(str(path))
