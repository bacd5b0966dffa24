"""A model of which the records determine no parameter: a small error says nothing of a machine."""

from __future__ import annotations

from ..model import Model

#: standard error over value from which a parameter counts as open: then zero and twice the value
#: both lie within two standard errors
OPEN = 0.5


def open_parameters_line(model: Model) -> str | None:
    """A sentence where every estimated parameter of a model is open; else None."""
    estimated = [value for value in model.parameters.values() if not value.fixed]
    known = [v for v in estimated if not v.stderr >= OPEN * abs(v.value)]
    if not estimated or known:
        return None
    return (
        "records: no parameter of the model is determined, each standard error is more than half "
        "of its value: a small error then says nothing of the machine. Record a motion that "
        "reverses and changes its speed"
    )
