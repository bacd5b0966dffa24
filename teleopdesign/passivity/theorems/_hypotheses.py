"""Hypotheses of a theorem about its numbers: stated beside it, and checked at every call.

    @require_hypotheses(damping=NOT_NEGATIVE, sample_time=POSITIVE, controller=FREE)
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

from ...base.errors import ModelError
from ..linear.impedance import exact

Function = TypeVar("Function", bound=Callable[..., Any])


@dataclass(frozen=True)
class Hypothesis:
    """A condition on one argument of a theorem.

    text: for messages, such as "a number > 0";  holds: whether a value meets the condition
    outside: values that violate the condition, for tests
    """

    text: str
    holds: Callable[[Any], bool]
    outside: tuple[Any, ...]

    def or_none(self) -> Hypothesis:
        """The same condition, with None allowed as well."""
        return Hypothesis(
            f"{self.text} or None", lambda x: x is None or self.holds(x), self.outside
        )


def _is_whole(value: Any) -> bool:
    number = exact(value)
    return bool(0 <= number <= _MOST and number == sp.floor(number))


#: most samples or paths: each costs time, and a thousand late samples already take a second
_MOST = 10_000
#: smallest and largest size of a number that is not 0, SI: no machine is near these ends, and
#: products of five such numbers, and their squares, still fit into double precision, in which
#: motions are searched and replayed
_SMALLEST, _LARGEST = Fraction(1, 10**30), Fraction(10**30)
_SIZES = "of a size from 1e-30 to 1e30"
_NO_NUMBER = (float("nan"), float("inf"), True, 1e-300, 1e300)


def _is_of_size(number: sp.Rational) -> bool:
    return bool(number == 0 or _SMALLEST <= abs(number) <= _LARGEST)


def _real(text: str, holds: Callable[[sp.Rational], bool], *outside: Any) -> Hypothesis:
    """A condition on a number: 0 or of a size from 1e-30 to 1e30, and `holds`."""
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
#: no condition: the function itself checks the argument
FREE = Hypothesis("anything", lambda x: True, ())


def one_of(*values: Any) -> Hypothesis:
    """The condition that an argument is one of these values."""
    text = " or ".join(map(str, values))
    return Hypothesis(text, lambda x: x in values, (max(values) + 1, min(values) - 1, 0.5))


def require_hypotheses(**hypotheses: Hypothesis) -> Callable[[Function], Function]:
    """Decorator of a theorem on numbers: checks a hypothesis for each argument at every call.

    raises ModelError: at a call, an argument that violates its hypothesis; at the definition, an
        argument without a hypothesis
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
                try:
                    holds = needs.holds(value)
                except ModelError as error:
                    raise ModelError(f"{function.__name__}: {name}: {error}") from None
                if not holds:
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
    """Hypotheses of a theorem: argument -> hypothesis.

    raises ModelError: the function states no hypotheses
    """
    stated = getattr(function, "hypotheses", None)
    if stated is None:
        raise ModelError(f"{function.__name__}: states no hypotheses: see `require_hypotheses`")
    return dict(stated)
