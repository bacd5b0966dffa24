"""A number with its standard error, and whether it is fixed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from ..base.arguments import instance, number
from ..base.frozen import ByValue
from ..base.shown import html_table
from ..effects import Parameter

#: half width of a 95 % interval in standard errors, for a normal distribution
NINETY_FIVE = 1.96


@dataclass(frozen=True, eq=False)
class Value(ByValue):
    """A parameter's value with its standard error.

    value: SI;  fixed: whether it is known, so that no fit estimates it
    stderr: standard error, in the unit of the value; NaN where it is unknown
    raises ModelError: the value is no number, or `fixed` no flag
    """

    value: float
    fixed: bool = False
    stderr: float = float("nan")

    def __post_init__(self) -> None:
        if type(self.value) is not float:
            object.__setattr__(self, "value", number(self.value, "Value: value"))
        if type(self.fixed) is not bool:
            instance(self.fixed, bool, "Value: fixed", expected="True or False")

    def __hash__(self) -> int:
        return hash((self.value, self.fixed))

    def _repr_html_(self) -> str:
        unknown = self.stderr != self.stderr
        known = "fixed" if self.fixed else "free"
        row = (f"{self.value:.6g}", "-" if unknown else f"{self.stderr:.2g}", known)
        return html_table("Value (SI)", ("value", "standard error", "in a fit"), [row])


def with_held(values: Mapping[str, Value], declared: Mapping[str, Parameter]) -> dict[str, Value]:
    """The values by name, with those that are never estimated fixed (`FitSearch.held`)."""
    held = {n: replace(values[n], fixed=True) for n, p in declared.items() if p.search.held}
    return {**values, **held}
