"""One point of a study: the result of the model at this point, and the measures of this result.

Points of a study simulated side by side: many lanes of one compiled loop.

Only measures of the package that state their signals are computed in this way. A user's function
gets a whole simulation, one point at a time. The number of a point alone decides its block, so that
the same points are side by side on every machine and in every run.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.errors import ModelError, TeleopDesignError, unknown
from ..diagrams import Diagram
from ..simulate import simulate_many
from .case import SimulatedCase
from .chosen_measures import Measure
from .outcomes import PointOutcome
from .point import Amount, Point, SideBySide
from .points import Points, check_name

if TYPE_CHECKING:
    import xarray


_LONGEST_REASON = 300  # most characters of the reason of a failure


@dataclass(frozen=True)
class StudyTask:
    """A study in the form that every process receives.

    model: a case, whose parameters are varied, or a function of the parameters
    case: settings of the simulation for a diagram that the function returns
    """

    model: SimulatedCase | Callable[..., Any]
    case: Mapping[str, Any]
    points: Points
    measures: tuple[Measure, ...]
    seed: int = 0


def evaluate(
    task: StudyTask, index: int, beside: tuple[SideBySide, int] | None = None
) -> PointOutcome:
    """The outcome of a point: the values of its measures, or the reason why it failed.

    beside: signals of points that were simulated together, and the row of this one
    Any exception of a model or a measure becomes the reason of a failure: one point never ends a
    study.
    """
    try:
        values = task.points.at(index)
        content = task.model if beside is not None else _content(task, values)
        point = Point(content, values, (task.seed, index), beside)
        amounts: dict[str, Amount] = {}
        for measure in task.measures:
            for name, amount in measure(point).items():
                if name in amounts:
                    raise ModelError(f'study: two measures give "{name}"')
                _check_names(task, measure.name, name, amount)
                amounts[name] = amount
    except TeleopDesignError as error:
        return PointOutcome(index, reason=_shorten(str(error)))
    except (Exception, SystemExit) as error:
        return PointOutcome(index, reason=_shorten(f"{type(error).__name__}: {error}"))
    form = tuple(
        (name, "text" if isinstance(a.value, str) else "number", a.unit, a.text, *(a.over or ()))
        for name, a in amounts.items()
    )
    results = (tuple(a.value) if isinstance(a.value, list) else a.value for a in amounts.values())
    return PointOutcome(index, form, tuple(results))


def _check_names(task: StudyTask, measure: str, name: str, amount: Amount) -> None:
    """Raise ModelError if the data set has the name of a value, or of its dimension, already."""
    names = (*task.points.columns, *task.points.sizes)
    for one in (name, *(amount.over or ())[:1]):
        check_name(str(one), f"measure {measure}:")
        if one in names:
            raise ModelError(f'measure {measure}: gives "{one}", the name of a parameter')
    if amount.over and amount.over[0] == name:
        raise ModelError(f'measure {measure}: "{name}" is over a dimension of the same name')


def _content(task: StudyTask, values: Mapping[str, Any]) -> Any:
    if isinstance(task.model, SimulatedCase):
        return task.model.with_values(values)
    result = task.model(**values)
    return SimulatedCase(result, **task.case) if isinstance(result, Diagram) else result


def check_parameters(model: Callable[..., Any], points: Points) -> None:
    """Raise ModelError for parameters that a model's function does not take, or that it lacks."""
    try:
        signature = inspect.signature(model)
    except (TypeError, ValueError):  # a function of C says nothing of its arguments
        return
    takes = {
        n: p
        for n, p in signature.parameters.items()
        if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)
    }
    anything = any(p.kind is p.VAR_KEYWORD for p in signature.parameters.values())
    name = getattr(model, "__name__", "model")
    for parameter in points.names:
        if parameter not in takes and not anything:
            raise ModelError(f"study: {name} takes {unknown('parameter', parameter, takes)}")
    for parameter, declared in takes.items():
        if declared.default is declared.empty and parameter not in points.names:
            raise ModelError(f'study: {name}: parameter "{parameter}" has no axis and no value')


