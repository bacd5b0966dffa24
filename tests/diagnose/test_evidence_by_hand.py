"""Gains and scores of two fits against their definitions, row by row."""

from types import SimpleNamespace

import numpy as np
import pytest

from teleopdesign.diagnose.evidence import (
    check_score,
    check_squares,
    gain_at_command,
    gain_score,
    score_at_command,
    whole_score,
)


def score_by_hand(before, after, labels):
    """Gain in squares over twice the root of the summed squares of each block's products."""
    gain, products = 0.0, {}
    for b, a, label in zip(before, after, labels, strict=True):
        gain += b * b - a * a
        products[label] = products.get(label, 0.0) + (b - a) * a
    return gain / (2.0 * sum(p * p for p in products.values()) ** 0.5)


def drawn(rng, rows, size=1.0):
    """Residuals of a fit and of a better one, and blocks of uneven length."""
    after = size * rng.standard_normal(rows)
    before = after + 0.4 * size * rng.standard_normal(rows)
    return before, after, np.sort(rng.integers(0, 6, rows))


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("seed", range(5))
def test_a_score_is_the_gain_over_its_chance_part_of_blocks(seed, size):
    before, after, blocks = drawn(np.random.default_rng(seed), 40, size)
    assert gain_score(before, after, blocks) == pytest.approx(score_by_hand(before, after, blocks))


@pytest.mark.parametrize("size", [0.01, 1.0, 30.0])
def test_residuals_count_as_the_same_up_to_a_thousandth_of_the_smaller(size):
    after = -size * np.linspace(0.5, 2.0, 60)
    blocks = np.arange(60) // 10
    assert gain_score(after * (1 + 0.99e-3), after, blocks) == 0.0
    assert gain_score(after * (1 + 1.01e-3), after, blocks) > 0.0
    assert gain_score(after * (1 - 1.01e-3), after, blocks) < 0.0


def test_a_gain_without_a_chance_part_is_sure():
    """What the better model explains has nothing in common with what it leaves."""
    after = np.tile([1e-3, 0.0], 30)
    before = after + np.tile([0.0, 1e-3], 30)
    assert gain_score(before, after, np.arange(60) // 10) > 1e6


def fit(residual, *, error=1.0, sighted=None, fit_residual=(1.0,), blocks=None, fit_blocks=None):
    """A fit by what it leaves on the check records, of the force and at the command alike."""
    left = np.asarray(residual, dtype=float)
    sighted = np.ones(len(left), dtype=bool) if sighted is None else np.array(sighted)
    blocks = np.zeros(len(left), dtype=int) if blocks is None else np.asarray(blocks)
    fit_blocks = np.zeros(len(fit_residual), dtype=int) if fit_blocks is None else fit_blocks
    return SimpleNamespace(
        check_residual=left,
        check_blocks=blocks,
        fit_residual=np.asarray(fit_residual, dtype=float),
        fit_blocks=np.asarray(fit_blocks),
        at_command=SimpleNamespace(residual=left, sighted=sighted, error=error),
    )


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_a_gain_at_the_command_is_what_its_squares_or_its_errors_say_the_smaller(size):
    before, after = fit(size * np.array([2.0, 1.0]), error=0.5), size * np.array([1.0, -1.0])
    # of squares 5 to 2; of errors 0.5 to 0.3, then to 0.4 and to 0.6
    assert gain_at_command(before, fit(after, error=0.3)) == pytest.approx(0.6)
    assert gain_at_command(before, fit(after, error=0.4)) == pytest.approx(1 - 0.64)
    assert gain_at_command(before, fit(after, error=0.6)) == pytest.approx(1 - 1.44)


def test_rows_that_either_fit_is_blind_to_speak_for_neither():
    sighted = [True, True, True, False]
    before = fit([2.0, 1.0, 9.0, 0.0], error=0.5, sighted=sighted[::-1])
    after = fit([1.0, 1.0, 0.0, 9.0], error=0.1, sighted=sighted)
    # the second and third row are left: squares 82 and 1
    assert gain_at_command(before, after) == pytest.approx(1 - (0.1 / 0.5) ** 2)
    more = fit([1.0, 9.0, 4.0, 0.0], error=0.1)
    assert gain_at_command(before, more) == pytest.approx(1 - 97 / 82)


def test_where_both_see_nothing_nothing_is_gained():
    none = [False, False]
    assert gain_at_command(fit([2.0, 1.0], sighted=none), fit([1.0, 1.0], error=0.5)) == 0.0
    assert score_at_command(fit([2.0, 1.0], sighted=none), fit([1.0, 1.0])) == 0.0


@pytest.mark.parametrize("seed", range(5))
def test_a_score_at_the_command_is_that_of_the_rows_that_both_see(seed):
    rng = np.random.default_rng(seed)
    before, after, blocks = drawn(rng, 40)
    here, there = rng.random(40) < 0.7, rng.random(40) < 0.7
    both = here & there
    one, other = fit(before, sighted=here), fit(after, sighted=there, blocks=blocks)
    expected = score_by_hand(before[both], after[both], blocks[both])
    assert score_at_command(one, other) == pytest.approx(expected)
    assert check_score(one, other) == pytest.approx(score_by_hand(before, after, blocks))
    assert check_squares(one) == pytest.approx(sum(r * r for r in before))


@pytest.mark.parametrize("seed", range(5))
def test_blocks_of_fit_and_check_records_are_never_one(seed):
    """Both count from zero; what is correlated within a record is not so between two."""
    rng = np.random.default_rng(seed)
    (b1, a1, k1), (b2, a2, k2) = drawn(rng, 40), drawn(rng, 30)
    before = fit(b2, fit_residual=b1, blocks=k2, fit_blocks=k1)
    after = fit(a2, fit_residual=a1, blocks=k2, fit_blocks=k1)
    labels = [("fit", k) for k in k1] + [("check", k) for k in k2]
    expected = score_by_hand([*b1, *b2], [*a1, *a2], labels)
    assert whole_score(before, after) == pytest.approx(expected)
