"""What a diagnosis decides at the limits of its thresholds, each from both sides.

Fits are stand-ins that hold the numbers which a decision reads: no record is fitted here.
"""

from math import inf
from types import SimpleNamespace

import numpy as np
import pytest
from diagnose.stand_ins import fit, floor, ranked, rung

from teleopdesign.diagnose.adequacy import (
    floors_left,
    is_a_tone,
    is_adequate,
    is_noise,
    limit_noise_floor,
)
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.decision import (
    helps_but_is_barred,
    is_better,
    objection,
    refusal,
    worth_pursuing,
)
from teleopdesign.diagnose.order import (
    rank_key,
    select_equals,
    select_other_helpers,
    select_simplest,
    simplicity,
)
from teleopdesign.diagnose.verdict import explained_share, verdict
from teleopdesign.effects import EFFECTS

MORE, LESS = 1.0 + 1e-9, 1.0 - 1e-9


def test_up_to_nearly_two_floors_are_noise():
    assert is_noise(0.18, floor()) and not is_noise(0.18 * MORE, floor())
    assert is_adequate(fit(0.18), floor()) and not is_adequate(fit(0.18 * MORE), floor())
    # at the command the floor is half as large there
    half = floor(at_command=0.5)
    assert is_adequate(fit(0.1, at_command=0.09), half)
    assert not is_adequate(fit(0.1, at_command=0.09 * MORE), half)
    assert is_adequate(fit(0.1, blind=0.25), floor())
    assert not is_adequate(fit(0.1, blind=0.2501), floor()), "blind in much of the motion"


def test_a_model_that_leaves_nothing_is_adequate_though_sensors_leave_nothing_too():
    """As of a simulated record that was not rounded."""
    assert is_noise(0.0, floor(0.0)) and is_adequate(fit(0.0), floor(0.0))
    assert not is_adequate(fit(1e-12), floor(0.0))


def test_a_plain_tone_is_held_against_the_floor_by_what_it_leaves():
    model = fit(0.4)
    # squares of the residual are those of the error here
    tone = SimpleNamespace(squares=0.179**2)
    assert is_a_tone(model, tone, floor())
    assert not is_a_tone(model, SimpleNamespace(squares=0.181**2), floor())
    assert is_a_tone(fit(0.0), tone, floor()), "nothing is left"


def test_floors_left_are_those_of_the_larger_error():
    assert floors_left(fit(0.3, at_command=0.1), floor()) == pytest.approx(3.0)
    assert floors_left(fit(0.1, at_command=0.3), floor(at_command=0.5)) == pytest.approx(6.0)
    assert floors_left(fit(0.3), floor(0.0)) == inf
    blind = fit(0.3)
    blind.at_command.error = inf
    assert floors_left(blind, floor()) == inf


def test_what_is_explained_is_the_smaller_part_of_the_squares_above_the_floor():
    # (0.25 - 0.09) / (0.25 - 0.01) of the force; (0.25 - 0.16) / 0.24 at the command
    part = explained_share(fit(0.5, at_command=0.5), fit(0.3, at_command=0.4), floor())
    assert part == pytest.approx(0.09 / 0.24)
    assert explained_share(fit(0.5), fit(0.3), floor()) == pytest.approx(0.16 / 0.24)


def test_no_step_explains_more_of_the_force_than_the_last_fit_does():
    """From 175 to 115 % of the force, of which 91 % is left: a position with its sign turned."""
    turned = explained_share(fit(1.75), fit(0.91), floor())
    assert turned == pytest.approx((1.0 - 0.91**2) / (1.0 - floor().value ** 2))
    # a spring at its resonance: the motor's force is a fifth of the spring's
    assert explained_share(fit(5.0), fit(0.1), floor()) > 0.98


def test_a_floor_is_no_more_than_the_records_leave():
    left = SimpleNamespace(ranked=(ranked(0.3), ranked(0.2), ranked(0.1, refused="blind")))
    assert limit_noise_floor(floor(0.5), fit(0.4), left).value == 0.2
    assert limit_noise_floor(floor(0.15), fit(0.4), left).value == 0.15
    assert limit_noise_floor(floor(0.5, jitters=True), fit(0.4), left).value == 0.4


def test_what_makes_a_force_unpredictable_or_only_smaller_has_not_explained_it():
    base = fit(0.5)
    assert refusal(base, fit(0.3)) == ""
    assert refusal(base, fit(0.3, blind=0.25)) == ""
    assert refusal(base, fit(0.3, blind=0.26)) == "blind"
    # a base that is blind itself bars what makes it a quarter more so
    assert refusal(fit(0.5, blind=0.3), fit(0.3, blind=0.5)) == ""
    assert refusal(fit(0.5, blind=0.3), fit(0.3, blind=0.56)) == "blind"
    assert refusal(fit(0.5, blind=0.2), fit(0.3, blind=0.26)) == "blind"
    # three hundredths of the squares: less of the force, and no less at the command
    assert refusal(base, fit(0.5 * 0.96**0.5, at_command=0.5)) == "hides"
    assert refusal(base, fit(0.5 * 0.98**0.5, at_command=0.5)) == ""


