"""Bounded least squares against scipy, and where a bound holds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares, lsq_linear

from teleopdesign.diagnose.least_squares import (
    LEAST_DAMPING,
    column_sizes,
    gauss_newton_step,
    minimise,
)


@settings(max_examples=40)
@given(seed=st.integers(0, 2**31))
def test_a_linear_problem_with_bounds_is_solved_exactly(seed):
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(12, 4)), rng.normal(size=12)
    lower = np.where(rng.random(4) < 0.3, -np.inf, rng.uniform(-0.5, 0.0, 4))
    upper = np.where(rng.random(4) < 0.3, np.inf, rng.uniform(0.0, 0.5, 4))
    optimum = minimise(
        lambda x: (a @ x - b, a), np.zeros(4), lower, upper, tolerance=1e-12, evaluations=200
    ).values
    known = lsq_linear(a, b, (lower, upper), tol=1e-14).x
    assert np.all((optimum >= lower) & (optimum <= upper))
    # the same sum of squares; the point itself may be flat
    assert np.sum((a @ optimum - b) ** 2) <= np.sum((a @ known - b) ** 2) * (1 + 1e-6)


@pytest.mark.parametrize("start", [(-1.2, 1.0), (2.0, -1.0), (0.0, 0.5)])
def test_a_curved_valley_is_followed_to_its_end(start):
    def rosenbrock(x):
        return (
            np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]]),
            np.array([[-20 * x[0], 10.0], [-1.0, 0.0]]),
        )

    free = np.full(2, np.inf)
    optimum = minimise(rosenbrock, np.array(start), -free, free, tolerance=1e-12, evaluations=200)
    np.testing.assert_allclose(optimum.values, [1.0, 1.0], atol=1e-4)
    bounded = minimise(
        rosenbrock,
        np.array(start),
        -free,
        np.array([0.5, np.inf]),
        tolerance=1e-12,
        evaluations=200,
    )
    np.testing.assert_array_equal(bounded.residual, rosenbrock(bounded.values)[0])
    np.testing.assert_array_equal(bounded.jacobian, rosenbrock(bounded.values)[1])
    known = least_squares(lambda x: rosenbrock(x)[0], (0.0, 0.0), bounds=(-free, [0.5, np.inf])).x
    np.testing.assert_allclose(bounded.values, known, atol=1e-3)


def test_no_step_follows_columns_whose_squares_overflow():
    """A motion that grows leaves finite columns of 1e200: neither a step nor a warning."""
    grown = np.array([[1.0, 1e200], [2.0, -1e200]])
    assert np.array_equal(column_sizes(grown), [np.sqrt(5.0), np.inf])
    bound = np.full(2, np.inf)
    assert np.isnan(gauss_newton_step(grown, np.ones(2), -bound, bound)).all()
    start = np.array([0.5, 0.25])
    stayed = minimise(
        lambda x: (np.ones(2), grown), start, -bound, bound, tolerance=1e-6, evaluations=9
    )
    assert np.array_equal(stayed.values, start)


def jacobians(rng):
    """Jacobian (n, p) and residual (n,): regular, singular, proportional, or of extreme size."""
    n, p = int(rng.integers(1, 40)), int(rng.integers(1, 8))
    jacobian, residual = rng.normal(size=(n, p)), rng.normal(size=n)
    kind = rng.choice(["regular", "singular", "proportional", "nearly", "zero"])
    first, last = jacobian[:, [0]], jacobian[:, [-1]]
    if kind == "singular":
        jacobian = (
            jacobian @ rng.normal(size=(p, max(p // 2, 1))) @ rng.normal(size=(max(p // 2, 1), p))
        )
    elif kind == "proportional":
        jacobian[:, [-1]] = rng.normal() * first
    elif kind == "nearly":
        jacobian[:, [-1]] = first + 10.0 ** rng.uniform(-17, -6) * last
    elif kind == "zero":
        jacobian[:, int(rng.integers(p))] = 0.0
    sizes = 10.0 ** rng.uniform(-140, 140, p) if rng.random() < 0.5 else np.ones(p)
    return jacobian * sizes, residual * 10.0 ** rng.uniform(-9, 9)


@pytest.mark.parametrize("cases", [300, pytest.param(3000, marks=pytest.mark.slow)])
def test_a_step_is_the_damped_least_squares_step_whatever_the_jacobian(cases):
    """Held against numpy's lstsq of all rows; damping falls to nothing during a search."""
    rng = np.random.default_rng(cases)
    for _ in range(cases):
        jacobian, residual = jacobians(rng)
        p, damping = jacobian.shape[1], 10.0 ** rng.uniform(-25, 3)
        free = np.full(p, np.inf)
        step = gauss_newton_step(jacobian, residual, -free, free, damping)
        size = column_sizes(jacobian)
        size[size == 0.0] = 1.0
        rows = np.vstack([jacobian / size, np.sqrt(damping + LEAST_DAMPING) * np.eye(p)])
        right = np.append(-residual, np.zeros(p))
        known = np.linalg.lstsq(rows, right, rcond=None)[0]
        # along flat directions the steps may differ, what they change may not: rounding is
        # amplified once by the condition, at most 1e6 by the least damping
        off = np.linalg.norm(rows @ (step * size - known))
        assert off <= 1e-8 * np.linalg.norm(residual)

        reach = np.maximum(np.abs(known), 1e-12 * np.linalg.norm(residual))
        low, high = -rng.random(p) * reach, rng.random(p) * reach
        inside = gauss_newton_step(jacobian, residual, low / size, high / size, damping) * size
        assert np.all((inside >= low * (1 + 1e-9)) & (inside <= high * (1 + 1e-9)))
        best = lsq_linear(rows, right, (low, high), method="bvls").cost
        assert 0.5 * np.sum((rows @ inside - right) ** 2) <= best * (1 + 1e-7)
