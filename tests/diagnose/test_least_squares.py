"""Bounded least squares against scipy, and where a bound holds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares, lsq_linear

from teleopdesign.diagnose.least_squares import (
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
