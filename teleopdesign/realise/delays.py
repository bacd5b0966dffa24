"""A delay on a grid: whole steps or samples where possible, otherwise between two of them."""

from __future__ import annotations

from ..base.errors import ModelError

#: distance of a delay from a whole number of steps or samples that is rounding of the division
_WHOLE = 1e-9


def is_whole(count: float) -> bool:
    """Whether a delay of `count` steps or samples is whole, except for rounding."""
    return abs(count - round(count)) <= _WHOLE * max(count, 1.0)


def delay_in_samples(delay: float, period: float, *, what: str) -> float:
    """The delay of a computer's signal in samples, at least one.

    delay, period: s;  what: first words of the error
    raises ModelError: the delay is below the period
    """
    count = delay / period
    if is_whole(count) and round(count) >= 1:
        return float(round(count))
    if count < 1:
        raise ModelError(
            f"{what}: a delay of {delay * 1e3:g} ms is below the computer's period of "
            f"{period * 1e3:g} ms: make the block analog, or the period shorter"
        )
    return count
