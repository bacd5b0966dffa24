"""Numbers and verdicts in words."""

from dataclasses import replace

from teleopdesign.diagnose.statements import Alternative
from teleopdesign.show.report.candidate_table import sentence_of, verdict


def test_the_verdict_names_the_effect_and_both_errors(diagnosis):
    text = verdict(diagnosis)
    assert text.startswith("Your model lacks stribeck at device. The force error on records")
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
    assert undecided.startswith("Undecided. No") and only.left > 5.0
    assert f"explains the {only.left:.1f} noise floors that are left" in undecided


def test_an_entry_of_a_diagnosis_is_a_sentence_and_nothing_is_none():
    assert sentence_of("what is left") == "What is left."
    assert sentence_of(None) == sentence_of("") == ""
