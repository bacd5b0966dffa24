"""measure a model over named parameters, on all cores or on a cluster"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..base.errors import ExperimentError, did_you_mean
from ..base.files import read_whole
from . import STOPPED
from ._command_line import BAD_INPUT
from ._options import add_effect_files, add_law_files, add_output, count_argument, write_requested
from ._terminal import PointReporter, replace_line

if TYPE_CHECKING:
    from ..studies import Study

#: name of the study in a file of Python
_NAME = "STUDY"
_MOST_REASONS = 5


EXAMPLES = """
  teleopdesign study swing.toml --out swing.nc --figure swing.png
  teleopdesign study sweep.py --workers 4
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "file",
        type=Path,
        help="a study: FILE.toml, which needs no Python; or FILE.py, a script that is RUN as a "
        f"whole and sets {_NAME} to the arguments of td.study",
    )
    parser.add_argument(
        "--workers", type=count_argument, metavar="N", help="processes (default: one for each core)"
    )
    parser.add_argument(
        "--scheduler", default="", metavar="A", help="address of a Dask cluster: tcp://ADDRESS:PORT"
    )
    add_output(
        parser,
        "--out",
        "write the data set; finished points are kept in F.part, and the same command continues "
        "from there",
        ".nc",
    )
    add_output(parser, "--figure", "write the figure")
    add_effect_files(parser)
    add_law_files(parser)


def run(options: argparse.Namespace) -> int:
    """Run the study, print its results, write the requested files."""
    if options.scheduler and options.workers is not None:
        raise ExperimentError("--workers: found beside --scheduler: a cluster has its own workers")
    arguments = _arguments(options)
    from ..studies import study

    reporter = PointReporter()
    try:
        result = study(
            **arguments,
            workers=options.workers,
            scheduler=options.scheduler,
            out=options.out,
            progress=reporter,
        )
    except KeyboardInterrupt:
        replace_line("")
        print(f"teleopdesign: stopped{_describe_kept(options.out, reporter)}", file=sys.stderr)
        return STOPPED
    replace_line("")
    print(result)
    _print_failures(result)
    if not result.measures and result.failures:
        return BAD_INPUT
    write_requested(options, figure=result.plot)
    return 0


def _arguments(options: argparse.Namespace) -> dict[str, Any]:
    path: Path = options.file
    if path.suffix == ".toml":
        from .. import controllers, effects
        from ..studies import read_study_file

        return read_study_file(
            path, effects=effects.catalogue(options.effect), laws=controllers.catalogue(options.law)
        )
    if path.suffix != ".py":
        raise ExperimentError(f"{path}: found {path.suffix!r}, expected .toml or .py")
    return _run_file(path)


def _run_file(path: Path) -> dict[str, Any]:
    """Run a user's Python file at the user's request; returns the arguments of its study."""
    import inspect

    from ..studies import study

    try:
        source = read_whole(path).decode("utf-8")
    except OSError as error:
        raise ExperimentError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise ExperimentError(f"{path}: not UTF-8 text (byte {error.start})") from None
    sys.path.insert(0, str(path.resolve().parent))
    names: dict[str, Any] = {"__name__": "__study__", "__file__": str(path)}
    try:
        exec(compile(source, str(path.resolve()), "exec"), names)
    except SyntaxError as error:
        raise ExperimentError(f"{path}: line {error.lineno}: {error.msg}") from None
    if _NAME not in names:
        raise ExperimentError(
            f"{path}: sets no {_NAME}, expected {_NAME} = dict(model=..., axes=..., measures=...)"
            f"{did_you_mean(_NAME, names)}"
        )
    arguments = names[_NAME]
    if not isinstance(arguments, dict):
        raise ExperimentError(f"{path}: {_NAME}: found {type(arguments).__name__}, expected a dict")
    beside = {"workers", "scheduler", "out", "progress"}
    known = [n for n in inspect.signature(study).parameters if n not in beside]
    for name in arguments:
        if name not in known:
            raise ExperimentError(
                f"{path}: {_NAME}: unknown {name!r}, expected {', '.join(known)}"
                f"{did_you_mean(name, known)}"
            )
    for name in ("model", "axes", "measures"):
        if name not in arguments:
            raise ExperimentError(f"{path}: {_NAME}: {name} is missing")
    return arguments


def _describe_kept(out: Path | None, reporter: PointReporter) -> str:
    if out is None:
        return "; no result is kept: use --out F to keep finished points"
    return (
        f"; {reporter.describe_finished()} kept in {out}.part, "
        "the same command continues from there"
    )


def _print_failures(result: Study) -> None:
    reasons = result.failures
    for reason, count in list(reasons.items())[:_MOST_REASONS]:
        print(f"  {count} failed: {reason}")
    if len(reasons) > _MOST_REASONS:
        print(f"  and {len(reasons) - _MOST_REASONS} other reasons")
