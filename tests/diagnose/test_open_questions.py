"""Open questions of a diagnosis: which effects may replace an accepted one, and how many."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from diagnose.stand_ins import fit, floor, ranked

from teleopdesign.diagnose.open_questions import open_questions
from teleopdesign.diagnose.ranking import Ranking
from teleopdesign.diagnose.rung import Rung
from teleopdesign.diagnose.search_plan import PLAN

OTHERS = ("viscous", "spring", "bias", "cogging", "gravity", "coulomb", "shear_thinning")


def diagnosis(
    *,
    rungs=(),
    last=(),
    noise=0.1,
    verdict="effects_missing",
    short=False,
):
    return SimpleNamespace(
        more_is_missing=short,
        rungs=(Rung(None, fit(1.0)), *rungs),
        last=Ranking(fit(1.0), tuple(last)),
        floor=floor(noise),
        verdict=verdict,
    )


def rung(added, *others, base, alternatives=()):
    ranking = Ranking(fit(base), (added, *others))
    return Rung(added.candidate, added.fit, ranking, tuple(r.candidate for r in alternatives))


def names(question):
    return [rival.candidate.effect.name for rival in question.others]


@pytest.mark.parametrize("size", [0.1, 1.0, 10.0])
def test_what_leaves_less_than_one_floor_more_is_open(size):
    """In quadrature: 0.3 and a floor of 0.1 are 0.316."""
    added = ranked(0.3 * size)
    near = ranked((0.09 + 0.00999) ** 0.5 * size, "viscous")
    far = ranked((0.09 + 0.01001) ** 0.5 * size, "spring")
    better = ranked(0.2 * size, "bias")
    one = rung(added, near, far, better, base=size)
    (question,) = open_questions(diagnosis(rungs=[one], noise=0.1 * size))
    assert question.added == added.candidate
    assert names(question) == ["bias", "viscous"], "what leaves least comes first"
    assert [rival.model for rival in question.others] == [better.fit.model, near.fit.model]
    assert [rival.check_error for rival in question.others] == [
        better.fit.check_error,
        near.fit.check_error,
    ]


def test_what_is_not_supported_is_open_only_where_it_is_an_alternative():
    added = ranked(0.3)
    unsure = ranked(0.301, "viscous", is_identifiable=False)
    equal, far = ranked(0.302, "spring"), ranked(0.8, "bias")
    plain = rung(added, unsure, equal, far, base=1.0)
    assert [names(q) for q in open_questions(diagnosis(rungs=[plain]))] == [["spring"]]
    # alternatives come first, whatever they leave
    group = rung(added, unsure, equal, far, base=1.0, alternatives=[far])
    assert [names(q) for q in open_questions(diagnosis(rungs=[group]))] == [["bias", "spring"]]


def test_no_question_is_asked_where_nothing_else_would_do():
    alone = rung(ranked(0.3), ranked(0.8, "viscous"), base=1.0)
    assert open_questions(diagnosis(rungs=[alone])) == ()
    group = rung(ranked(0.3), ranked(0.3, "viscous"), base=1.0)
    two = open_questions(diagnosis(rungs=[group, alone, group]))
    assert [q.added for q in two] == [group.added, group.added]


def test_a_question_holds_as_many_as_can_be_distinguished_at_once():
    many = [ranked(0.3 + 1e-4 * k, n) for k, n in enumerate(OTHERS)]
    (question,) = open_questions(diagnosis(rungs=[rung(ranked(0.3), *many, base=1.0)]))
    assert names(question) == list(OTHERS[: PLAN.rivals - 1])
    rest = [replace(r, score=0.5) for r in many]
    (question,) = open_questions(diagnosis(last=rest, verdict="undecided"))
    assert question.added is None and names(question) == list(OTHERS[: PLAN.rivals - 1])


def test_an_undecided_verdict_asks_for_what_gains_and_counts():
    gains, loses = replace(ranked(0.9), score=0.1), replace(ranked(0.9, "spring"), score=-0.1)
    unsure = ranked(0.5, "viscous", is_identifiable=False)
    same = replace(ranked(1.0, "bias"), score=0.0)  # it changes nothing
    last = (gains, unsure, same, loses)
    (question,) = open_questions(diagnosis(last=last, verdict="undecided"))
    assert (question.added, names(question)) == (None, ["stribeck"])
    assert open_questions(diagnosis(last=last)) == ()
    assert open_questions(diagnosis(last=last, verdict="model_adequate")) == ()
    (next_one,) = open_questions(diagnosis(last=last, short=True))
    assert next_one == question, "more is missing beside what is named"
    assert open_questions(diagnosis(last=(loses,), verdict="undecided")) == ()
