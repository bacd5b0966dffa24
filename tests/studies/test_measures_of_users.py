"""Measures that a user writes: what they return, and what they forget to."""

import pytest

import teleopdesign as td
from teleopdesign.base.errors import ModelError


def doubled(a):
    return 2.0 * a


def test_a_measure_without_a_return_says_so():
    """The data set was NaN at every point, and said nothing of why."""

    def peak(value):
        max(value, 0.0)  # and no return

    result = td.study(doubled, {"a": [1.0, 2.0]}, measures=peak)
    assert "2 of 2 points failed, most: measure peak: returned nothing (None)" in repr(result)
    with pytest.raises(ModelError, match=r"measure peak: returned nothing \(None\)"):
        result["peak"]


def test_a_measure_may_have_no_number_at_a_point():
    def part(value):
        return value if value > 3.0 else None

    result = td.study(doubled, {"a": [1.0, 2.0]}, measures=part)
    assert result["part"].values[1] == 4.0
    (reason,) = result.failures
    assert "returned nothing" in reason
    whole = td.study(doubled, {"a": [1.0]}, measures=lambda value: float("nan"))
    assert not whole.failures
