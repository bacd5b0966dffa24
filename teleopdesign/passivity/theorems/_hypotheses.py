"""Hypotheses of a theorem about its numbers: stated beside it, and checked at every call.

    @under(damping=NOT_NEGATIVE, sample_time=POSITIVE, controller=FREE)
    def sampled_passivity(controller, *, damping, sample_time): ...

A number outside of the hypotheses is refused in one line, because the theorem does not hold for it.
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
    return bool(0 <= number <= _MOST and number == sp.floor(number))


#: samples or paths: a thousand late samples are a second already, and each costs time
_MOST = 10_000
#: SI, sizes of what is not 0: no machine is near the ends, and products of five such numbers and
#: their squares are still numbers of double precision, in which motions are sought and replayed
_SMALLEST, _LARGEST = Fraction(1, 10**30), Fraction(10**30)
_SIZES = "of a size from 1e-30 to 1e30"
_NO_NUMBER = (float("nan"), float("inf"), True, 1e-300, 1e300)


def _is_of_size(number: sp.Rational) -> bool:
    return bool(number == 0 or _SMALLEST <= abs(number) <= _LARGEST)


def _real(text: str, holds: Callable[[sp.Rational], bool], *outside: Any) -> Hypothesis:
    """A number of a size that is computed with, and more."""
    return Hypothesis(
        text,
        lambda x: _is_of_size(exact(x)) and holds(exact(x)),
        (*outside, *_NO_NUMBER),
    )


POSITIVE = _real("a number > 0", lambda x: bool(x > 0), 0, -1, Fraction(-1, 10**9))
NOT_NEGATIVE = _real("a number >= 0", lambda x: bool(x >= 0), -1, Fraction(-1, 10**9))
REAL = _real("a finite number", lambda x: True)
WHOLE = Hypothesis(
    f"a whole number >= 0, at most {_MOST}",
    _is_whole,
    (-1, 0.5, Fraction(3, 2), _MOST + 1, *_NO_NUMBER),
)
#: nothing that a number could violate: the function says what it needs
FREE = Hypothesis("anything", lambda x: True, ())


def one_of(*values: Any) -> Hypothesis:
    """One of these values."""
    text = " or ".join(map(str, values))
    return Hypothesis(text, lambda x: x in values, (max(values) + 1, min(values) - 1, 0.5))


def require_hypotheses(**hypotheses: Hypothesis) -> Callable[[Function], Function]:
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
                    off = isinstance(value, int | float) and not _is_of_size(exact(value))
                    sizes = f" {_SIZES}" if off else ""
                    raise ModelError(
                        f"{function.__name__}: {name}: expected {needs.text}{sizes}, found {value}"
                    )
            return function(*arguments, **named)

        call.hypotheses = hypotheses  # type: ignore[attr-defined]
        return call  # type: ignore[return-value]

    return with_hypotheses


def hypotheses_of(function: Callable[..., Any]) -> Mapping[str, Hypothesis]:
    """Argument -> what the theorem needs of it; ModelError where a function states none."""
    stated = getattr(function, "hypotheses", None)
    if stated is None:
        raise ModelError(f"{function.__name__}: states no hypotheses: see `require_hypotheses`")
    return dict(stated)
