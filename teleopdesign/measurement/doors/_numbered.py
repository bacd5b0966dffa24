"""Names of columns in a list above a table: "% 1 time (s)", "# columns 2, 3: voltage [V]"."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ..column_names import unit_of_text

#: most letters of a name; the rest of a line tells more than a name
LONGEST = 40
#: numbers of the columns, and what the line says of them
_LINE = re.compile(
    r"(?:col(?:umn)?s?\.?\s*)?(\d{1,3}(?:[\s,-]+\d{1,3}(?=\s|[,:=)]))*)[\s:=).-]*(\D.*)", re.I
)
_IN_BRACKETS = re.compile(r"[\[(]([^\[\]()]{1,40})[\])]")


def names_by_number(
    lines: Sequence[str], width: int
) -> tuple[tuple[str, ...], tuple[str, ...]] | None:
    """Names and units of all columns from comments that number them; None: no such list.

    lines: the comments above the table, without their marks
    width: number of columns; the list begins at 1 (or 0) and leaves none of them out
    """
    listed: list[tuple[range, str]] = []
    for line in lines:
        match = _LINE.fullmatch(line.strip())
        if match is None:
            continue
        numbers = [int(n) for n in re.findall(r"\d+", match[1])]
        begin = listed[-1][0].stop if listed else numbers[0]
        if numbers[0] != begin or numbers != sorted(set(numbers)):
            continue
        listed.append((range(begin, numbers[-1] + 1), match[2]))
    if len(listed) < 2 or listed[0][0].start not in (0, 1):
        return None
    if listed[-1][0].stop - listed[0][0].start != width:
        return None
    named = [pair for columns, text in listed for pair in _names_of(text, len(columns))]
    return tuple(name for name, _ in named), tuple(unit for _, unit in named)


def _names_of(text: str, count: int) -> list[tuple[str, str]]:
    """Name and unit of each of some columns, of which one line tells."""
    text = text.partition(":")[0].strip()
    units, text = _units_of_all(text, count)
    parts = [part.strip() for part in text.split(",")]
    if count == 1:
        parts = parts[:1]
    if len(parts) != count or not all(parts):
        parts = [text] * count
    named = [_name_and_unit(*both) for both in zip(parts, units, strict=True)]
    first, _, last = named[0][0].rpartition(" ")
    if first and len(set(parts)) == count and all(" " not in name for name, _ in named[1:]):
        # "Pose x,y": the first word belongs to all
        words = (last, *(name for name, _ in named[1:]))
        named = [(f"{first} {word}", unit) for word, (_, unit) in zip(words, named, strict=True)]
    return named


def _units_of_all(text: str, count: int) -> tuple[list[str], str]:
    """A unit in brackets that stands for all columns, or a list with one for each; and the rest.

    A unit at the end of one of several parts is that of this part: "q [rad], u [V]".
    """
    for match in _IN_BRACKETS.finditer(text):
        units = [unit_of_text(part) or "" for part in match[1].split(",")]
        behind = text[match.end() :].strip()
        is_one = len(units) == 1 and bool(behind) and not behind.startswith(",")
        if all(units) and (len(units) == count or is_one):
            rest = f"{text[: match.start()].strip()} {behind}".strip()
            return units * (count if len(units) == 1 else 1), rest
    return [""] * count, text


def _name_and_unit(part: str, unit: str) -> tuple[str, str]:
    match = _IN_BRACKETS.search(part)
    at_end = unit_of_text(match[1]) if match is not None and part.endswith(match[0]) else None
    if at_end and match is not None and not unit:
        part, unit = part[: match.start()], at_end
    return " ".join(part.split())[:LONGEST], unit
