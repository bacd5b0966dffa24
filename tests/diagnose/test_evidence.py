"""Gains and standard errors under residuals that are correlated, by simulation."""

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from teleopdesign.diagnose.evidence import gain_score
from teleopdesign.diagnose.fit import standard_errors
from teleopdesign.diagnose.solve import BLOCK

RATE, N = 300.0, 6000  # a record of 20 s after thinning
BLOCKS = (np.arange(N) / RATE / BLOCK).astype(int)
LOW_PASS = butter(4, 15, fs=RATE, output="sos")


def noise(rng):
    """Residuals correlated over some 30 ms, as a low-pass leaves them."""
    return sosfiltfilt(LOW_PASS, rng.standard_normal(N))


def test_the_chance_part_of_a_gain_has_the_size_that_the_score_says():
    """A difference unrelated to what is left gains its own square; the rest scores about +-1."""
    rng = np.random.default_rng(3)
    z = []
    for _ in range(300):
        after, difference = noise(rng), 0.05 * noise(rng)
        scale = np.sum(difference**2)
        score = gain_score(after + difference, after, BLOCKS)
        gain = 2 * difference @ after + scale
        z.append(score * (gain - scale) / gain)  # the score without what is truly explained
    # 300 draws: sd of the mean 0.06, of the sd 4 %; 80 blocks estimate the size to some 10 %
    assert abs(np.mean(z)) < 0.2
    assert 0.85 < np.std(z) < 1.15


def test_standard_errors_cover_under_correlated_residuals():
    """Of 300 estimates about two in three lie within one standard error of the truth."""
    rng = np.random.default_rng(5)
    t = np.arange(N) / RATE
    jacobian = np.column_stack(
        [np.sign(np.sin(2 * np.pi * 0.9 * t)), np.cos(2 * np.pi * 3.1 * t), t]
    )
    solve = np.linalg.pinv(jacobian)
    inside, naive = [], []
    for _ in range(300):
        r = noise(rng)
        estimate = solve @ r  # the truth is zero
        residual = r - jacobian @ estimate
        errors = standard_errors(jacobian, residual, BLOCKS)
        inside.append(np.abs(estimate) < errors)
        white = np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)) * np.var(residual))
        naive.append(np.abs(estimate) < white)
    covered = np.mean(inside, axis=0)
    # 0.683; 300 draws: sd 0.027; the errors themselves are known to 10 % from 80 blocks
    assert np.all((covered > 0.58) & (covered < 0.79))
    assert np.mean(naive, axis=0).min() < 0.5, "as if samples were independent: too sure"


@pytest.mark.parametrize("size", [1e160, np.inf, np.nan])
def test_a_search_that_ran_off_leaves_no_standard_error_and_no_traceback(size):
    """A gain and a force that grow together leave the figure as it is, until numbers overflow."""
    rng = np.random.default_rng(7)
    jacobian = np.column_stack([np.ones(N), rng.standard_normal(N)])
    spoiled = jacobian.copy()
    spoiled[:, 1] *= size
    with np.errstate(over="ignore", invalid="ignore"):
        assert np.isnan(standard_errors(spoiled, noise(rng), BLOCKS)).all()
        assert np.isnan(standard_errors(jacobian, np.full(N, np.nan), BLOCKS)).all()