def _shorten(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= _LONGEST_REASON else line[: _LONGEST_REASON - 3] + "..."


#: points that a process receives at once: a range is simulated side by side
Unit = tuple[int, ...] | range

#: steps of all simulations of a block, which are lost if the process is killed: about half a
#: second, and two seconds if the study has `_BLOCKS` such blocks for its workers. The few points
#: that need up to 200 times finer steps take most of the time, unless enough of them run side by
#: side
_STEPS_OF_BLOCK, _STEPS_OF_LARGE = 2e7, 8e7
_BLOCKS = 8
#: most numbers in the signals of a block: 0.2 GB
_NUMBERS_OF_BLOCK = 2e7
_LEAST_IN_BLOCK, _MOST_IN_BLOCK, _MOST_IN_LARGE = 16, 512, 2048


def units_of(task: StudyTask, todo: Iterable[int]) -> list[Unit]:
    """The points in blocks if they can be simulated side by side, else one by one.

    A block contains all of its points, including points that are not wanted.
    """
    size = block_size(task)
    if size == 1:
        return [(i,) for i in todo]
    firsts = sorted({i - i % size for i in todo})
    return [range(first, min(first + size, len(task.points))) for first in firsts]


def block_size(task: StudyTask) -> int:
    """Number of points of a block; 1 if points cannot be simulated side by side."""
    case, signals = task.model, signals_of(task)
    if not isinstance(case, SimulatedCase) or not signals or case.every_step or not case.duration:
        return 1
    varied = [n for n in task.points.columns if n in case.diagram.values]
    is_number = all(c.values.dtype.kind in "biuf" for c in task.points.columns.values())
    if not varied or not is_number:
        return 1
    period = 1e-3 if isinstance(case.computer, str) else case.computer.period
    one_step = min(case.step, period) / case.duration
    usual = min(_STEPS_OF_BLOCK * one_step, _MOST_IN_BLOCK)
    large = min(_STEPS_OF_LARGE * one_step, _MOST_IN_LARGE, len(task.points) / _BLOCKS)
    by_memory = _NUMBERS_OF_BLOCK * period / (case.duration * len(signals))
    size = 16 * int(min(max(usual, large), by_memory) / 16)
    return max(_LEAST_IN_BLOCK, size)


def signals_of(task: StudyTask) -> tuple[str, ...]:
    """Signals that the measures need; empty if one of them may need any signal."""
    listed = [m.signals for m in task.measures]
    return () if not all(listed) else tuple(dict.fromkeys(s for one in listed for s in one))


def evaluate_unit(task: StudyTask, unit: Unit) -> Iterator[PointOutcome]:
    """The outcomes of the points of a unit: of a range side by side, of others one by one."""
    if not isinstance(unit, range):
        for index in unit:
            yield evaluate(task, index)
        return
    assert isinstance(task.model, SimulatedCase)
    table = task.points.table(unit.start, unit.stop)
    outcomes: dict[int, PointOutcome] = {}
    for rows, columns, others in group_alike(task.model, table):
        block = None
        try:
            case = task.model.with_values({**task.points.fixed, **others})
            block = SideBySide.of(simulate_rows(case, columns, signals_of(task)))
        except TeleopDesignError:
            pass  # what is wrong with all of them: each says its reason
        for k, row in enumerate(rows):
            beside = None if block is None else (block, k)
            outcomes[row] = evaluate(task, unit[row], beside)
    for row in range(len(unit)):
        yield outcomes[row]


def group_alike(
    case: SimulatedCase, table: Mapping[str, np.ndarray]
) -> Iterator[tuple[list[int], dict[str, np.ndarray], dict[str, Any]]]:
    """Groups of rows of a table that differ only in values of the diagram, so that lanes fit them.

    table: parameter -> values (rows,)
    yields: rows, their values of the diagram (arrays), and the values that they share
    """
    within = [n for n in table if n in case.diagram.values]
    beside = [n for n in table if n not in case.diagram.values]
    groups: dict[tuple[float, ...], list[int]] = {}
    for row in range(len(next(iter(table.values())))):
        groups.setdefault(tuple(table[n][row].item() for n in beside), []).append(row)
    for content, rows in groups.items():
        columns = {n: table[n][np.array(rows)] for n in within}
        yield rows, columns, dict(zip(beside, content, strict=True))


def simulate_rows(
    case: SimulatedCase, columns: Mapping[str, np.ndarray], keep: tuple[str, ...]
) -> xarray.Dataset:
    """Simulate a case with several values of its diagram; returns signals over `case` and `time`.

    columns: parameter -> values (cases,);  keep: names of the signals
    """
    return simulate_many(case.diagram, columns, **case.settings_of_steps(), keep=keep)
