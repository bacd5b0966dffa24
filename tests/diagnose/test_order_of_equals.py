"""Which candidates pass for equal, simpler or alike, each condition alone and at its limit."""

import numpy as np
import pytest
from diagnose.stand_ins import SHAPE, fit, floor, ranked

from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.order import (
    alternatives_of,
    look_alikes_of,
    rank_key,
    select_equals,
    select_other_helpers,
    select_simplest,
)
from teleopdesign.diagnose.ranking import Ranking
from teleopdesign.effects import EFFECTS

#: rows that have nothing in common with `SHAPE`
ASIDE = np.roll(SHAPE, 1) - (np.roll(SHAPE, 1) @ SHAPE) * SHAPE
ASIDE /= np.linalg.norm(ASIDE)


def alike(error, like, effect="viscous", **more):
    """A candidate with an error of its own, whose residuals are those of another."""
    return ranked(error, effect, residual=like.fit.check_residual, **more)


@pytest.mark.parametrize("error", [0.01, 0.3, 5.0])
def test_errors_of_the_same_figure_are_equal_where_residuals_do_not_differ(error):
    best = ranked(error)
    for part, equal in [(0.0299, True), (0.0301, False)]:  # of the squares
        for sign in (1, -1):
            other = alike(error * (1 + sign * part) ** 0.5, best)
            assert select_equals([best, other]) == ([best, other] if equal else [best])


def beside(error, score):
    """What leaves more than `error * SHAPE`, on fit and check records alike, by such a score.

    It leaves x of `ASIDE` more: a gain of 2 x^2 over twice error x times the root of the summed
    squares of all blocks' products of the two shapes.
    """
    products = (ASIDE * SHAPE).reshape(-1, 10).sum(axis=1)
    x = score * error * float(np.sqrt(2 * products @ products))
    return error * SHAPE + x * ASIDE


@pytest.mark.parametrize("error", [0.01, 0.3, 5.0])
def test_residuals_that_differ_by_three_deviations_are_not_equal_though_errors_are(error):
    best = ranked(error)
    for score, equal in [(2.99, True), (3.01, False)]:
        other = ranked(error, "viscous", residual=beside(error, score))
        assert select_equals([best, other]) == ([best, other] if equal else [best])


def test_the_best_is_always_among_its_equals_and_is_held_against_all():
    best = ranked(0.3)
    # each is near the one before it: what counts is the distance from the best
    near = alike(0.3044, best)
    assert select_equals([best, near, alike(0.3089, best)]) == [best, near]
    assert select_equals([ranked(0.0)]) != [], "an error of nothing is near itself"


def test_of_equals_the_one_beside_the_users_effects_is_taken_then_the_simplest():
    best = ranked(0.3, "cogging")  # three parameters
    simple = alike(0.3001, best, "gravity")  # two
    instead = alike(0.3001, best, "spring", instead_of=Candidate(EFFECTS["viscous"], "device"))
    assert select_simplest([best, simple, instead]) is simple
    assert select_simplest([best, instead]) is best
    assert select_simplest([instead]) is instead


def test_what_does_as_well_with_as_many_parameters_is_an_alternative():
    """As many that must be estimated; what it needs, and what is optional, do not count."""
    base, best = fit(0.6), ranked(0.3, "presliding")  # one, needs friction, one optional
    one = alike(0.3001, best, "spring")  # one, needs nothing
    two = alike(0.3002, best, "stribeck")  # two, needs friction
    worse = ranked(0.4, "bias")
    nothing = alike(0.3003, best, "quadratic_drag", is_identifiable=False)
    ranking = Ranking(base, (best, one, two, nothing, worse))
    assert alternatives_of(best, ranking, base, floor(0.01)) == (one.candidate,)
    of_two = Ranking(base, (two, alike(0.3003, best, "gravity"), one))
    assert [c.effect.name for c in alternatives_of(two, of_two, base, floor(0.01))] == ["gravity"]


def test_only_what_the_records_support_is_an_alternative():
    base, best = fit(0.6), ranked(0.3, "presliding")
    ranking = Ranking(base, (best, alike(0.3001, best, "spring")))
    assert alternatives_of(best, ranking, fit(0.301), floor(0.29)) == ()


@pytest.mark.parametrize("size", [0.1, 1.0, 10.0])
def test_half_of_what_the_best_takes_away_is_enough_to_help(size):
    base, best = fit(size), ranked(0.6 * size)  # takes away 0.64
    helps = ranked(size * (1 - 0.321) ** 0.5, "viscous")
    hardly = ranked(size * (1 - 0.319) ** 0.5, "spring")
    worse = ranked(1.2 * size, "bias")
    unsure = ranked(0.6 * size, "cogging", is_identifiable=False)
    ranking = Ranking(base, (best, helps, hardly, worse, unsure))
    assert select_other_helpers(best, ranking) == (helps.candidate,)
    # the others of a worse best: all that take away half of that
    assert select_other_helpers(hardly, ranking) == (best.candidate, helps.candidate)


def test_of_two_that_do_the_same_the_first_of_the_catalogue_stays_first():
    """To six digits: the seventh is another machine's arithmetic."""
    one, other = ranked(0.3), ranked(0.3 * (1 - 1e-8), "viscous")
    assert sorted([one, other], key=rank_key) == [one, other]
    better = ranked(0.3 * (1 - 1e-4), "viscous")
    assert sorted([one, better], key=rank_key) == [better, one]


def test_a_candidate_that_only_a_pair_supports_has_look_alikes_too():
    """A bias beside a gain was called an asymmetry of friction, with certainty."""
    base, one = fit(0.31), ranked(0.3, "coulomb_asymmetry")
    same, worse = alike(0.3001, one, "bias"), ranked(0.32, "spring")
    nothing = alike(0.3, one, "viscous", is_identifiable=False)
    two = alike(0.3, one, "stribeck")  # two parameters
    ranking = Ranking(base, (ranked(0.2, "cogging"), one, same, worse, nothing, two))
    assert look_alikes_of(one, ranking) == (same.candidate,)
    assert look_alikes_of(worse, ranking) == ()
