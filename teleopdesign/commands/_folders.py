"""Diagnosis of many folders: an answer for each folder, and a table of all."""

from __future__ import annotations

import argparse
import csv
import math
import sys
from collections.abc import Sequence
from io import StringIO
from typing import TYPE_CHECKING

from ..base.errors import ExperimentError
from ..base.files import harmless_cell, write_text
from ..base.sentences import percent
from . import STOPPED
from ._diagnosis import candidate_effects, effects_by_name
from ._failures import BAD_INPUT
from ._options import make_folder
from ._progress import PointReporter

if TYPE_CHECKING:
    from ..studies.folders import DiagnosedFolder, FolderSearch

#: the table within the output folder
TABLE = "table.csv"
_HEAD = ("folder", "verdict", "missing", "error before", "error after")


def diagnose_all(options: argparse.Namespace) -> int:
    """Diagnose every folder, print and write the table; returns 2 if one was not diagnosed."""
    if options.output is None:
        raise ExperimentError(f"{len(options.folder)} folders: expected --output DIR beside them")
    for name in ("json", "predictions", "figure", "report"):
        if getattr(options, name) is not None:
            raise ExperimentError(
                f"--{name}: is for one folder, found it with --output: every answer goes there, "
                "and `teleopdesign report ANSWER` makes its page"
            )
    if options.simulate:
        raise ExperimentError("--simulate: is for one folder, found it with --output")
    for folder in options.folder:
        if not folder.is_dir():
            raise ExperimentError(f"{folder}: no such folder")
    search = _search(options)
    output = make_folder(options.output)
    from ..studies.folders import diagnose_folders

    reporter = PointReporter()
    try:
        rows = diagnose_folders(
            options.folder, output, search=search, workers=options.workers, progress=reporter
        )
    except KeyboardInterrupt:
        reporter.clear()
        print(
            f"teleopdesign: stopped; {reporter.describe_finished()} kept in {output}, "
            "the same command continues from there",
            file=sys.stderr,
        )
        return STOPPED
    reporter.clear()
    print("\n".join(table_lines(rows)))
    write_text(output / TABLE, table_csv(rows))
    failed = sum(bool(row.failure) for row in rows)
    print(f"\n{len(rows) - failed} of {len(rows)} folders diagnosed; answers and {TABLE}: {output}")
    return BAD_INPUT if failed else 0


def _search(options: argparse.Namespace) -> FolderSearch:
    from ..studies.folders import FolderSearch

    known = effects_by_name(options)
    among = candidate_effects(known, options.only, options.exclude)
    return FolderSearch(dict(known), among, options.quick)


def table_lines(rows: Sequence[DiagnosedFolder]) -> list[str]:
    """The table for a terminal: a line for each folder, in the order of the command line."""
    cells = [_HEAD, *(_cells(row) for row in rows if not row.failure)]
    widths = [max(len(line[k]) for line in cells) for k in range(len(_HEAD))]
    widths[0] = max(widths[0], *(len(str(row.folder)) for row in rows))
    lines = [_line(_HEAD, widths)]
    for row in rows:
        if row.failure:
            lines.append(f"{str(row.folder):<{widths[0]}}  failed: {row.failure}")
        else:
            lines.append(_line(_cells(row), widths))
    return lines


def _cells(row: DiagnosedFolder) -> tuple[str, ...]:
    return (
        str(row.folder),
        row.verdict,
        row.missing or "-",
        percent(row.before, unknown="not told"),
        percent(row.after, unknown="not told"),
    )


def _line(cells: Sequence[str], widths: Sequence[int]) -> str:
    words = [f"{cell:<{width}}" for cell, width in zip(cells[:3], widths, strict=False)]
    numbers = [f"{cell:>{width}}" for cell, width in zip(cells[3:], widths[3:], strict=True)]
    return "  ".join([*words, *numbers])


def table_csv(rows: Sequence[DiagnosedFolder]) -> str:
    """The table as CSV for a spreadsheet; errors are fractions of the measured force."""
    text = StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow(
        ["folder", "answer", "verdict", "missing", "error_before", "error_after", "failure"]
    )
    for row in rows:
        numbers = ["" if not math.isfinite(x) else f"{x:.6g}" for x in (row.before, row.after)]
        answer = "" if row.failure else row.answer.name
        words = [str(row.folder), answer, row.verdict, row.missing]
        out.writerow([*map(harmless_cell, words), *numbers, harmless_cell(row.failure)])
    return text.getvalue()
