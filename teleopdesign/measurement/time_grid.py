"""The time axis of a record: from the stamps of a log to one sample time, in stretches.

Stamps on an even clock are used unchanged. If rows are missing, out of order or repeated, if the
log pauses, or if stamps are uneven, `clock_of` gives the place of each row: the file need not be
repaired. The position decides whether uneven stamps are the times of the samples, or only the times
of writing (`stamps_are_true`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ExperimentError
from .even_clock import even_clock
from .record_clock import Array, RecordClock, check_size
from .uneven_stamps import rows_in_order, sparse_clock

#: rms jitter, of a sample time, below which stamps are those of an even clock
EVEN = 0.01
#: s: larger stamps are a date (counted from the year 1970), and the time of the record starts at
#: its first stamp
DATE = 1e8


def clock_of(
    stamps: Array, segments: tuple[slice, ...], same_as_before: NDArray[np.bool_], where: str
) -> RecordClock:
    """The clock of a log.

    stamps: (n,) s, finite, as written;  segments: as labelled in the log
    same_as_before: (n,) the row equals the row before in every channel
    raises ExperimentError: fewer than 64 rows, less than 1 s, time that does not increase
    """
    count = len(stamps)
    check_size(count, where)
    if not np.any(np.diff(stamps) > 0) or stamps[-1] < stamps[0] and _mostly_back(stamps):
        raise ExperimentError(
            f"{where}: found time that does not increase, expected increasing time"
        )
    even = even_clock(stamps, segments, where)
    if even is not None:
        return even
    parts, dropped, moved, restarts = rows_in_order(stamps, segments, same_as_before)
    return sparse_clock(stamps, parts, (dropped, moved, restarts), where)


def _mostly_back(stamps: Array) -> bool:
    return float(np.mean(np.diff(stamps) < 0)) > 0.5


def stamps_are_true(clock: RecordClock, positions: Sequence[Array]) -> tuple[float, float]:
    """Whether a position follows uneven stamps (coefficient 1) or an even clock (coefficient 0).

    The deviation of a reading from its neighbours is regressed on the speed times the deviation of
    the stamp from the even clock. Both are second differences, which suppress a smooth motion.

    positions: (m,) each, of the clock's rows
    returns: the coefficient and its standard error; (1, inf) if the positions do not decide
    """
    above = below = 0.0
    pairs: list[tuple[Array, Array]] = []
    off = clock.stamps - clock.time[clock.places]
    for stretch in clock.of_rows:
        place = clock.places[stretch]
        if len(place) < 5:
            continue
        inner = (place[2:] - place[:-2] == 2)[1:-1]
        late = off[stretch] - off[stretch].mean()
        for x in positions:
            x = x[stretch]
            speed = np.zeros(len(x))
            speed[1:-1] = (x[2:] - x[:-2]) / (2.0 * clock.sample_time)
            bend = np.diff(x, 2)[1:-1][inner]
            made = np.diff(speed * late, 2)[1:-1][inner]
            scale = float(np.mean(bend**2))
            if scale > 0 and len(bend):
                above += float(made @ bend) / scale
                below += float(made @ made) / scale
                pairs.append((bend / math.sqrt(scale), made / math.sqrt(scale)))
    if below <= 0:
        return 1.0, math.inf
    slope = above / below
    left = sum(float(np.sum((b - slope * m) ** 2)) for b, m in pairs)
    number = sum(len(b) for b, _ in pairs)
    # neighbouring second differences share readings: six of them count as one
    return slope, math.sqrt(6.0 * left / max(number, 1) / below)
