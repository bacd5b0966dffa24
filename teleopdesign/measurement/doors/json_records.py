"""JSON: one record per line, a list of records, or a list of numbers for each column.

Nested keys become columns such as "joint.pos". The numbers of a list become "q(1)", "q(2)", or
"elbow.q" where the record names its joints in a list `name`. Several lists of records with the same
columns are several recordings.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import ExperimentError, quote
from ._dialect import open_bytes
from ._log import DEPTH, MOST_BYTES, MOST_FIELDS, Log, join_names, refuse_size
from ._stray_lines import FEW_STRAYS, MOST_STRAYS
from .shapes._table import MOST_ROWS


def open_json(path: Path, file: str) -> Log:
    """Open a JSON file; raises ExperimentError: no JSON, or JSON without records."""
    with open_bytes(path) as stream:
        raw = stream.read(MOST_BYTES + 1)
    if len(raw) > MOST_BYTES:
        raise ExperimentError(f"{file}: found over {MOST_BYTES:.2g} bytes of text")
    text = raw.decode("utf-8-sig", errors="replace")
    strays = 0
    try:
        try:
            content = json.loads(text)
        except ValueError:
            content, strays = _records_of_lines(text, file)
    except RecursionError:
        raise ExperimentError(f"{file}: found JSON that is nested too deep") from None
    columns, trials = _columns(content if isinstance(content, list | dict) else [])
    if len(trials) > 1:
        named = join_names(map(quote, trials), most=4)
        raise ExperimentError(
            f"{file}: found the same columns in {named}, expected one recording: save each as a "
            "file of its own, and give them together"
        )
    if not columns:
        raise ExperimentError(
            f"{file}: found JSON without records, expected one record a line, a list of records, "
            'or a list of numbers for each column: {"t": [...], "q": [...]}'
        )
    refuse_size(max(map(len, columns.values())), file)
    lines = "a line that is no record" if strays == 1 else f"{strays} lines that are no records"
    notes: tuple[str, ...] = (f"{lines}: left out",) if strays else ()

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        return {name: np.array(columns[name], dtype=object) for name in wanted}

    sample = {n: np.array(c[:MOST_ROWS], dtype=object) for n, c in columns.items()}
    return Log(tuple(columns), read, notes=notes, sample=sample)


def _records_of_lines(text: str, file: str) -> tuple[list[Any], int]:
    """The records of a file with one record per line, and the number of other lines."""
    records, strays = [], 0
    lines = [line for line in text.splitlines() if line.strip()]
    for row, line in enumerate(lines, start=1):
        try:
            record = json.loads(line.strip().rstrip(","))
        except ValueError as problem:
            strays += 1
            if strays > max(FEW_STRAYS, MOST_STRAYS * row) or strays == len(lines):
                raise ExperimentError(f"{file}: line {row}: no JSON: {problem}") from None
            continue
        records.append(record)
    return records, strays


def _columns(content: list[Any] | dict[str, Any]) -> tuple[dict[str, list[Any]], list[str]]:
    """Columns of the longest list of records, None where a record lacks a key, or of lists.

    returns: the columns, and the names of all tables that have them
    """
    if isinstance(content, list):
        content = {"record": content}
    lists = _lists("", content, 0)
    tables: dict[str, dict[str, list[Any]]] = {}
    for name, records in content.items():
        if isinstance(records, list) and records:
            tables |= _tables(name, records)
    # beside a table, short lists such as limits are settings
    if not tables or lists and _rows(lists) >= max(map(_rows, tables.values())):
        return lists, []
    longest = max(tables, key=lambda name: _rows(tables[name]))
    columns = tables[longest]
    return columns, [n for n, t in tables.items() if _rows(t) > 1 and list(t) == list(columns)]


def _tables(name: str, records: list[Any]) -> dict[str, dict[str, list[Any]]]:
    """The table of a list of records, or one of each record that holds lists of numbers.

    The lists of a robot's joints are shorter than its log, and one long list is none of columns.
    """
    held = [_lists("", r, 0) if isinstance(r, dict) else {} for r in records]
    longest = [[len(v) for v in t.values()].count(_rows(t)) for t in held]
    if all(_rows(t) > len(records) and n > 1 for t, n in zip(held, longest, strict=True)):
        whole = [{n: v for n, v in t.items() if len(v) == _rows(t)} for t in held]
        return {f"{name}({k})": t for k, t in enumerate(whole, start=1)}
    return {name: _columns_of_records(records)}


def _rows(table: Mapping[str, list[Any]]) -> int:
    """Number of rows of a table; 0 for one without columns."""
    return max(map(len, table.values()), default=0)


def _columns_of_records(content: list[Any]) -> dict[str, list[Any]]:
    """Columns of a list of records, None where a record lacks a key."""
    columns: dict[str, list[Any]] = {}
    for row, record in enumerate(content):
        add_row(columns, fields_of(record, lambda k: f"({k + 1})"), row, None)
    add_row(columns, ((name, None) for name in columns), len(content), None)
    return {name: column[:-1] for name, column in columns.items()}


def add_row(
    columns: dict[str, list[Any]], record: Iterable[tuple[str, Any]], row: int, empty: Any
) -> None:
    """Append the values of a record to their columns;  empty: in rows before, without a value."""
    for name, value in record:
        column = columns.setdefault(name, [])
        column += [empty] * (row - len(column))
        column.append(value)


def _lists(name: str, value: Any, depth: int) -> dict[str, list[Any]]:
    """Columns of a record of lists, {"t": [...], "joint": {"q": [...]}}."""
    if isinstance(value, dict) and depth < DEPTH:
        out: dict[str, list[Any]] = {}
        for key, inner in value.items():
            out |= _lists(f"{name}.{key}" if name else key, inner, depth + 1)
        return out
    plain = isinstance(value, list) and len(value) > 1
    return {name: value} if plain and not any(isinstance(v, list | dict) for v in value) else {}


def fields_of(
    value: Any,
    number: Callable[[int], str],
    name: str = "",
    *,
    joints: Sequence[str] = (),
    begin: int = 0,
    depth: int = 0,
) -> Iterator[tuple[str, Any]]:
    """The numbers and texts of one record, by name: of a dict, or of a message.

    number: name of an element of a list, by its index from 0
    joints: names of joints in the record around this one;  begin: index in `name` behind its name
    """
    entries = _entries(value)
    if entries is not None and depth < DEPTH:
        named = entries.get("name")
        if isinstance(named, list | tuple) and all(isinstance(n, str) for n in named):
            joints, begin = named, len(name) + bool(name)
            entries = {key: inner for key, inner in entries.items() if key != "name"}
        for key, inner in entries.items():
            whole = f"{name}.{key}" if name else key
            yield from fields_of(inner, number, whole, joints=joints, begin=begin, depth=depth + 1)
    elif isinstance(value, list | tuple | np.ndarray):
        if len(value) > MOST_FIELDS or depth >= DEPTH:
            return
        for k, item in enumerate(value):
            of_joint = len(value) == len(joints)
            whole = f"{name[:begin]}{joints[k]}.{name[begin:]}" if of_joint else name + number(k)
            yield from fields_of(item, number, whole, depth=depth + 1)
    elif entries is None:
        yield name or "value", value


def _entries(value: Any) -> dict[str, Any] | None:
    """The entries of a dict, or of a message without its header; None: the value is no record."""
    if isinstance(value, dict):
        return value
    if not is_dataclass(value):
        return None
    names = (f.name for f in fields(value) if not f.name.startswith("__"))
    return {name: getattr(value, name) for name in names if name not in ("header", "layout")}
