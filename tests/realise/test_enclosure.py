"""Intervals of laws hold every value, and the least value found is a bound that is met."""

from math import inf

import mpmath
import pytest
import sympy as sp
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from teleopdesign.base.errors import ModelError
from teleopdesign.realise import enclosure as enclosure_module
from teleopdesign.realise.enclosure import Singular, enclosure_of
from teleopdesign.realise.extremes import TIGHTNESS, least_value

X, Y = sp.symbols("x y", real=True)
S = sp.Symbol("s", positive=True)

numbers = st.sampled_from([sp.Integer(2), sp.Rational(1, 3), sp.Float(0.1), -sp.Float(1.7), sp.pi])
leaves = st.sampled_from([X, Y]) | numbers
functions = [
    sp.Abs, sp.sign, sp.exp, sp.sin, sp.cos, sp.tanh, sp.atan, sp.sinh, sp.cosh,
    lambda a: a**2, lambda a: a**3, lambda a: sp.sqrt(sp.Abs(a)), lambda a: 1 / (1 + a**2),
    lambda a: sp.log(1 + a**2), lambda a: (1 + a**2) ** sp.Rational(3, 2),
]  # fmt: skip
pairs = [
    lambda a, b: a + b, lambda a, b: a * b, sp.Min, sp.Max,
    lambda a, b: sp.Piecewise((a, a > b), (a * b, sp.And(a < 1, b <= 0)), (b, True)),
]  # fmt: skip


def built(function, *parts):
    """The law; another is drawn where sympy cannot write it: some nested pieces recur for ever."""
    try:
        return function(*parts)
    except RecursionError:
        reject()


laws = st.recursive(
    leaves,
    lambda inner: (
        st.builds(built, st.sampled_from(functions), inner)
        | st.builds(built, st.sampled_from(pairs), inner, inner)
    ),
    max_leaves=6,
)
ranges = st.tuples(st.floats(-3, 3), st.floats(-3, 3)).map(sorted)
shares = st.lists(st.tuples(st.floats(0, 1), st.floats(0, 1)), min_size=5, max_size=5)


def exact(law, x, y):
    """The value at 60 digits."""
    with mpmath.workdps(60):
        call = sp.lambdify([X, Y], law, "mpmath")
        return call(mpmath.mpf(x), mpmath.mpf(y))


@pytest.mark.slow
@settings(max_examples=150)
@given(law=laws, x=ranges, y=ranges, shares=shares)
def test_no_value_of_a_law_leaves_its_interval(law, x, y, shares):
    low, high = enclosure_of(law, [X, Y])([tuple(x), tuple(y)])
    for a, b in shares:
        px = min(max(x[0] + a * (x[1] - x[0]), x[0]), x[1])
        py = min(max(y[0] + b * (y[1] - y[0]), y[0]), y[1])
        try:
            value = exact(law, px, py)
        except OverflowError:
            continue
        assert low <= value <= high


@settings(max_examples=100)
@given(law=laws, places=st.lists(st.tuples(ranges, ranges), min_size=2, max_size=6))
def test_boxes_looked_at_before_change_no_interval(law, places):
    """Also where only one range differs from the last, and where the last divided by zero."""
    for smooth in (False, True):
        kept = enclosure_of(law, [X, Y], smooth=smooth)
        for x, y in [(a, b) for a, _ in places for _, b in places]:
            box = [tuple(x), tuple(y)]
            try:
                anew = enclosure_of(law, [X, Y], smooth=smooth)(box)
            except Singular:
                with pytest.raises(Singular):
                    kept(box)
                continue
            assert kept(box) == anew


def test_a_part_whose_ranges_are_as_before_is_not_computed_anew(monkeypatch):
    """A search halves one range at a time; the sines of laws take most of its time."""
    calls = []
    wave = enclosure_module.enclose_wave
    monkeypatch.setattr(
        enclosure_module, "enclose_wave", lambda f, x: calls.append(x) or wave(f, x)
    )
    interval_of = enclosure_of(Y * sp.sin(X) + Y, [X, Y])
    for high in (1.0, 2.0, 3.0):
        interval_of([(0.0, 0.5), (0.0, high)])
    assert calls == [(0.0, 0.5)]
    assert interval_of([(0.0, 0.0), (0.0, 3.0)]) == (0.0, 3.0) and len(calls) == 2


