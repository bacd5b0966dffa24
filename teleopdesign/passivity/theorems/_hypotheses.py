"""What a theorem needs of its numbers: stated beside it, and checked before it claims anything.

    @under(damping=NOT_NEGATIVE, sample_time=POSITIVE, controller=FREE)
    def sampled_passivity(controller, *, damping, sample_time): ...

A number outside is refused in one line: outside of its hypotheses a theorem says nothing.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import wraps
from typing import Any, TypeVar

import sympy as sp

from ...errors import ModelError
from ..linear.impedance import exact

Function = TypeVar("Function", bound=Callable[..., Any])


@dataclass(frozen=True)
class Hypothesis:
    """What a theorem needs of one of its arguments.

    text: after "expected", such as "a number > 0";  holds: whether a value is so
    outside: values that are not, for tests
    """

    text: str
    holds: Callable[[Any], bool]
    outside: tuple[Any, ...]

    def or_none(self) -> Hypothesis:
        """The same, or None."""
        return Hypothesis(
            f"{self.text} or None", lambda x: x is None or self.holds(x), self.outside
        )


def _is_whole(value: Any) -> bool:
    number = exact(value)
    return bool(number >= 0 and number == sp.floor(number))


def _is_finite(value: Any) -> bool:
    return exact(value) is not None  # it raises where there is no such number


_NO_NUMBER = (float("nan"), float("inf"), True)
POSITIVE = Hypothesis(
    "a number > 0", lambda x: bool(exact(x) > 0), (0, -1, Fraction(-1, 10**9), *_NO_NUMBER)
)
NOT_NEGATIVE = Hypothesis(
    "a number >= 0", lambda x: bool(exact(x) >= 0), (-1, Fraction(-1, 10**9), *_NO_NUMBER)
)
REAL = Hypothesis("a finite number", _is_finite, _NO_NUMBER)
WHOLE = Hypothesis("a whole number >= 0", _is_whole, (-1, 0.5, Fraction(3, 2), *_NO_NUMBER))
#: nothing that a number could violate: the function says what it needs
FREE = Hypothesis("anything", lambda x: True, ())


def one_of(*values: Any) -> Hypothesis:
    """One of these values."""
    text = " or ".join(map(str, values))
    return Hypothesis(text, lambda x: x in values, (max(values) + 1, min(values) - 1, 0.5))


def under(**hypotheses: Hypothesis) -> Callable[[Function], Function]:
    """A theorem on numbers with its hypotheses, one for each argument, checked at every call.

    raises ModelError: at the call, an argument that violates its hypothesis; where the theorem is
        defined, an argument without one
    """

    def with_hypotheses(function: Function) -> Function:
        signature = inspect.signature(function)
        if set(signature.parameters) != set(hypotheses):
            odd = sorted(set(signature.parameters) ^ set(hypotheses))
            raise ModelError(f"{function.__name__}: without hypothesis, or no argument: {odd}")

        @wraps(function)
        def call(*arguments: Any, **named: Any) -> Any:
            bound = signature.bind(*arguments, **named)
            bound.apply_defaults()
            for name, value in bound.arguments.items():
                needs = hypotheses[name]
                if not needs.holds(value):
                    raise ModelError(
                        f"{function.__name__}: {name}: expected {needs.text}, found {value}"
                    )
            return function(*arguments, **named)

        call.hypotheses = hypotheses  # type: ignore[attr-defined]
        return call  # type: ignore[return-value]

    return with_hypotheses


def hypotheses_of(function: Callable[..., Any]) -> Mapping[str, Hypothesis]:
    """Argument -> what the theorem needs of it; ModelError where a function states none."""
    stated = getattr(function, "hypotheses", None)
    if stated is None:
        raise ModelError(f"{function.__name__}: states no hypotheses: see `under`")
    return dict(stated)
