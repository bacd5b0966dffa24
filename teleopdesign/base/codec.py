"""Frozen dataclasses as plain data for JSON, and such data as dataclasses again, with checks.

A field stands in the table of its dataclass under its own name, or where its annotation says. The
annotation also says what may stand there:

    probability: Size                                # a finite number, 0 or more
    check_error: Error                               # the same, or null for NaN
    drawn: Annotated[Size, At("floor.drawn")]        # under "drawn" in the table "floor"
    bandwidth: Annotated[float, InUnit("Hz")]          # {"value": 60, "unit": "Hz"}
    steps: Annotated[tuple[Step, ...], Filled(1)]    # a list with an entry or more
    candidate: Annotated[Candidate, INLINE]          # its entries stand in the table itself
    left_out: Annotated[tuple[str, ...], OMIT] = ()  # not written where it is empty
    source: Annotated[Source, NEVER] = NOWHERE       # no part of the data

Keys that no field has are allowed, since a later version may write more. A key may be missing where
its field has a default. A dataclass may list properties that are written and never read back:
`ALSO_WRITTEN`, key -> name of the property.
"""

from __future__ import annotations

import dataclasses
import math
import types
from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, is_dataclass
from enum import Enum
from functools import cache
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin, get_type_hints

from .errors import ExperimentError, quote
from .files import make_plain
from .toml import describe_toml_value


@dataclass(frozen=True)
class Bounds:
    """Range of a number: at least `low`; null: whether null is allowed, which stands for NaN."""

    low: float = -math.inf
    null: bool = True


@dataclass(frozen=True)
class InUnit:
    """Unit of a quantity, which is written as a table with its value and unit."""

    name: str


@dataclass(frozen=True)
class Filled:
    """Fewest entries of a list."""

    least: int


@dataclass(frozen=True)
class At:
    """Place of a field in the table of its dataclass: a key, or a path "table.key"."""

    key: str


class Mark(Enum):
    """What else an annotation may say of a field: see the beginning of this file."""

    INLINE = "inline"
    OMIT = "omit"
    NEVER = "never"


INLINE, OMIT, NEVER = Mark.INLINE, Mark.OMIT, Mark.NEVER
Number = Annotated[float, Bounds(null=False)]
Size = Annotated[float, Bounds(0.0, null=False)]
Error = Annotated[float, Bounds(0.0)]


class DataForm(NamedTuple):
    """How objects of one class stand in the data.

    write: object -> plain data;  read: plain data, its place in the file -> object
    """

    write: Callable[[Any], Any]
    read: Callable[[Any, str], Any]


DataForms = Mapping[type, DataForm]


class _Place(NamedTuple):
    name: str
    kind: Any
    path: tuple[str, ...]
    inline: bool
    omit: bool
    required: bool


@cache
def _places(kind: Any) -> tuple[_Place, ...]:
    hints, places = get_type_hints(kind, include_extras=True), []
    for f in dataclasses.fields(kind):
        notes = _annotations(hints[f.name])
        if NEVER in notes or not f.init:
            continue
        key = next((note.key for note in notes if isinstance(note, At)), f.name)
        required = f.default is MISSING and f.default_factory is MISSING
        path = tuple(key.split("."))
        inline, omit = INLINE in notes, OMIT in notes
        places.append(_Place(f.name, hints[f.name], path, inline, omit, required))
    return tuple(places)