@settings(max_examples=50)
@given(law=laws, x=ranges, y=ranges, shares=shares)
def test_no_value_is_below_the_least_and_the_least_is_met(law, x, y, shares):
    lowest = least_value(law, {X: tuple(x), Y: tuple(y)})
    for a, b in shares:
        px = min(max(x[0] + a * (x[1] - x[0]), x[0]), x[1])
        py = min(max(y[0] + b * (y[1] - y[0]), y[0]), y[1])
        assert lowest.bound <= exact(law, px, py)
    if lowest.point and lowest.met < inf:
        here = exact(law, lowest.point.get(X, 0), lowest.point.get(Y, 0))
        assert lowest.bound <= here <= lowest.met


def test_ends_beyond_the_range_of_floats_lie_outside():
    tiny = [(1e-200, 1e-200)]
    assert enclosure_of(X**2, [X])(tiny) == (0.0, 5e-324)
    assert enclosure_of(-(X**2), [X])(tiny) == (-5e-324, 0.0)
    huge = enclosure_of(X**2, [X])([(1e200, 1e200)])
    assert huge == (1.7976931348623157e308, inf)


@pytest.mark.parametrize(
    ("law", "over", "least"),
    [
        (X**2 - X, {X: (0.0, 1.0)}, -0.25),
        (X, {X: (0.3, 0.3)}, 0.3),
        (sp.exp(-((S / X) ** 2)), {S: (0.0, inf), X: (0.0, 0.01)}, 0.0),
        (1 + 0.2 * sp.sin(X / Y), {X: (-inf, inf), Y: (0.04, 0.06)}, 0.8),
        (1 - 0.3 * (1 - sp.exp(-S / X)), {S: (0.0, inf), X: (0.0, 5.0)}, 0.7),
        (1 / (1 + S), {S: (0.0, inf)}, 0.0),
        (X / sp.sqrt(1 + X**2), {X: (-3.0, 5.0)}, -3 / 10**0.5),
        (sp.Piecewise((X, X > 1), (2 - X, True)), {X: (-3.0, 3.0)}, 1.0),
        (sp.Abs(X) - X / 2, {X: (-1.0, 1.0)}, 0.0),
    ],
)
def test_the_least_value_is_known_to_the_stated_tightness(law, over, least):
    lowest = least_value(law, over)
    # what a law is compared with: its value at the middle of the ranges, at most 3 here
    assert least - 3 * TIGHTNESS <= lowest.bound <= least + 1e-14
    assert lowest.met >= least - 1e-14


def test_a_jump_is_not_taken_for_a_slope():
    step = sp.Piecewise((0, X < 1), (-1, True)) + sp.Rational(1, 10) * X
    assert least_value(step, {X: (0.0, 2.0)}).bound == pytest.approx(-0.9, rel=1e-4)
    falls = -sp.sign(X) + X / 10
    assert least_value(falls, {X: (-1.0, 1.0)}).bound == pytest.approx(-1.0, rel=1e-4)
    # falls on either side of a pole, and jumps up there
    pole = sp.tanh(1 / X)
    assert least_value(pole, {X: (-1.0, 1.0)}).bound <= -1 + 1e-4


def test_a_law_without_a_bound_has_none():
    assert least_value(-X * Y, {X: (0.0, 1.0), Y: (0.0, inf)}).bound == -inf
    assert least_value(1 / X, {X: (-1.0, 1.0)}).bound == -inf
    assert least_value(sp.log(X), {X: (0.0, 1.0)}).bound == -inf


