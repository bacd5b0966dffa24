"""Intervals of laws hold every value, and the least value found is a bound that is met."""

from math import inf

import mpmath
import pytest
import sympy as sp
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from teleopdesign.realise.enclosure import enclosure_of
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


@settings(max_examples=40)
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
        (sp.atan(1 / X), {X: (-1.0, 2.0)}, -sp.pi.evalf() / 2),
        (sp.atan(sp.tan(X)), {X: (-2.0, 1.0)}, -sp.pi.evalf() / 2),
    ],
)
def test_the_least_value_is_known_to_the_stated_tightness(law, over, least):
    lowest = least_value(law, over)
    # what a law is compared with: its value at the middle of the ranges, at most 3 here
    assert least - 3 * TIGHTNESS <= lowest.bound <= least + 1e-14
    assert lowest.met >= least - 1e-14


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
