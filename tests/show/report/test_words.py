"""Numbers and verdicts in words."""

from dataclasses import replace

from teleopdesign.base.sentences import (
    number_on_page,
)
from teleopdesign.diagnose.statements import Alternative
from teleopdesign.show.report.words import sentence_of, verdict


def test_the_verdict_names_the_effect_and_both_errors(diagnosis):
    text = verdict(diagnosis)
    assert text.startswith(
        "Your model lacks stribeck at device. With this effect, the force error on records"
    )
    before, after = diagnosis.before.check_error, diagnosis.after.check_error
    assert f"from {100 * before:.2f}\u202f% to {100 * after:.2f}\u202f%" in text


def test_look_alikes_are_named_together(diagnosis):
    first, second = diagnosis.rungs
    other = diagnosis.candidates[-1].candidate
    second = replace(second, alternatives=(Alternative(other),))
    alike = replace(diagnosis, verdict="undecided", rungs=(first, second))
    text = verdict(alike)
    assert text.startswith(f"Undecided, stribeck at device or {other}: these records do not")


def test_an_adequate_model_and_an_unexplained_rest_are_reported_as_such(diagnosis):
    only = replace(diagnosis, rungs=diagnosis.rungs[:1])
    assert "Your model is adequate" in verdict(replace(only, verdict="model_adequate"))
    undecided = verdict(replace(only, verdict="undecided"))
    assert "no candidate effect explains the remaining force" in undecided
    assert only.left > 5.0
    assert f"{only.left:.1f} times what sensor noise" in undecided


def test_effects_that_explain_most_but_are_unlikely_are_reported_as_such(diagnosis):
    text = verdict(replace(unnamed(diagnosis), verdict="undecided"))
    assert text.startswith("Undecided: with stribeck at device the force error")
    assert "less likely than not" in text


def unnamed(diagnosis):
    """The diagnosis with no effect probable enough to be named."""
    return replace(diagnosis, rungs=tuple(replace(r, named=False) for r in diagnosis.rungs))


def two_added(diagnosis):
    """A ladder whose second effect is not probable enough to be named."""
    first, second = diagnosis.rungs
    other = diagnosis.candidates[-1].candidate
    rungs = (first, second, replace(second, added=other, named=False))
    return replace(diagnosis, rungs=rungs), other


def test_an_effect_that_helps_and_is_not_named_is_reported_beside_those_that_are(diagnosis):
    both, other = two_added(diagnosis)
    text = verdict(both)
    assert text.startswith(
        "Your model lacks stribeck at device. With all added effects, the force error"
    )
    assert f" {other} helps, but is less likely than not." in text
    each = verdict(replace(unnamed(both), verdict="undecided"))
    assert f"with stribeck at device and {other} the force error" in each
    assert "but each is less likely than not" in each


def with_floor(diagnosis, *, floors, drawn=1.0):
    """The diagnosis with a floor of which the last model leaves so many."""
    value = diagnosis.after.check_error / floors
    floor = replace(diagnosis.floor, value=value, drawn=drawn * value, at_command=1.0)
    return replace(diagnosis, floor=floor)


def test_what_is_left_is_near_noise_or_more_is_missing(diagnosis):
    near = verdict(with_floor(diagnosis, floors=1.5))
    assert "The remaining error is near what sensor noise alone would leave, " in near
    far = with_floor(diagnosis, floors=4.0, drawn=3.0)
    assert f"error is {number_on_page(far.left, 2)} times what sensor noise" in verdict(far)
    assert "more is missing." in verdict(far)


def test_an_entry_of_a_diagnosis_is_a_sentence_and_nothing_is_none():
    assert sentence_of("what is left") == "What is left."
    assert sentence_of(None) == sentence_of("") == ""