def test_a_gain_counts_from_three_hundredths_of_the_squares_and_half_a_floor():
    low = floor(0.01)
    assert is_better(fit(0.5), fit(0.5 * 0.96**0.5), low)
    assert not is_better(fit(0.5), fit(0.5 * 0.98**0.5), low)
    assert not is_better(fit(0.5), fit(0.6), low)
    # half of the floor's square: 0.5 * 0.2^2 / 0.5^2 = 0.08 of the squares
    assert is_better(fit(0.5), fit(0.5 * 0.91**0.5), floor(0.2))
    assert not is_better(fit(0.5), fit(0.5 * 0.93**0.5), floor(0.2))
    # at the command as well
    assert not is_better(fit(0.5), fit(0.3, at_command=0.5), low)
    assert not is_better(fit(0.5), fit(0.3, blind=0.3), low)


@pytest.mark.parametrize(("score", "counts"), [(3.99, False), (4.01, True)])
def test_a_gain_counts_from_four_standard_deviations_of_its_chance(score, counts):
    # one row in each of nine blocks goes from 1 + c to 1: its score is 3 (1 + c / 2)
    one_each = np.zeros(400)
    one_each[:360:40] = 1.0
    before = (1.0 + 2.0 * (score / 3.0 - 1.0)) * one_each
    base = fit(float(np.linalg.norm(before)), residual=before)
    other = fit(3.0, residual=one_each)
    base.check_blocks = other.check_blocks = np.repeat(np.arange(10), 40)
    assert is_better(base, other, floor(1e-3)) == counts


def test_one_check_bars_a_candidate_however_much_it_explains():
    base = fit(0.5)
    assert objection(base, ranked(0.3), floor()) == ""
    assert "no influence in more than a quarter" in objection(
        base, ranked(0.3, refused="blind"), floor()
    )
    assert (
        objection(base, ranked(0.3, implausible="stands for a spring"), floor())
        == "stands for a spring"
    )


def test_what_bars_an_effect_is_reported_only_where_the_effect_helps():
    base, bar = fit(0.5), "stands for a spring"
    assert helps_but_is_barred(base, ranked(0.5 * 0.96**0.5, implausible=bar), floor()) == bar
    assert helps_but_is_barred(base, ranked(0.5 * 0.98**0.5, implausible=bar), floor()) == ""


def test_a_first_step_is_followed_for_a_hundredth_or_where_little_is_left_for_a_ninth():
    # only noise: 0.5 floor^2 against a third of what is left
    assert worth_pursuing(fit(0.1), floor(0.1)) == pytest.approx(1 / 9)
    edge = (1.5) ** 0.5 * 0.1
    assert worth_pursuing(fit(edge * LESS), floor(0.1)) == pytest.approx(1 / 9)
    assert worth_pursuing(fit(edge * MORE), floor(0.1)) == 0.01


def test_candidates_that_count_come_first_then_those_that_leave_less():
    rows = [
        ranked(0.2, refused="blind"),
        ranked(0.4),
        ranked(0.3),
        ranked(0.1, is_identifiable=False),
    ]
    rows.append(ranked(0.05, implausible="stands for a spring"))
    assert [r.fit.check_error for r in sorted(rows, key=rank_key)] == [0.3, 0.4, 0.05, 0.1, 0.2]


def test_the_simplest_of_those_that_explain_as_well_is_taken():
    # stribeck has two parameters and needs coulomb, viscous has one and needs nothing
    assert simplicity(ranked(0.3).candidate) == (2, 1, 0)
    assert simplicity(ranked(0.3, "viscous").candidate) == (1, 0, 0)
    assert simplicity(ranked(0.3, "load_dependent_friction").candidate) == (1, 1, 4)
    best, near, far = ranked(0.3), ranked(0.3 * 1.0001, "viscous"), ranked(0.31, "spring")
    assert select_equals([best, near, far]) == [best, near]
    assert select_equals([]) == []
    assert select_simplest([best, near, far]) is near
    other = ranked(0.3, "viscous", instead_of=Candidate(EFFECTS["spring"], "device"))
    assert select_simplest([best, other]) is best, "what the user's model has is believed"


def test_what_takes_away_half_of_what_the_best_does_is_named_beside_it():
    base, best = fit(1.0), ranked(0.5)  # takes away 0.75 of the squares
    half = ranked((1 - 0.376) ** 0.5, "viscous")
    less = ranked((1 - 0.374) ** 0.5, "spring")
    barred = ranked(0.5, "cogging", refused="blind")
    ranking = SimpleNamespace(base=base, ranked=(best, half, less, barred))
    assert select_other_helpers(best, ranking) == (half.candidate,)


def test_the_verdict_names_effects_unless_all_of_them_look_alike():
    one = Candidate(EFFECTS["stribeck"], "device")
    assert verdict([rung(0.18)], floor()) == "model_adequate"
    assert verdict([rung(0.19)], floor()) == "undecided"
    assert verdict([rung(0.5), rung(0.2, one)], floor()) == "effects_missing"
    assert verdict([rung(0.5), rung(0.2, one, (one,))], floor()) == "undecided", "all look alike"
    two = [rung(0.5), rung(0.3, one, (one,)), rung(0.2, one)]
    assert verdict(two, floor()) == "effects_missing"


def test_of_no_error_at_all_nothing_is_less():
    """As of a still record whose force is a power of two."""
    assert not is_better(fit(0.0), fit(0.0), floor(0.0))
    assert not is_better(fit(0.0), fit(0.1), floor(0.0))
    assert is_better(fit(0.1), fit(0.0), floor(0.0))
