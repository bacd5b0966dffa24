"""The [[records]] of an experiment.toml, checked before any file is read."""

from __future__ import annotations

from pathlib import Path

from ..base.errors import ExperimentError, did_you_mean, quote
from ..base.files import follow_links
from ..base.toml import Table, describe_toml_value
from .doors.bag import is_bag
from .record import SEPARATE
from .tables import EXPERIMENT, tables_in


def record_entries(
    experiment: Table, folder: Path
) -> list[tuple[str, str, frozenset[str], tuple[float, ...] | None]]:
    """(file, use, separate offsets, span) of each [[records]], checked before any file is read."""
    entries: list[tuple[str, str, frozenset[str], tuple[float, ...] | None]] = []
    for table in experiment.tables("records"):
        table.allow(("file", "use", "span", *SEPARATE))
        file, span = table.text("file"), _span(table)
        _check_path(table, folder, file)
        for other, _, _, other_span in entries:
            if file == other and (span is None or other_span is None or _overlap(span, other_span)):
                what = (
                    "is listed twice" if span == other_span else "is listed with spans that overlap"
                )
                raise ExperimentError(f"{table.where('file')}: {quote(file)} {what}")
        use = choice_of(table, "use", ("fit", "check"))
        separate = {
            name
            for name in SEPARATE
            if choice_of(table, name, ("common", "own"), "common") == "own"
        }
        entries.append((file, use, frozenset(separate), span))
    if not any(use == "fit" for _, use, _, _ in entries):
        raise ExperimentError(
            f'{experiment.where("records")}: found {len(entries)} records, none with use = "fit", '
            "expected at least one"
        )
    return entries


def _span(table: Table) -> tuple[float, ...] | None:
    """Read [begin, end] in s from the first row of the log; None: the whole file."""
    if "span" not in table.content:
        return None
    span = table.content["span"]
    numbers = isinstance(span, list) and all(
        isinstance(v, int | float) and not isinstance(v, bool) for v in span
    )
    if not numbers or len(span) != 2 or not 0 <= span[0] < span[1] < 1e9:
        raise ExperimentError(
            f"{table.where('span')}: found {describe_toml_value(span)}, "
            "expected [begin, end] in s, from the "
            "log's first row"
        )
    return (float(span[0]), float(span[1]))


def _overlap(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return max(one[0], other[0]) < min(one[1], other[1])


def choice_of(table: Table, key: str, choices: tuple[str, ...], default: str | None = None) -> str:
    """The text under a key, one of these; raises ExperimentError: it is none."""
    value = table.text(key, default)
    if value not in choices:
        listed = " or ".join(quote(choice) for choice in choices)
        raise ExperimentError(
            f"{table.where(key)}: found {quote(value)}, "
            f"expected {listed}{did_you_mean(value, choices)}"
        )
    return value


def _check_path(table: Table, folder: Path, file: str) -> None:
    where = table.where("file")
    try:
        path = follow_links(folder / file)
        inside = path.is_relative_to(folder)
        exists = path.is_file() or is_bag(path) or path.is_dir() and bool(tables_in(path))
    except (OSError, ValueError) as problem:
        reason = getattr(problem, "strerror", None) or str(problem)
        raise ExperimentError(f"{where}: {quote(file)} cannot be read: {reason}") from None
    if not inside:
        raise ExperimentError(
            f"{where}: found {quote(file)}, expected a file inside {folder.name}/"
        )
    if not exists:
        names = sorted(str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file())
        others = [name for name in names if name != EXPERIMENT]
        listed = ", ".join(others[:10]) + (", ..." if len(others) > 10 else "")
        raise ExperimentError(
            f"{where}: no file {quote(file)}, found {listed or 'none'}{did_you_mean(file, others)}"
        )
