"""The KYP inequality against the exact test, and storage functions in exact numbers."""

import numpy as np
import pytest
import sympy as sp
from passivity.random_impedances import KINDS, random_impedance

from teleopdesign.base.errors import ModelError
from teleopdesign.derive.polynomials import fraction
from teleopdesign.passivity import damping_excess, impedance, kyp, positive_real, storage_function
from teleopdesign.passivity.linear.kyp import sum_of_squares
from teleopdesign.realise.lti import S


@pytest.fixture
def cvxpy():
    """The solver's front end, where it is installed."""
    return pytest.importorskip("cvxpy", reason="the extra `lmi` is not installed")


def test_without_cvxpy_it_says_how_to_get_it(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "cvxpy", None)
    with pytest.raises(ModelError, match=r"teleopdesign\[lmi\]"):
        kyp(S + 1 / (S + 1))


@pytest.mark.parametrize(
    "z",
    [
        0.15 * S + 4 + 300 / S,
        (S**2 + S + 1) / (S + 1) ** 2,
        (S**2 - 0.1 * S + 1) / (S + 1) ** 2,
        1 / (S + 1),
        S / (0.2 * S**2 + 3 * S + 100),
        (S**2 + 4) / (S * (S**2 + 9)),
        1e-6 * S + 1e6 + 1e6 / S,
        (S + 1) / (S - 2),
        -S,
        1 / S**2,
        7,
    ],
    ids=str,
)
def test_the_inequality_finds_the_exact_excess_of_damping(z, cvxpy):
    """Largest c with a storage function for Z - c; the solver stops at 1e-8 of the size of Z."""
    exact = float(damping_excess(z))
    assert kyp(z).damping_excess == pytest.approx(exact, rel=1e-5, abs=1e-7)


@pytest.mark.parametrize(
    "z",
    [
        0.15 * S + 4 + 300 / S,
        1 / (S + 1),
        1 / S,
        S / (0.2 * S**2 + 3 * S + 100),
        (S**2 + S + 1) / (S + 1) ** 2,
        (S**2 + 4) / (S * (S**2 + 9)),
    ],
    ids=str,
)
def test_a_storage_function_in_exact_numbers(z, cvxpy):
    """Improper, lossless and lossy; the checker verifies it as it does friction."""
    claim = storage_function(z)
    assert claim.status == "proved"
    (certificate,) = claim.certificates
    assert certificate.kind == "storage"
    certificate.check()


@pytest.mark.parametrize("z", [(S**2 - 0.1 * S + 1) / (S + 1) ** 2, 1 / (S - 1), -S, S**2, -1])
def test_there_is_none_for_an_active_impedance(z, cvxpy):
    assert storage_function(z).status == "unknown"


def test_sums_of_squares_are_exact():
    f = [[fraction(sp.Rational(x)) for x in row] for row in ([4, 2, 0], [2, 1, 0], [0, 0, 3])]
    squares = sum_of_squares(f)
    x = sp.symbols("x0:3")
    total = sum(
        sp.Rational(str(w)) * sum(sp.Rational(str(c)) * e for c, e in zip(row, x, strict=True)) ** 2
        for w, row in squares
    )
    expected = sum(sp.Rational(str(f[i][j])) * x[i] * x[j] for i in range(3) for j in range(3))
    assert sp.expand(total - expected) == 0
    assert len(squares) == 2  # it is only semidefinite
    assert sum_of_squares([[fraction(sp.Integer(0)), fraction(sp.Integer(1))]] * 2) is None


def lowest_real_part(z):
    """(min over frequency of Re Z(j w), size of Z between its corners): a sweep, then refined.

    -inf where a pole lies in the right half plane.
    """
    p, q = ([float(c) for c in poly.all_coeffs()] for poly in (z.p, z.q))
    poles = np.roots(q)
    if np.any(poles.real > 1e-7 * np.abs(poles)):
        return -np.inf, 1.0
    corners = np.abs(np.concatenate([poles, np.roots(p)]))
    corners = corners[corners > 0] if np.any(corners > 0) else np.array([1.0])
    w = np.geomspace(1e-4 * corners.min(), 1e4 * corners.max(), 4001)
    inside = w[(w >= corners.min() / 2) & (w <= 2 * corners.max())]
    size = float(np.median(np.abs(np.polyval(p, 1j * inside) / np.polyval(q, 1j * inside))))
    w = np.concatenate([[1e-9 * corners.min()], w, [1e9 * corners.max()]])
    with np.errstate(divide="ignore", invalid="ignore"):
        for _ in range(5):
            values = np.polyval(p, 1j * w) / np.polyval(q, 1j * w)
            near = np.min(np.abs(w[:, None] - np.abs(poles.imag)), axis=1) if len(poles) else w
            values[near < 1e-3 * w] = np.nan  # rounding beside a pole on the axis
            k = int(np.nanargmin(values.real))
            lowest = float(values.real[k])
            w = np.linspace(w[max(k - 1, 0)], w[min(k + 1, len(w) - 1)], 401)
    return lowest, size


def contradiction(z, *, lmi):
    """In words, where exact test, inequality and sweep contradict each other; "" where not.

    Tolerances: relative to the typical size of Z at its corners. The solver stops at about 1e-8 of
    it and loses some digits to poles on the axis; the sweep is limited by rounding.
    """
    claim, excess = positive_real(z), float(damping_excess(z))
    if (claim.status == "proved") != (excess >= 0):
        return f"{claim.status}, excess {excess:g}"
    lowest, size = lowest_real_part(z)
    scale = max(size, abs(excess) if np.isfinite(excess) else 0.0)
    if np.isfinite(excess) and abs(lowest - excess) > 1e-5 * scale:
        return f"exact {excess:g}, sweep {lowest:g}"
    if claim.status == "proved" and lowest < -1e-7 * scale:
        return f"proved, but the sweep finds {lowest:g}"
    if lmi:
        solution = kyp(z)
        # where the solver calls its own answer inaccurate, some digits less
        tolerance = 1e-3 if solution.status == "optimal" else 0.1
        # -inf: the inequality then fails by as little as one likes, the further below c is
        none = solution.damping_excess < -1e3 * scale
        if none != np.isinf(excess):
            return f"exact {excess:g}, inequality {solution.damping_excess:g} of {scale:g}"
        if not none and abs(solution.damping_excess - excess) > tolerance * scale:
            return f"exact {excess:g}, inequality {solution.damping_excess:g} ({solution.status})"
    return ""


def test_exact_test_and_sweep_agree_on_random_impedances():
    rng = np.random.default_rng(7)
    for kind in KINDS * 2:
        z = impedance(random_impedance(rng, kind))
        assert contradiction(z, lmi=False) == "", f"{kind}: {z}"


@pytest.mark.slow
def test_exact_test_inequality_and_sweep_agree_on_a_hundred_and_more_random_impedances(cvxpy):
    """Seven kinds, 20 each: passive by construction, improper, marginal, growing, badly scaled."""
    rng = np.random.default_rng(11)
    statuses, proved = [], 0
    for kind in KINDS * 20:
        z = impedance(random_impedance(rng, kind))
        proved += positive_real(z).status == "proved"
        if problem := contradiction(z, lmi=True):
            statuses.append(f"{kind}: {z}: {problem}")
    assert statuses == []
    assert 20 < proved < 120  # both verdicts are exercised
