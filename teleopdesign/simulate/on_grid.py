"""Durations, delays and inputs on the time grid of a simulation."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.errors import ModelError
from ..base.expectations import describe_value
from ..base.frozen import ByValue
from ..base.shown import Shown
from ..diagrams import Diagram
from ..realise.signal_symbols import is_whole

if TYPE_CHECKING:
    from ..realise.kernel import Timing
    from .trajectory import Trajectory


Pair = tuple[Any, Any]
Input = float | np.ndarray | Pair | Callable[[np.ndarray], np.ndarray]


def samples_of(duration: float, period: float) -> int:
    """Number of samples of a run, at least one; duration and period in s."""
    return max(round(duration / period), 1) if 0 < duration < float("inf") else 1


def delay_in_steps(delay: float, step: float, *, can_be_between: bool) -> float:
    """The delay of an analog signal in steps; not a whole number only if the signal is smooth.

    raises ModelError: no whole number of steps where one is needed, or below one step
    """
    count = delay / step
    if not can_be_between or is_whole(count):
        count = float(whole_steps(delay, step, "a delay of an actuator or of a held command"))
    if count < 1:
        raise ModelError(f"a delay of {delay:g} s is below the step, {step:g} s")
    return count


def whole_steps(delay: float, step: float, what: str) -> int:
    """The delay in whole steps; raises ModelError: no whole number of steps."""
    count = round(delay / step)
    if abs(count * step - delay) > 0.02 * delay + 1e-12:
        raise ModelError(
            f"{what} of {delay * 1e3:g} ms is no whole number of steps of "
            f"{step * 1e3:g} ms: use a step that divides it"
        )
    return count


def describe_rounding(delays: Iterable[float], steps: Iterable[float], step: float) -> str:
    """Words on the delays (s) that a simulation takes in whole steps of another duration.

    steps: number of steps of each delay;  step: s;  returns: "" where none is rounded
    """
    pairs = [
        (f"{n * step * 1e3:.5g}", f"{d * 1e3:.5g}") for d, n in zip(delays, steps, strict=True)
    ]
    other = dict.fromkeys(f"{whole} ms for {delay} ms" for whole, delay in pairs if whole != delay)
    return f", delays in whole steps: {', '.join(other)}" if other else ""


def input_table(
    names: tuple[str, ...], signals: Mapping[str, Input], time: np.ndarray
) -> np.ndarray:
    """Inputs (names, n) at times (n,), s; 0 for a signal that is not given a value."""
    table = np.zeros((max(len(names), 1), len(time)))
    for i, name in enumerate(names):
        value = signals.get(name, 0.0)
        row = _evaluate_at(value, time, name) if callable(value) else np.asarray(value, dtype=float)
        if row.ndim and row.shape != time.shape:
            raise ModelError(
                f'input "{name}" has {len(row)} samples, expected {len(time)}{_grid(time)}; a '
                "function takes samples of other times: lambda t: np.interp(t, times, samples)"
            )
        if not np.isfinite(row).all():
            k = int(np.argmin(np.isfinite(row)))
            raise ModelError(
                f'input "{name}" is {row.flat[k]:g} at {time[k]:.4g} s, expected finite numbers'
            )
        table[i] = row
    return table


@dataclass(frozen=True, eq=False)
class TableOverTime(Shown, ByValue):
    """Samples (n,) of an input at times (n,), s: linear in between, constant beyond both ends."""

    time: np.ndarray
    samples: np.ndarray

    def __call__(self, t: np.ndarray) -> np.ndarray:
        return np.asarray(np.interp(t, self.time, self.samples))


def with_recorded(inputs: Mapping[str, Input], duration: float) -> dict[str, Input]:
    """The inputs with a function for each pair of times (n,), s, and samples (n,) at these times.

    duration: s, all of which the times of a pair must cover
    raises ModelError: times that do not rise or do not cover the run, or another number of samples
    """
    return {
        name: _table_of_pair(name, value, duration) if isinstance(value, tuple) else value
        for name, value in inputs.items()
    }


def _table_of_pair(name: str, pair: Pair, duration: float) -> TableOverTime:
    expected = "a number, a function, samples, or a pair (times, samples)"
    if len(pair) != 2:
        raise ModelError(f'input "{name}": found {len(pair)} values, expected {expected}')
    time, samples = (np.asarray(x, dtype=float) for x in pair)
    if time.ndim != 1 or time.shape != samples.shape or len(time) < 2:
        raise ModelError(
            f'input "{name}": found times {time.shape} and samples {samples.shape}, expected two '
            "rows of one length"
        )
    if not (np.diff(time) > 0).all():
        raise ModelError(f'input "{name}": its times do not rise')
    # the last sample is held for as long as it lasted
    end = time[-1] + (time[-1] - time[-2])
    if time[0] > 0 or end < duration * (1 - 1e-9):
        raise ModelError(
            f'input "{name}": its times are {time[0]:g} to {time[-1]:g} s, the run 0 to '
            f"{duration:g} s"
        )
    return TableOverTime(time, samples)


def refuse_results(
    diagram: Diagram, inputs: Mapping[str, Input], motion: Mapping[str, Trajectory]
) -> None:
    """Refuse the force that prescribes a motion as an input: it is what the motion takes."""
    for block in diagram.moving:
        if block.motion not in motion:
            continue
        force = inputs.get(block.driver, 0.0)
        if callable(force) or np.any(force):
            raise ModelError(
                f"{diagram.name}: {block.driver} is the force that moves {block.motion} as "
                "prescribed: it is a result, expected among the inputs or the motions, not in both"
            )


def half_steps(timing: Timing) -> np.ndarray:
    """Starts, middles and ends of the steps, s."""
    return np.asarray(0.5 * timing.step * np.arange(2 * timing.steps + 1))


def tables_as_functions(
    names: tuple[str, ...], signals: Mapping[str, Input], grid: Callable[[], np.ndarray]
) -> dict[str, Input]:
    """The inputs with a function for each table that has a sample at each time of the grid.

    grid: gives the times (n,), s, of the step that was asked for; a run may have a shorter step
    raises ModelError: a table of one of the names has another number of samples
    """
    tables = {n: x for n, x in signals.items() if np.ndim(x)}  # type: ignore[arg-type]
    if not tables:
        return dict(signals)
    time = grid()
    input_table(names, tables, time)  # refuses other lengths
    return {
        **signals,
        **{
            name: TableOverTime(time, np.asarray(x, dtype=float))
            for name, x in tables.items()
            if np.shape(x) == time.shape  # type: ignore[arg-type]
        },
    }


def _grid(time: np.ndarray) -> str:
    if len(time) < 2:
        return ""
    return f", one each {1e3 * (time[1] - time[0]):.4g} ms from 0 to {time[-1]:.4g} s"


def _evaluate_at(
    function: Callable[[np.ndarray], np.ndarray], time: np.ndarray, name: str
) -> np.ndarray:
    """A function of time at times (n,): called once, or time by time where it takes one number.

    `lambda t: 1.0 if t > 0.5 else 0.0` and functions of `math` take one number.
    """
    try:
        return np.asarray(function(time), dtype=float)
    except (TypeError, ValueError):
        one_by_one: Callable[[float], Any] = function  # type: ignore[assignment]
    values = [one_by_one(t) for t in time.tolist()]
    try:
        return np.array([float(value) for value in values])
    except (TypeError, ValueError) as error:
        raise ModelError(
            f'input "{name}": its function returns {describe_value(values[0])}, expected a number'
        ) from error
