"""Whether the rows of a log were taken at their uneven stamps, or these are times of writing."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from .reading import ReadingStep
from .record_clock import EVEN, RecordClock
from .row_places import Array

#: standard errors from which the position decides whether the stamps are true
SURE = 3.0


def read_at_stamps(
    clock: RecordClock, positions: Sequence[Array], file: str
) -> tuple[bool, list[ReadingStep]]:
    """Whether each row was taken at its stamp, with the reading steps that report it.

    positions: (m,) each, of the clock's rows
    """
    h = clock.sample_time
    if clock.counted or clock.jitter <= EVEN * h:
        return False, []
    rule = "positions interpolated, commands held"
    if math.isinf(clock.jitter):
        steps = np.diff(clock.stamps) / h
        shortest, longest = float(steps.min()), float(steps.max())
        text = f"uneven stamps, steps of {shortest:.2g} to {longest:.2g} times {h:.3g} s"
        numbers = (("rate", 1.0 / h), ("shortest", shortest), ("longest", longest))
        rule, effect = f"each row at its own stamp: {rule}", effect_of_even_stamps(clock, positions)
        return True, [_step(file, text, rule, effect, numbers, stamped=True)]
    slope, error = stamps_are_true(clock, positions)
    off = float(f"{100 * clock.jitter / h:.2g}")
    text = f"stamps {off:g} % of a row off an even clock"
    share = f"{slope:.2f} +- {error:.1g} of what they say"
    stamped, effect = slope > 0.5 and math.isfinite(error), "none"
    if stamped:
        rule = f"the position was read at its stamps ({share}): {rule}"
        effect = effect_of_even_stamps(clock, positions)
    else:
        rule = f"read on an even clock, for the position does not follow the stamps ({share})"
    if not abs(slope - 0.5) > SURE * error:
        effect = "the position hardly tells, so that it makes little difference"
    numbers = (("jitter", clock.jitter), ("rate", 1.0 / h), ("followed", slope))
    return stamped, [_step(file, text, rule, effect, numbers, stamped=stamped)]


def _step(
    file: str,
    text: str,
    rule: str,
    effect: str,
    numbers: tuple[tuple[str, float], ...],
    *,
    stamped: bool,
) -> ReadingStep:
    return ReadingStep(
        file, text, rule, effect, topic="sample clock", numbers=numbers, interpolates=stamped
    )


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


def effect_of_even_stamps(clock: RecordClock, positions: Sequence[Array]) -> str:
    """The error of the position if the stamps were read as even, as a text."""
    off = clock.stamps - clock.time[clock.places]
    speeds = [
        float(np.sqrt(np.mean((np.gradient(x, clock.stamps) * off) ** 2)))
        / max(float(np.ptp(x)), 1e-300)
        for x in positions
    ]
    if not speeds:
        return "none"
    return f"read as even, positions would err by {100 * max(speeds):.2g} % of the travel"