@pytest.mark.parametrize(
    ("law", "over", "low", "high"),
    [
        (sp.sqrt(S), (0.25, 4.0), 0.5, 2.0),
        (S ** sp.Rational(1, 3), (0.125, 8.0), 0.5, 2.0),
        (S ** sp.Rational(2, 3), (0.125, 8.0), 0.25, 4.0),
        (S ** sp.Rational(1, 3), (0.0, 8.0), 0.0, 2.0),
        (1 / sp.sqrt(S), (0.25, 4.0), 0.5, 2.0),
        (S ** sp.Float(0.75), (1.0, 16.0), 1.0, 8.0),
        (sp.log(S), (1.0, 8.0), 0.0, 2.0794415416798357),
        (sp.log(S), (0.0, 1.0), -inf, 0.0),
        (sp.log(S), (-1.0, 1.0), -inf, inf),
        (sp.log(S), (-1.0, 0.0), -inf, inf),
        (sp.log(S), (0.0, 0.0), -inf, inf),
    ],
    ids=str,
)
def test_roots_powers_and_logarithms_have_their_range_and_hardly_more(law, over, low, high):
    least, most = enclosure_of(law, [S])([tuple(over)])
    assert least <= low and high <= most
    # guards of a few last places
    assert least == pytest.approx(low, abs=1e-9) and most == pytest.approx(high, abs=1e-9)


def test_a_function_of_which_no_bound_is_known_is_named():
    with pytest.raises(ModelError, match="erf"):
        least_value(sp.erf(X), {X: (0.0, 1.0)})
    with pytest.raises(ModelError, match="no range of y"):
        least_value(X * Y, {X: (0.0, 1.0)})


def test_a_slope_where_the_law_may_be_undefined_tells_nothing():
    slope = enclosure_of(1 / X, [X], smooth=True)
    with pytest.raises(Singular):
        slope([(0.0, 1.0)])


corners = st.tuples(st.integers(-2, 2), st.integers(-2, 2)).map(sorted)
relations = [sp.StrictLessThan, sp.StrictGreaterThan, sp.LessThan, sp.GreaterThan, sp.Eq, sp.Ne]


@pytest.mark.parametrize("relation", relations)
@given(x=corners, y=corners)
def test_a_relation_can_hold_or_fail_where_points_of_the_ranges_do(relation, x, y):
    """Whether any point does is seen on a grid of halves: ranges end at whole numbers."""
    condition = relation(X, Y, evaluate=False)
    enclosure = enclosure_of(condition, [X, Y])([tuple(x), tuple(y)])
    points = [(a / 2, b / 2) for a in range(2 * x[0], 2 * x[1] + 1)
              for b in range(2 * y[0], 2 * y[1] + 1)]  # fmt: skip
    holds = {bool(relation(sp.Rational(a), sp.Rational(b))) for a, b in points}
    assert enclosure == (True in holds, False in holds)


@given(x=corners, y=corners, z=st.sampled_from(["and", "or", "not", "if"]))
def test_conditions_are_joined_as_the_possibilities_of_their_parts(x, y, z):
    first, second = sp.StrictLessThan(X, 0), sp.StrictLessThan(Y, 0)
    joined = {
        "and": sp.And(first, second),
        "or": sp.Or(first, second),
        "not": sp.Not(sp.And(first, second), evaluate=False),
        "if": sp.ITE(first, second, sp.StrictLessThan(0, Y), evaluate=False),
    }[z]
    rule = {
        "and": lambda a, b: a < 0 and b < 0,
        "or": lambda a, b: a < 0 or b < 0,
        "not": lambda a, b: not (a < 0 and b < 0),
        "if": lambda a, b: b < 0 if a < 0 else b > 0,
    }[z]
    enclosure = enclosure_of(joined, [X, Y])([tuple(x), tuple(y)])
    points = [(a / 2, b / 2) for a in range(2 * x[0], 2 * x[1] + 1)
              for b in range(2 * y[0], 2 * y[1] + 1)]  # fmt: skip
    holds = {rule(a, b) for a, b in points}
    # x and y are free of each other, so no possibility is counted that is none
    assert enclosure == (True in holds, False in holds)


STEP = sp.Heaviside(X, sp.Rational(1, 2))


