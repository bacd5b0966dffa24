"""Friction of parallel rods in the hand's coordinates, against random geometries and forces."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.diagrams import felt_friction


def random_friction(seed, n):
    random = np.random.default_rng(seed)
    g = random.normal(size=(n, n)) + 2 * np.eye(n)
    return felt_friction(g, random.uniform(0.1, 1.0, n)), random


cases = given(seed=st.integers(0, 2**32 - 1), n=st.integers(1, 6))
ROUNDING = 1e-9  # sums and inverses of up to six numbers


@cases
def test_friction_felt_lies_between_smallest_and_largest(seed, n):
    felt, random = random_friction(seed, n)
    u = random.normal(size=(200, n))
    u /= np.linalg.norm(u, axis=1)[:, None]
    h = felt.along(u)
    assert h.min() >= felt.smallest[0] * (1 - ROUNDING)
    assert h.max() <= felt.largest[0] * (1 + ROUNDING)


@cases
def test_a_moving_hand_loses_the_work_of_the_support_function(seed, n):
    felt, random = random_friction(seed, n)
    u = random.normal(size=(20, n))
    assert -(felt.force(u) * u).sum(axis=1) == pytest.approx(felt.along(u))


@cases
def test_only_forces_within_every_level_can_be_friction(seed, n):
    felt, random = random_friction(seed, n)
    rods = random.uniform(-1, 1, (50, n)) * felt.levels
    assert felt.holds(rods @ felt.geometry).all()
    too_much = rods.copy()
    too_much[:, 0] = 1.001 * felt.levels[0]
    assert not felt.holds(too_much @ felt.geometry).any()
