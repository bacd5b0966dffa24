"""One point of a study: the result of the model at this point, and the measures of this result."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from ..base.errors import ModelError, TeleopDesignError, did_you_mean
from ..diagrams import Diagram
from .case import SimulatedCase
from .chosen_measures import Measure
from .outcomes import PointOutcome
from .point import Amount, Point
from .points import Points, check_name

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


def evaluate(task: StudyTask, index: int) -> PointOutcome:
    """The outcome of a point: its values, or the reason why it failed."""

    def point() -> Point:
        values = task.points.at(index)
        return Point(_content(task, values), values, (task.seed, index))

    return outcome_of(task, index, point)


def outcome_of(task: StudyTask, index: int, made: Callable[[], Point]) -> PointOutcome:
    """The measures of a point.

    Any exception of a model or a measure becomes the reason of a failure: one point never ends a
    study.
    """
    try:
        point = made()
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
    return PointOutcome(index, form, tuple(_list_as_tuple(a.value) for a in amounts.values()))


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
            raise ModelError(
                f'study: {name} takes no parameter "{parameter}", has {", ".join(takes) or "none"}'
                f"{did_you_mean(parameter, takes)}"
            )
    for parameter, declared in takes.items():
        if declared.default is declared.empty and parameter not in points.names:
            raise ModelError(f'study: {name}: parameter "{parameter}" has no axis and no value')


def _shorten(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= _LONGEST_REASON else line[: _LONGEST_REASON - 3] + "..."


def _list_as_tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value
