"""Numbers and verdicts in words."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.diagnose.ranking import Ranking
from teleopdesign.report.words import (
    join_names,
    number,
    percent,
    short,
    typeset,
    unit_text,
    verdict,
    with_error,
)

FINITE = st.floats(-1e12, 1e12).filter(lambda x: x == 0 or abs(x) > 1e-12)


def read(text):
    """The value of a printed number."""
    digits = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻−", "0123456789--")
    head, _, power = text.partition("·10")
    return float(head.translate(digits)) * 10.0 ** int(power.translate(digits) or 0)


@given(FINITE, st.integers(2, 6))
def test_a_number_reads_back_to_its_digits(x, digits):
    # half a unit of the last digit kept, and rounding of the power of ten
    assert read(number(x, digits)) == pytest.approx(x, rel=0.51 * 10.0 ** (1 - digits), abs=0)
    assert read(short(x, digits)) == read(number(x, digits))


@given(FINITE, st.floats(1e-9, 1e6))
def test_a_value_and_its_error_are_printed_to_the_same_decimal(x, error):
    value, spread = with_error(x, error)
    assert read(spread) == pytest.approx(error, rel=0.06)  # two significant digits
    # a value with 7 digits or more is cut there
    assert read(value) == pytest.approx(x, rel=1e-6, abs=0.051 * 10 * error)


@pytest.mark.parametrize(
    ("printed", "expected"),
    [
        (number(0.19717), "0.1972"),
        (number(-12300.0), "−12300"),
        (number(1.2e-6, 2), "1.2·10⁻⁶"),
        (number(None), "–"),
        (number(math.nan), "–"),
        (number(0.0), "0"),
        (short(60.0), "60"),
        (short(7.2e-6), "7.2·10⁻⁶"),
        (percent(0.07071), "7.07\u202f%"),
        (unit_text("N*s/m"), "N·s/m"),
        (unit_text("kg*m^2"), "kg·m²"),
        (unit_text("1"), ""),
        (join_names(["a"]), "a"),
        (join_names(["a", "b", "c"], "or"), "a, b or c"),
        (with_error(0.19717, 0.00081), ("0.19717", "0.00081")),
        (with_error(1.0, None), ("1.000", "–")),
    ],
)
def test_numbers_are_printed_as_a_person_would(printed, expected):
    assert printed == expected


def test_the_verdict_names_the_effect_and_both_errors(diagnosis):
    text = verdict(diagnosis)
    assert text.startswith(
        "Your model lacks stribeck at device. With it, the force error on records"
    )
    before, after = diagnosis.before.check_error, diagnosis.after.check_error
    assert f"from {100 * before:.2f}\u202f% to {100 * after:.2f}\u202f%" in text


def test_look_alikes_are_named_together(diagnosis):
    first, second = diagnosis.rungs
    other = next(r.candidate for r in second.ranking.ranked if r.candidate.key != second.added.key)
    alike = replace(
        diagnosis, verdict="undecided", rungs=(first, replace(second, alternatives=(other,)))
    )
    text = verdict(alike)
    assert text.startswith(f"Undecided between stribeck at device or {other}: these records cannot")


def test_an_adequate_model_and_an_unexplained_rest_are_said_as_such(diagnosis):
    only = replace(diagnosis, rungs=diagnosis.rungs[:1], last=Ranking(diagnosis.before, ()))
    assert "Your model is adequate" in verdict(replace(only, verdict="model_adequate"))
    undecided = verdict(replace(only, verdict="undecided"))
    assert "no effect that was tried explains it" in undecided
    assert only.left > 5.0
    assert f"{only.left:.1f} times what sensor noise" in undecided


def test_effects_that_help_too_little_are_said_to(diagnosis):
    first, second = diagnosis.rungs
    little = replace(second.fit, check_error=0.9 * first.fit.check_error)
    rungs = (first, replace(second, fit=little))
    text = verdict(replace(diagnosis, verdict="undecided", rungs=rungs, named=()))
    assert "stribeck at device helps, but explains less than half" in text


def test_effects_that_explain_most_but_are_unlikely_are_said_to(diagnosis):
    text = verdict(replace(diagnosis, verdict="undecided", named=()))
    assert text.startswith("Undecided: with stribeck at device the force error")
    assert "less likely than not" in text


@pytest.mark.parametrize(
    ("sentence", "printed"),
    [
        ("travels 2 rad, at 3 +- 0.1 N*m*s^2/rad^2.", "Travels 2 rad, at 3 ± 0.1 N·m·s²/rad²."),
        ("channels.time.unit was guessed", "channels.time.unit was guessed"),
        ("01_epoch.csv: 2*x^2 is a formula", "01_epoch.csv: 2*x² is a formula"),
        ("10 kg*m^20", "10 kg·m^20"),
    ],
)
def test_sentences_of_a_terminal_are_typeset(sentence, printed):
    assert typeset(sentence) == printed
