"""Keys, types and ranges of an answer file, checked with a message in one line.

Unknown keys are allowed: a later version may write more. `models`, `experiment`, `floor` and `open`
were added later: an older answer has none of them.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NoReturn

from ...base.errors import ExperimentError, quote
from ...base.files import read_whole
from ...base.toml import describe_toml_value

#: a check of a value; the text says where the value stands, for the message
Check = Callable[[object, str], None]

VERDICTS = ("effects_missing", "model_adequate", "undecided")
WRITER = "`teleopdesign diagnose --json`"


def read_content(path: str | Path) -> dict[str, Any]:
    """The checked content of an answer file.

    raises ExperimentError: the file cannot be read, is no JSON, or is no answer
    """
    try:
        content = json.loads(read_whole(path).decode("utf-8-sig"), parse_constant=_constant)
    except OSError as error:
        raise ExperimentError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise ExperimentError(f"{path}: not UTF-8 text (byte {error.start})") from None
    except json.JSONDecodeError as error:
        raise ExperimentError(f"{path}: line {error.lineno}: no JSON: {error.msg}") from None
    except RecursionError:
        raise ExperimentError(f"{path}: brackets nested too deeply") from None
    except ValueError as error:  # a number too long to convert, NaN, a null character in the path
        raise ExperimentError(f"{path}: no JSON: {error}") from None
    try:
        check_answer(content)
    except ExperimentError as error:
        raise ExperimentError(f"{path}: {error}") from None
    answer: dict[str, Any] = content
    return answer


def check_answer(content: object) -> None:
    """Refuse content that is no answer.

    raises ExperimentError: with the wrong key in front
    """
    if not isinstance(content, dict):
        raise ExperimentError(f"found {_describe_value(content)}, expected an answer of {WRITER}")
    if lacking := [key for key in _REQUIRED if key not in content]:
        raise ExperimentError(f"no key {quote(lacking[0])}, expected an answer of {WRITER}")
    for key, check in (_REQUIRED | _LATER).items():
        if key in content:
            check(content[key], key)
    for joint, one in content.get("joints", {}).items():
        if "models" in one:  # an older answer says less of a joint
            try:
                check_answer({n: entry for n, entry in one.items() if n != "joints"})
            except ExperimentError as error:
                raise ExperimentError(f"joints.{joint}: {error}") from None


def _constant(name: str) -> NoReturn:
    raise ValueError(f"found {name}, expected a finite number or null")


def _describe_value(value: object) -> str:
    return "null" if value is None else describe_toml_value(value)


def _wrong(where: str, value: object, expected: str) -> ExperimentError:
    return ExperimentError(f"{where}: found {_describe_value(value)}, expected {expected}")


def _number(*, low: float = -math.inf, null: bool = False) -> Check:
    expected = "a finite number" if low == -math.inf else f"a finite number, {low:g} or more"

    def check(value: object, where: str) -> None:
        if null and value is None:
            return
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise _wrong(where, value, f"{expected} or null" if null else expected)
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not (math.isfinite(number) and number >= low):
            raise ExperimentError(f"{where}: found {number:g}, expected {expected}")

    return check


def _text(value: object, where: str) -> None:
    if not isinstance(value, str):
        raise _wrong(where, value, "a text in quotes")


def _flag(value: object, where: str) -> None:
    if not isinstance(value, bool):
        raise _wrong(where, value, "true or false")


def _one_of(*known: str) -> Check:
    def check(value: object, where: str) -> None:
        if not isinstance(value, str) or value not in known:
            raise _wrong(where, value, " or ".join(map(quote, known)))

    return check


def _or_null(inside: Check) -> Check:
    def check(value: object, where: str) -> None:
        if value is not None:
            inside(value, where)

    return check


def _list_of(inside: Check, *, least: int = 0) -> Check:
    def check(value: object, where: str) -> None:
        if not isinstance(value, list):
            raise _wrong(where, value, "a list")
        if len(value) < least:
            raise ExperimentError(f"{where}: found {len(value)} entries, expected {least} or more")
        for i, one in enumerate(value, start=1):
            inside(one, f"{where}[{i}]")

    return check


def _table_of(inside: Check) -> Check:
    """A check of a table with any names, each with a value that passes the same check."""

    def check(value: object, where: str) -> None:
        if not isinstance(value, dict):
            raise _wrong(where, value, "a table")
        for key, one in value.items():
            inside(one, f"{where}.{key}")

    return check


def _table(required: Mapping[str, Check], optional: Mapping[str, Check] | None = None) -> Check:
    """A check of a table with these names; other names are allowed."""

    def check(value: object, where: str) -> None:
        if not isinstance(value, dict):
            raise _wrong(where, value, "a table")
        if lacking := [key for key in required if key not in value]:
            raise ExperimentError(f"{where}: no key {quote(lacking[0])}")
        for key, one in {**required, **(optional or {})}.items():
            if key in value:
                one(value[key], f"{where}.{key}")

    return check


_PLACE = _table({"effect": _text, "at": _text})
_SIZE = _number(low=0.0)
#: null where there is no such record
_ERROR = _number(low=0.0, null=True)
_PARAMETER = _table(
    {"value": _number(null=True), "stderr": _number(low=0.0, null=True), "unit": _text}
)


def _bodies(value: object, where: str) -> None:
    """Check bodies of a model, and base parameters of an arm; `model_from` checks the details."""
    _table({}, {"links": _list_of(_number())})(value, where)
    assert isinstance(value, dict)
    _table_of(_table({}))({n: body for n, body in value.items() if n != "links"}, where)


_REQUIRED: dict[str, Check] = {
    "verdict": _one_of(*VERDICTS),
    "missing": _list_of(_table({"effect": _text, "at": _text}, {"instead_of": _text})),
    "ladder": _list_of(
        _table(
            {"added": _or_null(_PLACE), "fit_error": _ERROR, "check_error": _ERROR},
            {"instead_of": _or_null(_text), "could_be": _or_null(_list_of(_PLACE))},
        ),
        least=1,
    ),
    "noise_floor": _SIZE,
    "candidates": _list_of(
        _table(
            {
                "effect": _text,
                "at": _text,
                "probability": _SIZE,
                "check_error": _ERROR,
                "parameters": _table_of(_PARAMETER),
            }
        )
    ),
    "indistinguishable": _list_of(_list_of(_PLACE, least=2)),
    "model_parameters": _table_of(_PARAMETER),
}
_LATER: dict[str, Check] = {
    "noise_floor_source": _text,
    "check": _one_of("records", "blocks of fit"),
    "bandwidth": _table({"value": _number(low=1e-9)}),
    "own": _list_of(_table({"record": _text, "at": _text})),
    "left_over_noise_floors": _number(low=0.0, null=True),
    "one_moment": _or_null(
        _table(
            {
                "record": _text,
                "at": _text,
                **dict.fromkeys(("begin", "end"), _table({"value": _number()})),
                "left_over_noise_floors_without": _SIZE,
            }
        )
    ),
    "on_all_records": _ERROR,
    "learnable": _ERROR,
    "black_box": _or_null(_table({"left": _SIZE, "alone": _SIZE, "where": _text})),
    "near_reversals": _or_null(_table({"check_error": _SIZE, "share": _SIZE})),
    "repeats": _or_null(
        _table(dict.fromkeys(("error", "left", "share", "squares", "chance"), _SIZE))
    ),
    "simulation": _table({"horizons": _list_of(_table({"use": _text, "at": _text}))}),
    "at_bound": _list_of(_text),
    "experiment": _table(
        {
            "title": _text,
            "axes": _table_of(_text),
            "records": _list_of(_table({"file": _text, "use": _text, "samples": _SIZE}), least=1),
            "digest": _text,
        },
        {"folder": _text},
    ),
    "models": _table({"ladder": _list_of(_bodies, least=1), "estimated": _bodies}),
    "joints": _table_of(_table({"verdict": _one_of(*VERDICTS)})),
    "left_out": _list_of(_text),
    "cannot_tell": _list_of(_table({"effect": _text, "at": _text, "sentence": _text})),
    "set_aside": _list_of(
        _table({"effect": _text, "at": _text, "check_error": _ERROR, "reason": _text})
    ),
    "friction_cells": _table_of(
        _list_of(
            _table(
                {
                    **dict.fromkeys(("low", "high", "direction"), _number()),
                    "samples": _SIZE,
                    "least": _number(null=True),
                }
            )
        )
    ),
    "floor": _table({"drawn": _SIZE, "held": _flag}),
    "open": _list_of(
        _table(
            {
                "added": _or_null(_PLACE),
                "others": _list_of(_table({"effect": _text, "at": _text, "model": _bodies})),
            }
        )
    ),
}
