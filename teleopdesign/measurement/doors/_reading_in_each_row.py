"""Text tables with one reading in each row, and a column that names its signal.

    elapsed time, receive time, topic, value        time, signal, value, unit
    0.000, ..., /joint_states.position[0], 0.10     0.000, angle,  0.10, rad
    0.004, ..., /joint_states.position[0], 0.11     0.001, torque, 1.50, Nm
    0.000, ..., /command.data, 1.5                  0.004, angle,  0.11, rad

Viewers of bags, data bases and decoders of a bus write such tables.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ._cells import number_of, seconds_of
from ._dialect import cells_of
from ._header import UNIT_LABELS, bare_unit
from ._lines_of_file import open_lines
from ._log import Log, refuse_size
from ._signals_in_turn import log_of_signals

#: last words of the names of the columns that name the signal, and that hold its readings
SIGNALS = frozenset("topic signal channel variable tag parameter series measurement".split())
READINGS = frozenset("value values reading wert valeur valor".split())
#: rows that are looked at, and most signals of a table: more texts are messages
ROWS, MOST_SIGNALS = 100, 1000


@dataclass(frozen=True)
class _Places:
    """Separator of such a table, places of its columns and unit of its time."""

    separator: str
    width: int
    time: int
    signal: int
    reading: int
    unit: int | None
    time_unit: str | None


def open_reading_in_each_row(
    path: Path, file: str, encoding: str, lines: Sequence[str]
) -> Log | None:
    """The log of such a table; None: any other table.

    lines: the first lines of the file
    """
    filled = [line for line in lines if line.strip()]
    tables = (_places(filled, separator) for separator in (",", ";", "\t"))
    places = next((table for table in tables if table is not None), None)
    if places is None:
        return None
    signals: dict[str, list[tuple[float, float]]] = {}
    units: dict[str, str] = {}
    with open_lines(path, encoding, errors="replace") as stream:
        for k, (time, signal, reading, unit) in enumerate(_rows(stream, places)):
            signals.setdefault(signal, []).append((time, reading))
            units.setdefault(signal, unit)
            if len(signals) > MOST_SIGNALS:
                return None
            refuse_size(k, file)
    stated = {signal: bare_unit(unit) for signal, unit in units.items() if unit}
    note = "a reading in each row"
    return log_of_signals(signals.items(), file, note, stated, places.time_unit)


def _places(lines: Sequence[str], separator: str) -> _Places | None:
    """Where the columns of such a table stand; None: it is another table."""
    from ..column_names import likeness, unit_in_name, words_of

    names = cells_of(lines[0], separator)
    ends = [(words_of(name) or [""])[-1] for name in names]
    signals = [k for k, word in enumerate(ends) if word in SIGNALS]
    readings = [k for k, word in enumerate(ends) if word in READINGS]
    times = [k for k, name in enumerate(names) if likeness(name, "time") > 0.0]
    if len(signals) != 1 or len(readings) != 1 or not times:
        return None
    units = [k for k, name in enumerate(names) if name.casefold() in UNIT_LABELS]
    first = cells_of(lines[min(1, len(lines) - 1)], separator)
    dated = len(first) > times[0] and seconds_of(first[times[0]]) is not None
    time_unit = "s" if dated else unit_in_name(names[times[0]], "time")
    places = _Places(
        separator, len(names), times[0], signals[0], readings[0], (*units, None)[0], time_unit
    )
    some = lines[1 : ROWS + 1]
    texts = [row[1] for row in _rows(some, places)]
    numbered = any(isinstance(number_of(text), float) for text in texts)
    return places if len(texts) > 0.5 * len(some) > 0 and not numbered else None


def _rows(lines: Iterable[str], places: _Places) -> Iterator[tuple[float, str, float, str]]:
    """Time, signal, reading and unit of each row with numbers; states and texts are left out."""
    for line in lines:
        cells = cells_of(line, places.separator)
        if len(cells) != places.width:
            continue
        stamp, text = cells[places.time], cells[places.reading]
        number, reading = (number_of(cell, comma="," in cell) for cell in (stamp, text))
        time = seconds_of(stamp) if isinstance(number, str) else number
        if time is None or math.isnan(time) or isinstance(reading, str):
            continue
        unit = "" if places.unit is None else cells[places.unit]
        yield time, cells[places.signal], reading, unit
