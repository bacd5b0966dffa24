"""The probability of a candidate follows from what the ladder found of it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.criteria import CRITERIA
from teleopdesign.diagnose.evidence import whole_score
from teleopdesign.diagnose.free_functions import Belief
from teleopdesign.diagnose.identifiability import is_identifiable
from teleopdesign.diagnose.order import rank_key
from teleopdesign.diagnose.probability import (
    CandidateEvidence,
    evidence_of,
    select_independent,
    shares,
)
from teleopdesign.diagnose.rung import restore_replaced
from teleopdesign.effects import EFFECTS


class Scored:
    """A ranked candidate of which only the score is asked."""

    def __init__(self, score):
        self.score = score


EVIDENCE = CandidateEvidence(
    Scored(50.0), accepted=True, as_good=False, share=1.0, explained=0.9, left=1.0
)


#: also of candidates whose model runs away
SCORES = st.floats(-50, 500) | st.sampled_from([float("nan"), float("inf"), -float("inf")])


@given(left=st.floats(0, 100), share=st.floats(0, 1), score=SCORES)
def test_it_is_a_probability(left, share, score):
    for accepted in (True, False):
        one = replace(
            EVIDENCE, ranked=Scored(score), accepted=accepted, share=share, left=left
        ).probability()
        assert 0.0 <= one <= 1.0


def test_it_is_judged_by_its_form_alone_where_more_than_noise_is_left():
    one = replace(EVIDENCE, belief=Belief(0.6, 0.0, "velocity"))
    probabilities = [
        replace(one, left=x).probability() for x in (0.8, CRITERIA.adequate, 2.5, 4.0, 30.0)
    ]
    assert probabilities[0] == probabilities[1] > 0.9
    assert probabilities[2] == probabilities[3] == probabilities[4] < 0.5


def test_beside_a_model_that_leaves_only_noise_an_effect_is_believed_by_what_it_takes_away():
    """Of 1.6 floors 1.4 are left: less than half of what sensors do not explain."""
    part = (1.6**2 - 1.4**2) / (1.6**2 - 1.0)
    added = replace(EVIDENCE, left=1.4, explained=part)
    assert added.probability() == pytest.approx(0.97)
    assert replace(added, from_noise=True).probability() == pytest.approx(0.97 * part)
    assert replace(added, from_noise=True).probability() < 0.5


def test_what_was_not_accepted_is_improbable():
    assert replace(EVIDENCE, accepted=False).probability() < 0.05


def test_those_as_good_share_what_the_accepted_one_has():
    one = replace(EVIDENCE, share=0.5)
    other = replace(EVIDENCE, share=0.5, accepted=False, as_good=True)
    assert one.probability() == other.probability() == pytest.approx(EVIDENCE.probability() / 2)


def test_an_accepted_effect_keeps_its_share_with_a_parameter_at_a_bound(end):
    rung = end.rungs[1]
    first = rung.ranking.ranked[0]
    bound = replace(first.fit, at_bound=("device.stribeck.extra_static_level",))
    ranking = replace(rung.ranking, ranked=(replace(first, fit=bound), *rung.ranking.ranked[1:]))
    assert shares(ranking, rung)[first.candidate.key] == pytest.approx(1.0)
    assert shares(ranking, None)[first.candidate.key] == 0.0, "it was not accepted"


def test_every_candidate_of_every_step_has_its_evidence(end):
    evidence = evidence_of(end)
    rankings = [*(r.ranking for r in end.rungs if r.ranking), end.last]
    assert len(evidence) == sum(len(k.ranked) for k in rankings)
    assert [e.ranked.candidate.key for e in evidence if e.accepted] == [("stribeck", "device")]


def test_each_candidate_is_behind_the_first_by_its_score_on_all_records(end):
    for ranking in (*(r.ranking for r in end.rungs if r.ranking), end.last):
        first, *others = ranking.ranked
        assert first.behind == 0.0
        for one in others:
            assert one.behind == whole_score(one.fit, first.fit)
        counted = [rank_key(r) for r in ranking.ranked]
        assert counted == sorted(counted)


def test_what_a_step_explains_is_the_part_of_the_squares_above_the_floor(end):
    floor = 0.9 * end.after.check_error
    evidence = evidence_of(replace(end, floor=replace(end.floor, value=floor)))
    bases = [r.ranking.base for r in end.rungs if r.ranking for _ in r.ranking.ranked]
    bases += [end.last.base for _ in end.last.ranked]
    for one, base in zip(evidence, bases, strict=True):
        before, after = base.check_error, one.ranked.fit.check_error
        above = before**2 - min(floor, after) ** 2
        part = (before**2 - after**2) / above if above > 0 else 0.0
        assert one.explained == pytest.approx(min(max(part, 0.0), 1.0))
    assert max(one.explained for one in evidence) > 0.5


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize(("share", "is_determined"), [(0.0, False), (0.019, False), (0.021, True)])
def test_a_new_parameter_is_determined_by_the_part_that_no_other_imitates_whatever_its_unit(
    end, size, share, is_determined
):
    fit, base = end.after, end.before
    new = [i for i, n in enumerate(fit.free) if n not in base.free]
    old = [i for i in range(len(fit.free)) if i not in new]
    assert is_identifiable(fit, base)
    columns = fit.jacobian.copy()
    span, _ = np.linalg.qr(columns[:, old])
    alone = np.random.default_rng(0).standard_normal(len(columns))
    alone -= span @ (span.T @ alone)
    alone /= np.linalg.norm(alone)
    alike = columns[:, old[0]] / np.linalg.norm(columns[:, old[0]])
    columns[:, new] = size * ((1 - share**2) ** 0.5 * alike + share * alone)[:, None]
    assert is_identifiable(replace(fit, jacobian=columns), base) == is_determined


@pytest.mark.parametrize("structure", ["transmission_compliance", "backlash"])
def test_an_effect_is_not_named_without_the_accepted_one_that_it_needs(end, structure):
    on, friction = (Candidate(EFFECTS[n], "device") for n in (structure, "tip_friction"))
    first = end.rungs[0]
    model = replace(end.before.model, known=EFFECTS)
    first = replace(first, fit=replace(first.fit, model=model))
    rungs = (first, *(replace(end.rungs[-1], added=c) for c in (on, friction)))
    whole = replace(end, rungs=rungs)
    assert select_independent(whole, {on.key, friction.key}) == (on, friction)
    assert select_independent(whole, {friction.key}) == ()
    assert select_independent(whole, {on.key}) == (on,)


def test_an_effect_is_named_beside_one_that_took_the_place_of_the_users(end):
    """A damper alone was stated, and a level that bristles need took its place."""
    level, bristles = (Candidate(EFFECTS[n], "device") for n in ("coulomb", "presliding"))
    bare = replace(end.before.model, known=EFFECTS)
    for name, at in reversed(bare.effects):
        bare = bare.without_effect(name, at=at)
    stated = bare.with_effect("viscous", at="device")
    first = replace(end.rungs[0], fit=replace(end.before, model=stated))
    place = restore_replaced(Candidate(EFFECTS["viscous"], "device"), stated)
    rungs = (
        first,
        replace(end.rungs[-1], added=level, replaced=place),
        replace(end.rungs[-1], added=bristles),
    )
    whole = replace(end, rungs=rungs)
    assert select_independent(whole, {level.key, bristles.key}) == (level, bristles)
    assert select_independent(whole, {bristles.key}) == ()


def test_an_effect_is_believed_by_what_it_explains_compare_free_functions(end):
    floor = replace(end.floor, value=0.1 * end.after.check_error)
    added = end.rungs[-1].added

    def probability(rho):
        beliefs = {} if rho is None else {added.key: Belief(rho, 0.0, "velocity")}
        noisy = replace(end, floor=floor, beliefs=beliefs)
        return next(e.probability() for e in evidence_of(noisy) if e.accepted)

    values = [probability(rho) for rho in (None, -1.0, 0.5, 0.71, 0.73, 1.0, math.inf)]
    assert values == sorted(values) and values[:2] == [0.0, 0.0]
    assert values[3] < CRITERIA.named <= values[4] and values[5] == values[6]