@pytest.mark.parametrize(
    ("law", "over", "expected"),
    [
        (STEP, (-2.0, -1.0), (0.0, 0.0)),
        (STEP, (1.0, 2.0), (1.0, 1.0)),
        (STEP, (-1.0, 1.0), (0.0, 1.0)),
        (STEP, (0.0, 1.0), (0.0, 1.0)),
        (STEP, (-1.0, 0.0), (0.0, 1.0)),
        (sp.sign(X), (-2.0, -1.0), (-1.0, -1.0)),
        (sp.sign(X), (-1.0, 0.0), (-1.0, 0.0)),
        (sp.sign(X), (0.0, 1.0), (0.0, 1.0)),
        (sp.Piecewise((1, X < 0), (5, X < 1), (9, True)), (-1.0, 0.5), (1.0, 5.0)),
        (sp.Piecewise((1, X < 0), (5, X < 1), (9, True)), (2.0, 3.0), (9.0, 9.0)),
        (sp.Piecewise((1, X < 0), (5, X < 1)), (0.5, 2.0), (-inf, inf)),
        (sp.Piecewise((1, X < 0), (5, X < 1)), (-2.0, 0.5), (1.0, 5.0)),
        (1 / X, (1.0, 2.0), (0.5, 1.0)),
        (1 / X, (0.0, 2.0), (0.5, inf)),
        (1 / X, (-2.0, 0.0), (-inf, -0.5)),
        (1 / X, (-1.0, 2.0), (-inf, inf)),
        (X * Y, (0.0, 0.0), (0.0, 0.0)),
        (X * sp.exp(-Y), (0.0, 0.0), (0.0, 0.0)),
        (sp.exp(Y), (0.0, 0.0), (0.0, inf)),
        (sp.Min(X, 2), (1.0, 3.0), (1.0, 2.0)),
        (sp.Max(X, 2), (1.0, 3.0), (2.0, 3.0)),
        (sp.tan(X), (-0.5, 0.5), (-0.5463024898437905, 0.5463024898437905)),
    ],
    ids=str,
)
def test_steps_pieces_poles_and_empty_products_have_their_range(law, over, expected):
    """y is anywhere on the line."""
    bounds = enclosure_of(law, [X, Y])([tuple(over), (-inf, inf)])
    assert bounds == pytest.approx(expected, abs=1e-14, rel=1e-13)


@pytest.mark.parametrize("law", [1 / X, sp.sqrt(X), sp.log(X), X ** sp.Rational(-1, 3), X**-2])
def test_where_a_smooth_law_is_asked_for_its_edge_is_refused(law):
    smooth = enclosure_of(law, [X], smooth=True)
    for over in ((0.0, 1.0), (-1.0, 1.0)):
        with pytest.raises(Singular):
            smooth([tuple(over)])
        enclosure_of(law, [X])([tuple(over)])
    low, high = smooth([(0.5, 1.0)])
    assert low <= float(law.subs(X, 0.5)) <= high


@given(x=st.floats(-750, 750))
def test_an_exponential_stays_on_its_side_of_one_and_of_zero(x):
    low, high = enclosure_of(sp.exp(X), [X])([(x, x)])
    assert 0 <= low <= high and (high <= 1 if x <= 0 else low >= 1)
    width = enclosure_of(sp.exp(X), [X])([(-inf, x)])
    assert width[0] == 0.0 and width[1] >= high * (1 - 1e-14)


@pytest.mark.parametrize("range_", [(0.0, inf), (0.5, inf), (-2.0, inf), (-inf, inf), (1.0, 9.0)])
@pytest.mark.parametrize("place", [3.0, 7e3])
def test_a_least_value_is_as_exact_to_the_left_as_to_the_right(range_, place):
    """A valley at some place of a line that has no end: the same with the axis turned round."""
    x = sp.Symbol("x")
    low, high = range_
    law = (x - place) ** 2 / (1 + (x - place) ** 2)
    there = least_value(law, {x: (low, high)})
    back = least_value(law.subs(x, -x), {x: (-high, -low)})
    for bound, at in ((there, place), (back, -place)):
        if low <= place <= high:
            assert -0.01 < bound.bound <= bound.met < 0.01
            assert bound.point[x] == pytest.approx(at, abs=0.1)
        else:
            assert bound.bound == pytest.approx(1 - 1 / (1 + (high - place) ** 2), rel=1e-3)
            assert abs(bound.point[x]) == high
