"""The effort of a claim, counted in terms and boxes: the same on every machine.

    with bounded_effort():
        ...                    # raises TooMuchEffort where more is asked for

Exact arithmetic with values as symbols may grow without limit. Functions that multiply polynomials
or halve boxes spend from the effort of the claim that asks them; without a claim it has no bound.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from time import thread_time
from typing import TypeVar

from ..base.errors import ModelError

#: products of terms, and coefficients of boxes, that a claim may compute: some 20 s of one core
MOST = 2_000_000
#: s of one core: the last guard, where single operations take longer than they should
_LONGEST = 40.0


_Answer = TypeVar("_Answer")


class TooMuchEffort(ModelError):
    """A claim asks for more exact arithmetic than its effort allows."""


class _Left:
    def __init__(self, most: int) -> None:
        self.most, self.spent, self.until = most, 0, thread_time() + _LONGEST


_LEFT: ContextVar[_Left | None] = ContextVar("_LEFT", default=None)


@contextmanager
def bounded_effort(most: int = MOST) -> Iterator[None]:
    """A context in which exact arithmetic is bounded; inside another one, the outer bound holds."""
    if _LEFT.get() is not None:
        yield
        return
    token = _LEFT.set(_Left(most))
    try:
        yield
    finally:
        _LEFT.reset(token)


def try_within_effort(compute: Callable[[], _Answer], otherwise: _Answer) -> _Answer:
    """What is computed, or `otherwise` where this takes too much effort."""
    try:
        return compute()
    except TooMuchEffort:
        return otherwise


def spend(number: int) -> None:
    """Count products of terms or coefficients of boxes; raises TooMuchEffort beyond the bound."""
    left = _LEFT.get()
    if left is None:
        return
    left.spent += number
    if left.spent > left.most or thread_time() > left.until:
        raise TooMuchEffort(
            f"exact arithmetic of more than {left.most / 1e6:g} million terms and boxes"
        )
