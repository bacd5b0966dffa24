"""Bounded least squares against scipy, and where a bound holds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares, lsq_linear

from teleopdesign.diagnose.least_squares import column_sizes, gauss_newton_step, minimise


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


def test_a_parameter_without_effect_stays_where_it_was():
    jacobian = np.column_stack([np.ones(5), np.zeros(5)])
    free = np.full(2, np.inf)
    optimum = minimise(
        lambda x: (jacobian @ x - 3.0, jacobian), np.array([0.0, 7.0]), -free, free,
        tolerance=1e-10, evaluations=50,
    )  # fmt: skip
    np.testing.assert_allclose(optimum.values, [3.0, 7.0], rtol=1e-6)


def test_steps_that_fail_one_after_another_cost_no_derivatives():
    """Far out on an arc tangent each full step leads beyond the other end."""
    derivatives = []

    def arc(x):
        derivatives.append(float(x[0]))
        return np.arctan(x), np.diag(1.0 / (1.0 + x**2))

    def search(**more):
        derivatives.clear()
        bound = np.full(1, 1e4)
        return minimise(
            arc, np.array([20.0]), -bound, bound, tolerance=1e-9, evaluations=60, **more
        )

    whole, each = search(), list(derivatives)
    alone = search(residual_alone=np.arctan)
    assert alone.values == whole.values == pytest.approx([0.0], abs=1e-6)
    assert set(derivatives) < set(each) and len(derivatives) <= len(each) - 3


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
