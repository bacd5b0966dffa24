"""Corrections of a log: each step, its rule, and its effect on the answer."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

#: characters of a line
WIDTH = 100
#: the end of the name of a record that is a part of a log: "log.csv 0-14.4 s"
_SPAN = re.compile(r" [-+.\de]+-[-+.\de]+ s$")


@dataclass(frozen=True)
class ReadingStep:
    """One correction that was made when a file was read.

    file: of the record;  observed: what the log held ("14 lost rows, 0.2 %")
    rule: the correction;  effect: on the answer, with a number if there is one
    size: part of the measured force that the correction may add to the force error; NaN: unknown
    topic: of the finding that reports the step;  numbers: name -> value in SI
    interpolates: the values then lie between the steps of an encoder
    channel: that has stamps of its own, with its "rate" (Hz) in `numbers`; "" for other steps
    """

    file: str
    observed: str
    rule: str
    effect: str
    size: float = float("nan")
    topic: str = "reading"
    numbers: tuple[tuple[str, float], ...] = ()
    interpolates: bool = False
    channel: str = ""


def log_name(file: str) -> str:
    """The name of the log from which a record was cut; the name of the record if it is uncut."""
    return _SPAN.sub("", file)


def reading_lines(steps: Sequence[ReadingStep]) -> list[str]:
    """The steps as lines of text; empty where every file is used unchanged.

    Records that are all cut from one log are named by their spans.
    """
    logs = {log_name(s.file) for s in steps}
    log = f"{logs.pop()} " if len(logs) == 1 else ""
    alike: dict[str, list[str]] = {}
    for s in steps:
        effect = "" if s.effect == "none" else f"; {s.effect}"
        text = f"{s.observed}: {s.rule}{effect}"
        alike.setdefault(text, []).append(s.file.removeprefix(log))
    return [
        line
        for text, files in alike.items()
        for line in textwrap.wrap(
            f"{', '.join(files)}: {text}", WIDTH, initial_indent="  ", subsequent_indent="    "
        )
    ]


def count_of(number: int, one: str) -> str:
    """A number with its noun: "1 row", "12 rows"."""
    return f"{number} {one}" if number == 1 else f"{number} {one}s"


def reading_data(steps: Iterable[ReadingStep]) -> list[dict[str, Any]]:
    """The steps as plain data."""
    return [
        {
            "record": s.file,
            "observed": s.observed,
            "rule": s.rule,
            "effect": s.effect,
            "force_error": s.size if math.isfinite(s.size) else None,
        }
        for s in steps
    ]
