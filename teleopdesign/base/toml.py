"""TOML: tables that are read strictly, and text for all functions that write a file.

An unknown, missing or wrongly typed key is an error.
"""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

from .errors import ExperimentError, did_you_mean, printable, quote
from .files import read_whole


@final
@dataclass(frozen=True)
class Table:
    """One table.

    content: its keys and values;  file: its name in messages ("rod/experiment.toml")
    key: the dotted key of the table; "" for the whole file
    """

    content: Mapping[str, Any]
    file: str
    key: str = ""

    def where(self, key: str = "") -> str:
        """Beginning of a message about `key` of this table, or about the table itself."""
        path = ".".join(part for part in (self.key, key) if part)
        return f"{self.file}: {path}" if path else self.file

    def allow(self, known: Iterable[str]) -> None:
        """Refuse every key that is not in `known`."""
        known = tuple(known)
        for key in self.content:
            if key not in known:
                listed = ", ".join(known)
                raise ExperimentError(
                    f"{self.where()}: unknown key {quote(key)}, "
                    f"expected {listed}{did_you_mean(key, known)}"
                )

    def table(self, key: str) -> Table:
        """The table under `key`; an empty one if the key is absent.

        raises ExperimentError: no table
        """
        value = self.content.get(key, {})
        if not isinstance(value, dict):
            raise self.error(key, "a table")
        return Table(value, self.file, ".".join(part for part in (self.key, key) if part))

    def tables(self, key: str) -> tuple[Table, ...]:
        """The tables of the array `[[key]]`, each with its number (from 1) in its key."""
        value = self.content.get(key, [])
        if not isinstance(value, list) or not all(isinstance(row, dict) for row in value):
            raise self.error(key, f"tables written as [[{key}]]")
        path = f"{self.key}.{key}" if self.key else key
        return tuple(Table(row, self.file, f"{path}[{i}]") for i, row in enumerate(value, start=1))

    def text(self, key: str, default: str | None = None) -> str:
        """The text under `key`, which must not be empty; without a default it is required."""
        if key not in self.content and default is not None:
            return default
        value = self._require(key, "a text in quotes")
        if not isinstance(value, str) or not value.strip():
            raise self.error(key, "a text in quotes")
        return value

    def choice(self, key: str, known: Iterable[str], default: str | None = None) -> str:
        """The text under `key`, one of those in `known`; required without a default."""
        value, known = self.text(key, default), tuple(known)
        if value not in known:
            raise ExperimentError(
                f"{self.where(key)}: found {quote(value)}, expected {', '.join(known)}"
                f"{did_you_mean(value, known)}"
            )
        return value

    def flag(self, key: str, default: bool) -> bool:
        """The boolean (true or false) under `key`; `default` if the key is absent."""
        value = self.content.get(key, default)
        if not isinstance(value, bool):
            raise self.error(key, "true or false")
        return value

    def number(self, key: str, *, above: float = -math.inf) -> float:
        """The finite number under `key`, above `above`; raises ExperimentError: anything else."""
        value = self._require(key, "a number")
        return self._check_number(value, key, above)

    def number_or_none(self, key: str, *, above: float = -math.inf) -> float | None:
        """As `number`, None if the key is absent."""
        return self.number(key, above=above) if key in self.content else None

    def numbers(self, key: str, count: int, default: Sequence[float] = ()) -> list[float]:
        """The list of so many finite numbers under `key`; `default` if the key is absent."""
        value = self.content.get(key, [*default])
        listed = value if isinstance(value, list) else []
        numbers = [v for v in listed if isinstance(v, int | float) and not isinstance(v, bool)]
        if len(listed) != count or len(numbers) != count or not all(map(math.isfinite, numbers)):
            raise self.error(key, f"{count} finite numbers")
        return [float(number) for number in numbers]

    def _require(self, key: str, kind: str) -> Any:
        if key not in self.content:
            hint = did_you_mean(key, self.content).replace("did you mean", "is it written as")
            raise ExperimentError(f"{self.where()}: no key {quote(key)}, expected {kind}{hint}")
        return self.content[key]

    def _check_number(self, value: object, key: str, above: float) -> float:
        wanted = "a finite number" if above == -math.inf else f"a finite number above {above:g}"
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.error(key, "a number")
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number) or number <= above:
            raise ExperimentError(f"{self.where(key)}: found {number:g}, expected {wanted}")
        return number

    def error(self, key: str, expected: str, observed: str | None = None) -> ExperimentError:
        """The error for a value that is something else than what is expected.

        observed: the value in words; None: as `describe_toml_value` names it
        """
        observed = describe_toml_value(self.content.get(key)) if observed is None else observed
        return ExperimentError(f"{self.where(key)}: found {observed}, expected {expected}")


