"""Outcomes of points are given back as they came, in few bytes where they are numbers."""

import sys

from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.studies.outcomes import Outcomes, PointOutcome

NUMBER = ("peak", "number", "m", "largest size")
FORMS = [(NUMBER,), (NUMBER, ("rms", "number", "N", "")), *[((f"m{k}",),) for k in range(12)]]
numbers = st.floats(allow_nan=False)
values = st.one_of(numbers, st.text(max_size=3), st.integers(), st.tuples(numbers, numbers))


@st.composite
def outcomes(draw):
    point = draw(st.one_of(st.integers(0, 19), st.sampled_from([20, 2**60 - 1])))
    if draw(st.booleans()):
        return PointOutcome(point, reason="no simulation")
    form = draw(st.sampled_from(FORMS))
    plain = draw(st.booleans())
    return PointOutcome(point, form, tuple(draw(numbers if plain else values) for _ in form))


@given(st.lists(outcomes(), max_size=40))
def test_what_is_kept_is_what_a_dictionary_would_hold(listed):
    kept, expected = Outcomes(20), {}
    for outcome in listed:
        kept.keep(outcome)
        expected[outcome.point] = outcome
    assert dict(kept) == expected and len(kept) == len(expected)
    for point, outcome in expected.items():
        assert list(map(type, kept[point].values)) == list(map(type, outcome.values))
    for point in kept.failed_points():
        kept.drop(point)
    assert dict(kept) == {i: o for i, o in expected.items() if not o.reason}
    assert len(kept) == len(dict(kept)) and -1 not in kept and 21 not in kept and "a" not in kept


def test_a_point_with_two_numbers_takes_seventeen_bytes():
    """Two numbers and the number of their form, whatever stands in the form."""
    kept = Outcomes(1000)
    for point in range(1000):
        form = (NUMBER, ("rms", "number", "N", "a text " * 10))  # a new tuple each time
        kept.keep(PointOutcome(point, form, (1.5 * point, 2.0)))
    arrays = sum(array.nbytes for array in (kept._places, *kept._rows))
    assert arrays == 17 * 1000 and len(kept._forms) == 1
    assert sys.getsizeof(kept._apart) < 100
