"""Parts of the proof of a late root, each against a closed form or plain arithmetic."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import lambertw

from teleopdesign.passivity.intervals import late_roots
from teleopdesign.passivity.intervals.late_roots import holds_root, rightmost_root
from teleopdesign.passivity.intervals.late_terms import LateTerms

SMALL = st.fractions(-3, 3, max_denominator=50)
TIMES = st.fractions(0, 2, max_denominator=20)


@pytest.mark.parametrize("time", [1e-3, 0.2, 1.0, 50.0])
@pytest.mark.parametrize("gain", [0.1, 0.3, 1.0, 2.0, 6.0, -0.5])
def test_the_rightmost_root_of_an_integrator_with_a_late_gain_is_lamberts(gain, time):
    """s + (g/T) e^(-s T) is zero at W(-g)/T, whatever the unit of time."""
    late = {0.0: np.array([1.0, 0.0]), time: np.array([gain / time])}
    root, expected = rightmost_root(late), complex(lambertw(-gain)) / time
    assert root.real == pytest.approx(expected.real, rel=1e-6)
    assert abs(root.imag) == pytest.approx(abs(expected.imag), rel=1e-6, abs=1e-9 / time)
    exact = {Fraction(t): [Fraction(c) for c in p] for t, p in late.items()}
    radius = holds_root(exact, root)
    assert radius is not None
    nearest = min(abs(root - expected), abs(root - expected.conjugate()))
    assert nearest <= radius < 0.1 * abs(root)
    # a disc is shown about no point that is further from every root than it is wide
    other = holds_root(exact, root * 1.5)
    assert other is None or abs(root * 0.5) <= other


@given(st.lists(SMALL, min_size=1, max_size=4), SMALL, SMALL)
def test_a_polynomial_and_its_slope_are_those_of_numpy(coefficients, x, y):
    at, plain = complex(x, y), [float(c) for c in coefficients]
    real, imaginary = late_roots._value(coefficients, (x, y))
    assert complex(real, imaginary) == pytest.approx(np.polyval(plain, at), rel=1e-9, abs=1e-9)
    slopes = [float(c) for c in late_roots._slopes(coefficients)]
    assert slopes == pytest.approx(list(np.polyder(plain)) if len(plain) > 1 else [])


@settings(max_examples=25)
@given(
    st.dictionaries(TIMES, st.lists(SMALL, min_size=1, max_size=3), min_size=1, max_size=3),
    SMALL, SMALL,
)  # fmt: skip
def test_value_and_slope_at_a_point_lie_within_their_tight_bounds(terms, x, y):
    with mpmath.workdps(40):
        s = mpmath.mpc(
            mpmath.mpf(x.numerator) / x.denominator, mpmath.mpf(y.numerator) / y.denominator
        )

        def f(z):
            return mpmath.fsum(
                mpmath.polyval([mpmath.mpf(c.numerator) / c.denominator for c in p], z)
                * mpmath.exp(-z * mpmath.mpf(t.numerator) / t.denominator)
                for t, p in terms.items()
            )

        sizes = [abs(f(s)) ** 2, abs(mpmath.diff(f, s)) ** 2]
        scale = max(1, *sizes)
        for (low, high), size in zip(late_roots._enclose_at(terms, x, y), sizes, strict=True):
            assert low <= size + scale * 1e-25 and high >= size - scale * 1e-25
            assert high - low <= 1e-12 * scale


@pytest.mark.parametrize("degree", [0, 1, 2])
def test_the_bound_of_the_rest_of_a_series_is_met_where_all_its_terms_add(degree):
    """Of p e^(-s T) about -b, further left, with signs by which every term is positive."""
    base, radius, time = Fraction(3, 2), Fraction(1, 4), Fraction(2, 5)
    sizes = [Fraction(2), Fraction(1, 3), Fraction(5, 7)][: degree + 1]
    p = [c * (-1) ** (degree - i) for i, c in enumerate(sizes)]
    plain = np.array([float(c) for c in p])

    def f(s):
        return np.polyval(plain, s) * np.exp(-s * float(time))

    def slope(s):
        derivative = np.polyval(np.polyder(plain), s) if degree else 0.0
        return (derivative - float(time) * np.polyval(plain, s)) * np.exp(-s * float(time))

    at, r = -float(base), float(radius)
    rest = abs(f(at - r) - f(at) + r * slope(at))
    bound = float(late_roots._further(p, time, -base, base, radius))
    assert bound == pytest.approx(rest, rel=1e-9)
    # elsewhere on the circle, and about any other point, the rest is smaller
    for turn in np.exp(1j * np.linspace(0, 2 * np.pi, 60)):
        assert abs(f(at + r * turn) - f(at) - r * turn * slope(at)) <= bound * (1 + 1e-9)


def test_terms_at_a_point_are_those_of_their_powers():
    """2 s^2 v + 3 s w e^(-s T) - v^2 w e^(-s (T + U)), at v, w, T of a point; U is fixed."""
    made = LateTerms(
        (Fraction(2), Fraction(3), Fraction(-1)),
        np.array([[2, 1, 0, 0, 0], [1, 0, 1, 1, 0], [0, 2, 1, 1, 1]]),
        ((Fraction(0), Fraction(1)),) * 2,
        ((Fraction(0), Fraction(1)), (Fraction(0), Fraction(1, 4))),
        (1, 0),
        (2, -1),
    )
    assert made.degree == 2
    point = np.array([0.5, 3.0, 0.125])  # w, v, T
    expected = {
        Fraction(0): [Fraction(6), 0, 0],
        Fraction(1, 8): [Fraction(3, 2), 0],
        Fraction(3, 8): [Fraction(-9, 2)],
    }
    assert made.exactly_at(point) == expected
    floats = made.at(point)
    assert {t: list(p) for t, p in floats.items()} == {
        0.0: [1.0, 0.0, 0.0], 0.125: [0.25, 0.0], 0.375: [-0.75],
    }  # fmt: skip
    groups = made.groups()
    assert [list(b) for b, _ in groups] == [[0, 0], [1, 0], [1, 1]]
    assert [list(which) for _, which in groups] == [[0], [1], [2]]