def to_data(value: Any, forms: DataForms) -> Any:
    """The value as plain data; forms: of classes that are no dataclass of this kind."""
    if type(value) in forms:
        return forms[type(value)].write(value)
    if is_dataclass(value) and not isinstance(value, type):
        return _write_table(value, forms)
    if isinstance(value, Mapping):
        return {str(name): to_data(one, forms) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [to_data(one, forms) for one in value]
    return make_plain(value)


def _write_table(value: Any, forms: DataForms) -> dict[str, Any]:
    table: dict[str, Any] = {}
    for place in _places(value.__class__):
        part = getattr(value, place.name)
        if place.omit and (part is None or part == () or part == {} or part is False):
            continue
        if not place.inline:
            data = to_data(part, forms)
            unit = next((a.name for a in _annotations(place.kind) if isinstance(a, InUnit)), None)
            _put(table, place.path, data if unit is None else {"value": data, "unit": unit})
        elif part is None:
            for one in _places(_class_of(place.kind)):
                table.setdefault(one.path[0], None)
        else:
            for key, data in to_data(part, forms).items():
                _put(table, (key,), data)
    for key, name in getattr(value, "ALSO_WRITTEN", {}).items():
        _put(table, tuple(key.split(".")), to_data(getattr(value, name), forms))
    return table


def _put(table: dict[str, Any], path: tuple[str, ...], data: Any) -> None:
    for key in path[:-1]:
        table = table.setdefault(key, {})
    if isinstance(data, dict) and isinstance(table.get(path[-1]), dict):
        table[path[-1]] |= data
    else:
        table[path[-1]] = data


def from_data(kind: Any, data: Any, where: str, forms: DataForms, *, whole: str = "") -> Any:
    """The object of a kind that the data describe.

    kind: a class or an annotation;  where: place of the data in the file, for messages
    whole: what the file should be, in words, for the message that a key of it is missing
    raises ExperimentError: wrong type, a number out of its range, or a missing key
    """
    origin, inner = get_origin(kind), get_args(kind)
    if kind is Any:
        return data
    if origin is Annotated:
        return _read_annotated(inner[0], inner[1:], data, where, forms)
    if kind in forms:
        return forms[kind].read(data, where)
    if origin in (Union, types.UnionType):
        if data is None:
            return None
        return from_data(_without_none(kind), data, where, forms)
    if origin is Literal:
        if data not in inner or not isinstance(data, str):
            raise _wrong(where, data, " or ".join(map(quote, inner)))
        return data
    if origin is tuple:
        if not isinstance(data, list):
            raise _wrong(where, data, "a list")
        each = (from_data(inner[0], x, f"{where}[{i}]", forms) for i, x in enumerate(data, 1))
        return tuple(each)
    if origin is Mapping or isinstance(origin, type) and issubclass(origin, Mapping):
        if not isinstance(data, dict):
            raise _wrong(where, data, "a table")
        return {n: from_data(inner[1], x, _place_below(where, n), forms) for n, x in data.items()}
    if is_dataclass(kind):
        return _read_table(kind, data, where, forms, whole)
    return _read_simple(kind, data, where)


def _read_annotated(
    kind: Any, notes: tuple[Any, ...], data: Any, where: str, forms: DataForms
) -> Any:
    for note in notes:
        if isinstance(note, InUnit):
            if not isinstance(data, dict):
                raise _wrong(where, data, "a table")
            if "value" not in data:
                raise ExperimentError(f'{where}: no key "value"')
            bounds = next((n for n in notes if isinstance(n, Bounds)), Bounds())
            return _read_number(data["value"], f"{where}.value", bounds)
        if isinstance(note, Bounds):
            return _read_number(data, where, note)
    value = from_data(kind, data, where, forms)
    for note in notes:
        if isinstance(note, Filled) and len(value) < note.least:
            raise ExperimentError(
                f"{where}: found {len(value)} entries, expected {note.least} or more"
            )
    return value


def _read_table(kind: Any, data: Any, where: str, forms: DataForms, whole: str) -> Any:
    if not isinstance(data, dict):
        raise _wrong(where, data, whole or "a table")
    values = {}
    for place in _places(kind):
        if place.inline:
            inside = _class_of(place.kind)
            there = inside in forms or _look_up(data, _places(inside)[0].path, where)[1] is not None
            if there or inside is _plain_kind(place.kind):
                values[place.name] = from_data(inside, data, where, forms, whole=whole)
            continue
        is_there, entry = _look_up(data, place.path, where)
        if is_there:
            below = _place_below(where, ".".join(place.path))
            values[place.name] = from_data(place.kind, entry, below, forms)
        elif place.required:
            expected = f", expected {whole}" if whole else ""
            begin = f"{where}: " if where else ""
            raise ExperimentError(f"{begin}no key {quote(place.path[-1])}{expected}")
    return kind(**values)


def _look_up(data: dict[str, Any], path: tuple[str, ...], where: str) -> tuple[bool, Any]:
    """Whether the data have an entry at a path, and the entry; None: they have none."""
    entry: Any = data
    for i, key in enumerate(path):
        if entry is None or key not in entry:
            return False, None
        entry = entry[key]
        if i + 1 < len(path) and not (entry is None or isinstance(entry, dict)):
            raise _wrong(_place_below(where, ".".join(path[: i + 1])), entry, "a table")
    return True, entry


def _read_simple(kind: Any, data: Any, where: str) -> Any:
    if kind is float:
        return _read_number(data, where, Bounds())
    if kind is int:
        if isinstance(data, bool) or not isinstance(data, int):
            raise _wrong(where, data, "a whole number")
        return data
    if not isinstance(data, kind):
        raise _wrong(where, data, {str: "a text in quotes", bool: "true or false"}[kind])
    return data


def _read_number(data: Any, where: str, bounds: Bounds) -> float:
    if data is None and bounds.null:
        return math.nan
    expected = "a finite number"
    expected += f", {bounds.low:g} or more" if bounds.low > -math.inf else ""
    if isinstance(data, bool) or not isinstance(data, int | float):
        raise _wrong(where, data, f"{expected} or null" if bounds.null else expected)
    try:
        number = float(data)
    except OverflowError:
        number = math.inf
    if not (math.isfinite(number) and number >= bounds.low):
        raise ExperimentError(f"{where}: found {number:g}, expected {expected}")
    return number


def _wrong(where: str, data: object, expected: str) -> ExperimentError:
    value = "null" if data is None else describe_toml_value(data)
    return ExperimentError(f"{where}: " * bool(where) + f"found {value}, expected {expected}")


def _place_below(where: str, key: str) -> str:
    return f"{where}.{key}" if where else key


def _annotations(kind: Any) -> tuple[Any, ...]:
    return get_args(kind)[1:] if get_origin(kind) is Annotated else ()


def _plain_kind(kind: Any) -> Any:
    """The annotation without its notes."""
    return get_args(kind)[0] if get_origin(kind) is Annotated else kind


def _without_none(kind: Any) -> Any:
    (one,) = (k for k in get_args(kind) if k is not types.NoneType)
    return one


def _class_of(kind: Any) -> Any:
    """The class of an annotation such as `Learnable | None`."""
    kind = _plain_kind(kind)
    return _without_none(kind) if get_origin(kind) in (Union, types.UnionType) else kind
