"""What the text of a diagnosis adds where nothing is supported, or where records differ."""

from dataclasses import replace

import pytest

from teleopdesign.diagnose.criteria import CRITERIA
from teleopdesign.diagnose.diagnosis import OpenQuestion, SetAside
from teleopdesign.diagnose.ladder_text import ladder_text, sentence
from teleopdesign.report.words import verdict


@pytest.fixture
def unsupported(diagnosis):
    """The diagnosis had its first step added nothing: what was added leads the last ranking."""
    first = diagnosis.rungs[0]
    ranking = diagnosis.rungs[1].ranking
    return replace(diagnosis, verdict="undecided", rungs=(first,), last=ranking, named=())


def test_an_undecided_verdict_says_which_candidate_comes_nearest(unsupported):
    best = unsupported.last.ranked[0]
    error = 100 * best.fit.check_error
    assert f"{best.candidate} comes nearest and would leave {error:.3g} %" in sentence(unsupported)


def test_the_nearest_that_was_set_aside_says_why(unsupported):
    best = unsupported.last.ranked[0]
    assert sentence(unsupported).endswith("on these records this may be chance.")
    aside = SetAside(best.candidate, 0.01, "the command has no influence")
    assert sentence(replace(unsupported, set_aside=(aside,))).endswith(
        f"{100 * best.fit.check_error:.3g} %: the command has no influence."
    )


def test_the_nearest_is_the_same_where_the_answer_was_read_from_a_file(unsupported):
    best = unsupported.last.ranked[0]
    question = OpenQuestion(None, ((best.candidate, best.fit),))
    read = replace(unsupported, open=(question,), last=replace(unsupported.last, ranked=()))
    assert sentence(read) == sentence(unsupported)


def test_a_candidate_that_hardly_helps_is_not_called_nearest(unsupported):
    best = unsupported.last.ranked[0]
    error = (1.0 - 0.5 * CRITERIA.relevant) ** 0.5 * unsupported.after.check_error
    little = replace(best, fit=replace(best.fit, check_error=error))
    less = replace(unsupported, last=replace(unsupported.last, ranked=(little,)))
    assert "nearest" not in sentence(less)
    assert "nearest" not in sentence(replace(less, last=replace(less.last, ranked=())))


@pytest.mark.parametrize(("times", "is_said"), [(0.99, False), (1.01, True), (3.0, True)])
def test_check_records_that_leave_far_more_than_fit_records_are_said_to_differ(
    diagnosis, times, is_said
):
    last = diagnosis.rungs[-1]
    error = times * CRITERIA.differ * last.fit.fit_error
    rungs = (*diagnosis.rungs[:-1], replace(last, fit=replace(last.fit, check_error=error)))
    text = ladder_text(replace(diagnosis, rungs=rungs))
    assert ("records: the error on the check records is" in text) is is_said


@pytest.mark.parametrize(
    ("floors", "held", "is_open"), [(2.2, True, True), (1.1, True, False), (2.2, False, False)]
)
def test_what_sensors_may_have_left_is_not_said_to_miss_more(diagnosis, floors, held, is_open):
    """The floor is held at half of the error; drawn, it is so many times the held one."""
    error = diagnosis.after.check_error
    value = 0.5 * error / max(1.0, diagnosis.left * diagnosis.floor.value / error)
    floor = replace(diagnosis.floor, value=value, drawn=floors * value, held=held)
    there = replace(diagnosis, floor=floor, moment=None)
    assert there.more_is_missing
    assert there.may_be_noise is is_open
    for text in (sentence(there), verdict(there)):
        assert ("do not tell whether more is missing" in text) is is_open
        assert ("more is missing" in text.replace("whether more is missing", "")) is not is_open


@pytest.mark.parametrize(("part", "by_values"), [(0.49, True), (0.51, False), (None, False)])
def test_values_that_the_fit_records_do_not_tell_are_said_to_be_why(diagnosis, part, by_values):
    """Estimated on all records the model leaves less than half of what it leaves otherwise."""
    last = diagnosis.rungs[-1]
    error = 2.0 * CRITERIA.differ * last.fit.fit_error
    rungs = (*diagnosis.rungs[:-1], replace(last, fit=replace(last.fit, check_error=error)))
    on_all = None if part is None else part * error
    text = ladder_text(replace(diagnosis, rungs=rungs, on_all_records=on_all))
    assert ("the fit records alone do not determine the parameters" in text) is by_values
    assert ("the machine was not the same in both" in text) is not by_values