def describe_toml_value(value: object) -> str:
    """A TOML value as messages name it."""
    if isinstance(value, str):
        return quote(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list):
        return "a list"
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, int):
        return "a whole number"
    return f"a {type(value).__name__}"


#: words of a dotted key, text in quotes left out: the time that the reader takes grows with their
#: square, and an experiment has three
_LONG_KEY = re.compile(r"(?:(?<![\w-])[\w-]++|\"\")(?:\s*+\.\s*+(?:[\w-]++|\"\")){99}")
#: text in quotes; what a backslash makes no quote, so that an open one is looked for once
_QUOTED = re.compile(r"\\.|\"(?:[^\"\\\n]|\\.)*+\"|'[^'\n]*+'")


def _without_text(line: str) -> str:
    """The line, with all quoted texts emptied."""
    return _QUOTED.sub(lambda m: m[0] if m[0][0] == "\\" else '""', line)


def parse_toml(text: str) -> dict[str, Any]:
    """The content of a TOML text; raises ValueError: not TOML, or a key of 100 words."""
    for number, line in enumerate(text.splitlines(), start=1):
        if line.count(".") >= 99 and _LONG_KEY.search(_without_text(line)):
            raise ValueError(f"a key of 100 words or more (at line {number})")
    return tomllib.loads(text)


def read_toml(path: Path, file: str) -> Table:
    """The whole file as a table.

    file: its name in messages
    raises ExperimentError: unreadable, not UTF-8, or not TOML (with the line number)
    """
    try:
        return Table(parse_toml(read_whole(path).decode("utf-8-sig")), file)
    except OSError as problem:
        raise ExperimentError(f"{file}: cannot be read: {problem.strerror}") from None
    except UnicodeDecodeError as problem:
        raise ExperimentError(f"{file}: not UTF-8 text (byte {problem.start})") from None
    except RecursionError:
        raise ExperimentError(f"{file}: brackets nested too deeply") from None
    except ValueError as problem:  # TOMLDecodeError, and numbers too long to convert
        raise ExperimentError(f"{file}: not valid TOML: {problem}") from None


def texts_in(content: Any) -> Iterator[str]:
    """Every text in plain data, apart from the empty ones and what no file can be called."""
    if isinstance(content, str) and content and "\0" not in content:
        yield content
    elif isinstance(content, dict | list):
        for one in content.values() if isinstance(content, dict) else content:
            yield from texts_in(one)


def string_text(text: str) -> str:
    """A basic string of TOML: as in JSON, with one more control character escaped."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def key_text(name: str) -> str:
    """A key of TOML: bare where TOML allows it, else in quotes."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else string_text(name)


def comment_text(text: str) -> str:
    """A TOML comment on one line; control characters, which TOML forbids there, are escaped."""
    return f"# {printable(text, keep=chr(9))}".rstrip()


def inline_text(entries: Mapping[str, str]) -> str:
    """An inline table; keys and values are TOML text already."""
    inside = ", ".join(f"{key} = {value}" for key, value in entries.items())
    return f"{{ {inside} }}" if inside else "{}"


def toml_text(value: Any) -> str:
    """A text, a truth value, a number, a list or a table of such values, on one line."""
    if isinstance(value, Mapping):
        return inline_text({name: toml_text(inner) for name, inner in value.items()})
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return string_text(value)
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(toml_text, value)) + "]"
    return repr(value)
