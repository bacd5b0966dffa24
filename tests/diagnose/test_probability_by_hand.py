"""What each step of a ladder says of a candidate, worked out by hand from stated errors."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest
from diagnose.stand_ins import fit, floor, ranked
from diagnose.stub_models import Names, candidate

from teleopdesign.diagnose.free_functions import Belief
from teleopdesign.diagnose.ladder_end import LadderEnd
from teleopdesign.diagnose.probability import (
    CandidateEvidence,
    evidence_of,
    probable,
    shares,
)
from teleopdesign.diagnose.ranking import Ranking
from teleopdesign.diagnose.rung import Rung
from teleopdesign.diagnose.statements import SetAside


def entry(name, error, **more):
    """A candidate with its fit; behind, score, at_command, at_bound and what else is to be said."""
    bound = more.pop("at_bound", ())
    extras = {k: more.pop(k) for k in ("behind", "score") if k in more}
    one = ranked(error, name, **more)
    one.fit.at_bound = bound
    return replace(one, **extras)


def diagnosis(steps, *, last=(), first=0.5, noise=0.1, needs=(), **more):
    """A ladder by its steps: the entries of each, the accepted one first, then alternatives."""
    base = fit(first)
    base.model = Names(frozenset(), tuple(needs))
    rungs = [Rung(None, base)]
    for accepted, alternatives, others in steps:
        ranking = Ranking(rungs[-1].fit, (accepted, *alternatives, *others))
        alike = tuple(r.candidate for r in alternatives)
        rungs.append(Rung(accepted.candidate, accepted.fit, ranking, alike))
    return LadderEnd(
        search=None,
        verdict="effects_missing",
        rungs=tuple(rungs),
        last=Ranking(rungs[-1].fit, tuple(last)),
        estimated=rungs[-1].fit,
        **{"floor": floor(noise), **more},
    )


def test_what_a_step_takes_away_by_hand():
    """0.25 of squares to 0.09, of which 0.01 are noise: 0.08 are left."""
    spring, viscous = entry("spring", 0.3), entry("viscous", 0.4)
    bias = entry("bias", 0.29)
    evidence = evidence_of(diagnosis([(spring, [], [viscous])], last=[bias]))
    of = {e.ranked.candidate.effect.name: e for e in evidence}
    assert [e.accepted for e in evidence] == [True, False, False]
    assert of["spring"].explained == pytest.approx(0.16 / 0.24)
    assert of["viscous"].explained == pytest.approx(0.09 / 0.24)
    assert of["bias"].explained == pytest.approx((0.09 - 0.0841) / 0.08)
    assert [e.left for e in evidence] == pytest.approx([3.0] * 3)
    assert not any(e.from_noise for e in evidence)


def test_what_leaves_more_takes_nothing_away():
    worse = entry("viscous", 0.6)
    (finding,) = evidence_of(diagnosis([], last=[worse]))
    assert (finding.explained, finding.accepted) == (0.0, False)


def test_beside_a_base_that_leaves_no_more_than_the_floor_nothing_is_explained():
    (finding,) = evidence_of(diagnosis([], first=0.1, last=[entry("viscous", 0.1)]))
    assert finding.explained == 0.0 and finding.from_noise
    # where a candidate leaves less than the floor, that is what sensors leave
    (finding,) = evidence_of(diagnosis([], first=0.1, last=[entry("viscous", 0.05)]))
    assert finding.explained == 1.0


@pytest.mark.parametrize(("first", "noise"), [(0.179, True), (0.181, False)])
def test_a_step_begins_at_noise_where_its_base_leaves_less_than_nearly_two_floors(first, noise):
    (finding,) = evidence_of(diagnosis([(entry("spring", 0.11), [], [])], first=first))
    assert finding.from_noise == noise


def test_candidates_that_explain_as_well_are_reported_as_equally_good():
    first, equal, other = (
        entry(n, e) for n, e in (("spring", 0.3), ("bias", 0.3), ("viscous", 0.4))
    )
    evidence = evidence_of(diagnosis([(first, [equal], [other])], last=[entry("bias", 0.29)]))
    assert [(e.accepted, e.as_good) for e in evidence] == [
        (True, False), (False, True), (False, False), (False, False),
    ]  # fmt: skip


def test_what_bars_a_candidate_is_reported_for_those_that_help_and_are_not_accepted():
    spring = entry("spring", 0.3)
    helps, hardly = (
        entry(n, e, implausible="a bristle") for n, e in (("bias", 0.3), ("viscous", 0.499))
    )
    gone = entry("cogging", 0.499)
    aside = (SetAside(gone.candidate, 0.3, "not told from absence"),)
    evidence = evidence_of(diagnosis([(spring, [], [helps, hardly, gone])], set_aside=aside))
    assert [e.barred for e in evidence] == ["", "a bristle", "", "not told from absence"]


def test_those_that_a_step_cannot_tell_apart_share_by_how_far_they_are_behind():
    first, equal = entry("spring", 0.3), entry("viscous", 0.3, behind=1.0)
    other = entry("bias", 0.3, behind=0.0)
    ranking = Ranking(fit(0.5), (first, equal, other))
    rung = Rung(first.candidate, first.fit, ranking, (equal.candidate,))
    portions = shares(ranking, rung)
    part = 1.0 / (1.0 + math.exp(-0.5))
    assert [portions[r.candidate.key] for r in ranking.ranked] == pytest.approx(
        [part, 1 - part, 0.0]
    )
    # the accepted one may be the simplest, not the best: others are measured from it
    behind = replace(first, behind=2.0), replace(equal, behind=3.0), replace(other, behind=0.0)
    moved = Ranking(fit(0.5), behind)
    rung = replace(rung, alternatives=(equal.candidate, other.candidate))
    portions = [shares(moved, rung)[r.candidate.key] for r in moved.ranked]
    whole = 2.0 + math.exp(-0.5)
    assert portions == pytest.approx([1 / whole, math.exp(-0.5) / whole, 1 / whole])


def test_of_a_last_step_all_share_that_count_and_drive_nothing_to_a_bound():
    bound = "device.spring.stiffness"
    rows = [
        entry("spring", 0.3),
        entry("viscous", 0.3, behind=2.0),
        entry("bias", 0.3, at_bound=(bound,)),
        entry("cogging", 0.3, is_identifiable=False),
    ]
    ranking = Ranking(fit(0.5), tuple(rows))
    part = 1.0 / (1.0 + math.exp(-2.0))
    for rung in (None, Rung(None, ranking.base, ranking)):
        portions = shares(ranking, rung)
        assert [portions[r.candidate.key] for r in rows] == pytest.approx(
            [part, 1 - part, 0.0, 0.0]
        )
    # what the base has at a bound itself was driven there by none of them
    ranking.base.at_bound = (bound,)
    assert shares(ranking, None)["bias", "device"] == pytest.approx(
        shares(ranking, None)["spring", "device"]
    )
    none = Ranking(fit(0.5), (rows[3],))
    assert shares(none, None) == {("cogging", "device"): 0.0}


EVIDENCE = CandidateEvidence(
    SimpleNamespace(score=50.0), accepted=True, as_good=False, share=1.0, explained=0.9, left=1.0
)


@pytest.mark.parametrize(
    ("changed", "probability"),
    [
        ({}, 0.97),
        ({"left": 1.8}, 0.97),
        ({"left": 3.6}, 0.0),
        ({"left": 3.6, "belief": Belief(0.9, 0.0, "velocity")}, 0.97 * 0.81),
        ({"left": math.inf, "belief": Belief(2.0, 0.0, "velocity")}, 0.97),
        ({"share": 0.25}, 0.97 / 4),
        ({"ranked": SimpleNamespace(score=0.0)}, 0.97 / 2),
        ({"from_noise": True}, 0.97 * 0.9),
        ({"at_most": 0.3}, 0.3),
        ({"accepted": False}, 0.03 * 0.9),
        ({"accepted": False, "share": 0.5, "explained": 0.2}, 0.003),
        ({"accepted": False, "as_good": True, "share": 0.5}, 0.97 / 2),
    ],
)
def test_a_probability_is_its_parts(changed, probability):
    assert replace(EVIDENCE, **changed).probability() == pytest.approx(probability)


def test_what_is_as_likely_as_not_is_named():
    """Two that share: 0.97 of 0.516 is half."""
    for behind, named in [(0.36, True), (0.35, False)]:
        first, equal = entry("spring", 0.12, score=50.0), entry("viscous", 0.12, behind=behind)
        whole = diagnosis([(first, [equal], [])])
        part = 1.0 / (1.0 + math.exp(-0.5 * behind**2))
        assert (0.97 * part >= 0.5) == named
        assert probable(whole) == ((candidate("spring"),) if named else ())


def test_an_effect_is_no_more_likely_than_what_it_needs():
    """Friction beyond a transmission, and the transmission that the records hardly show."""
    on = entry("spring", 0.3, score=0.0)  # half by chance
    beyond = entry("bias", 0.11, score=50.0)
    plain = diagnosis([(on, [], []), (beyond, [], [])])
    likely = [e.probability() for e in evidence_of(plain)]
    assert likely == pytest.approx([0.97 / 2, 0.97]) and probable(plain) == (candidate("bias"),)
    bound = diagnosis([(on, [], []), (beyond, [], [])], needs=[("bias", "spring")])
    likely = [e.probability() for e in evidence_of(bound)]
    assert likely == pytest.approx([0.97 / 2, 0.97 / 2]) and probable(bound) == ()
    other = diagnosis(
        [(beyond, [], []), (replace(on, fit=fit(0.1)), [], [])], needs=[("spring", "bias")]
    )
    assert [e.probability() for e in evidence_of(other)] == pytest.approx([0.97, 0.97 / 2])
