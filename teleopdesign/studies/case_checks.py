"""What is wrong with every point of a study is refused before its first point."""

from __future__ import annotations

from collections.abc import Iterable

from ..base.errors import ModelError, UnknownSignal, did_you_mean
from ..base.expectations import describe_value, number_check
from ..simulate import Setup
from .case import SimulatedCase
from .chosen_measures import Measure
from .points import Points


def check_case(case: SimulatedCase, points: Points, measures: Iterable[Measure]) -> None:
    """Raise ModelError for texts as values, and for names of signals and states that are unknown.

    Numbers out of bounds are no matter of this check: such a point fails, and others do not.
    """
    for name, column in points.columns.items():
        if column.values.dtype.kind not in "biuf":
            _refuse(name, column.values[0])
    for name, value in points.fixed.items():
        if number_check(value) is not None:
            _refuse(name, value)
    setup = _setup(case, points)
    if setup is None:
        return
    layout = setup.program.layout
    for measure in measures:
        for signal in measure.signals:
            if signal not in layout.columns:
                raise ModelError(
                    f'measure {measure.name}: no signal "{signal}", has '
                    f"{', '.join(layout.columns)}{did_you_mean(signal, layout.columns)}"
                )


def _refuse(name: str, value: object) -> None:
    raise ModelError(f"study: {name}: found {describe_value(value)}, expected a number (SI)")


def _setup(case: SimulatedCase, points: Points) -> Setup | None:
    """The simulation at the first point; None if there is none, for reasons of its values."""
    if not case.duration and "duration" not in points.names:
        return None
    try:
        return case.with_values(points.at(0)).setup()
    except UnknownSignal:
        raise
    except ModelError:
        return None
