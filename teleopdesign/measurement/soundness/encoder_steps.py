"""Encoder steps: the steps of the readings, compared with the stated resolution."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from ...base.finding import Finding
from ...base.units import si_factor
from ..channel import BODY_QUANTITIES
from ..encoder import reading_step
from ..filtering import Array
from .signal import Signal

#: how close the readings lie to a grid: mean of exp(2 pi i x/step), 1 on it, 0 anywhere
ON_GRID = 0.9
#: multiples of the stated step that are tested as the true one
MULTIPLES = range(2, 65)
#: readings that are looked at
ENOUGH = 20_000


def measure_griddedness(x: Array, step: float) -> float:
    """How closely readings lie on a grid of a step, with any origin: 0 (not) to 1 (exactly)."""
    thinned = x[:: max(1, len(x) // ENOUGH)]
    return float(np.abs(np.mean(np.exp(2j * np.pi * (thinned - thinned[0]) / step))))


def true_step(x: Array, stated: float) -> float | None:
    """The step of the readings: the stated one or a multiple of it; None: neither.

    Each place counts once: the rows of a body at rest lie on any grid.
    """
    if measure_griddedness(x, stated) < ON_GRID:
        return None
    reached, ratio = float(np.ptp(x)), round(reading_step(x) / stated)
    multiples = [k for k in (*MULTIPLES, ratio) if k > 1 and k * stated < 0.1 * reached]
    places = np.unique(x)
    on = [k for k in multiples if measure_griddedness(places, k * stated) > ON_GRID]
    return stated * max(on, default=1)


def _as_written(signal: Signal, step: float) -> float:
    """A step in the unit in which the channel's resolution is written."""
    channel = signal.channel
    if channel.conversion is not None:
        return step / abs(channel.conversion.factor)
    factor = si_factor(channel.unit, quantity=BODY_QUANTITIES[channel.quantity], axis=signal.axis)
    return step / factor


def check_steps(signal: Signal, others: Sequence[Signal]) -> list[Finding]:
    """Compare the stated resolution of a channel with its readings.

    others: channels of the same record, one of which may have the stated steps instead
    """
    stated, read_step = signal.channel.resolution, signal.step
    if stated is None or read_step == 0.0:
        return []
    step = true_step(signal.values, stated)
    if step == stated:
        return []
    is_between = signal.channel.quantity == "position" and any(
        done.interpolates for done in signal.record.reading
    )
    if step is None and read_step < stated and is_between:
        return []  # the readings have steps; the interpolated samples have none
    concern: Literal["note", "warning"] = "warning"
    if step is not None:
        text = (
            f"moves in steps of {step:.4g} {signal.unit}, {step / stated:.0f} times the stated "
            f"{stated:.4g}: the encoder is coarser than stated; write resolution = "
            f"{_as_written(signal, step):.4g} at channels.{signal.name}."
        )
    else:
        swapped = [o.name for o in others if _shares_steps(o, stated)]
        text = f"is not read in steps of the stated {stated:.4g} {signal.unit}"
        if swapped:
            text += f", but {swapped[0]} is: are the two columns swapped?"
        elif read_step < stated:
            concern = "note"
            text += ", but in finer ones."
        else:
            text += f", but of {read_step:.4g}."
    return [
        Finding(
            "encoder steps",
            concern,
            f"{signal.name} {text}",
            {"stated": stated, "seen": read_step if step is None else step},
            signal.record.file,
        )
    ]


def _shares_steps(other: Signal, stated: float) -> bool:
    """Whether another channel moves in the stated steps; a much finer step would fit by chance."""
    alike = 0.5 < other.step / stated < 2.0 * MULTIPLES.stop
    return alike and measure_griddedness(other.values, stated) > ON_GRID
