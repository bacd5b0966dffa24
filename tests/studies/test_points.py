"""Axes of a study: products of grids, points drawn together, and what is refused."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import loguniform

from teleopdesign.base.errors import ModelError
from teleopdesign.studies import latin_hypercube, random_samples, sensitivity_samples, sobol
from teleopdesign.studies.points import points_of

TWO = {"a": (0.0, 1.0), "b": (2.0, 4.0)}


def test_two_axes_are_their_product_with_the_last_one_first():
    points = points_of({"a": [1, 2], "b": [10.0, 20.0, 30.0], "c": 5})
    assert [points.at(i) for i in (0, 1, 3)] == [
        {"a": 1, "b": 10.0, "c": 5},
        {"a": 1, "b": 20.0, "c": 5},
        {"a": 2, "b": 10.0, "c": 5},
    ]
    assert len(points) == 6


@given(st.integers(1, 40), st.integers(0, 5))
def test_the_table_of_points_is_each_point(size, seed):
    points = points_of([{"c": [0, 1, 2]}, random_samples(TWO, size, seed=seed)])
    table = points.table(0, len(points))
    for i in (0, len(points) // 2, len(points) - 1):
        assert points.at(i) == {n: column[i] for n, column in table.items()}


@given(st.integers(1, 60), st.integers(0, 3))
def test_a_latin_hypercube_has_one_point_in_each_slice(size, seed):
    drawn = latin_hypercube(TWO, size, seed=seed)
    slices = np.floor(size * (drawn.values - [0, 2]) / [1, 2]).astype(int)
    assert all(sorted(column) == list(range(size)) for column in slices.T)


@pytest.mark.parametrize("draw", [latin_hypercube, sobol, random_samples, sensitivity_samples])
def test_a_seed_gives_the_same_points_again_and_another_seed_others(draw):
    assert draw(TWO, 8, seed=3) == draw(TWO, 8, seed=3)
    assert draw(TWO, 8, seed=3) != draw(TWO, 8, seed=4)


def test_points_for_sensitivity_are_those_that_salib_expects():
    drawn = sensitivity_samples({"a": (0, 1), "b": (0, 1), "c": (0, 1)}, 4, seed=1).values
    rows = drawn.reshape(4, 5, 3)
    for block in rows:
        for i in range(3):
            expected = block[0].copy()
            expected[i] = block[-1][i]
            np.testing.assert_array_equal(block[i + 1], expected)


def test_a_range_with_a_step_gives_whole_steps_only():
    drawn = random_samples({"delay": (0.0, 2e-3, 1e-4)}, 500, seed=1).values[:, 0]
    steps = drawn / 1e-4
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)
    assert {round(s) for s in steps} == set(range(21))


def test_a_distribution_of_scipy_is_a_range():
    drawn = latin_hypercube({"a": loguniform(1e-3, 1.0)}, 300, seed=1).values[:, 0]
    # of a log-uniform distribution over three decades a third lies in each
    assert (drawn < 1e-2).sum() == 100


@pytest.mark.parametrize(
    ("ranges", "count", "text"),
    [
        ({}, 4, "found no range"),
        ({"a": (1.0, 1.0)}, 4, "expected low < high"),
        ({"a": 3.0}, 4, "expected \\(low, high\\)"),
        ({"a": (0.0, 1.0, 2.0)}, 4, "found a step of 2"),
        (TWO, 0, "expected 1 to"),
        (TWO, 1000, "did you mean 1024"),
    ],
)
def test_ranges_that_have_no_meaning_are_refused(ranges, count, text):
    with pytest.raises(ModelError, match=text):
        sobol(ranges, count)
