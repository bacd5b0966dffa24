"""Numbers and verdicts in words."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.diagnose import ladder_text
from teleopdesign.diagnose.one_moment import Moment
from teleopdesign.diagnose.statements import Alternative
from teleopdesign.show.report.words import (
    join_names,
    number,
    percent,
    sentence_of,
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


def test_effects_that_help_too_little_are_reported_as_such(diagnosis):
    first, second = diagnosis.rungs
    little = replace(second, check_error=0.9 * first.check_error, named=False)
    text = verdict(replace(diagnosis, verdict="undecided", rungs=(first, little)))
    assert "stribeck at device helps, but explains less than half" in text


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
    little = replace(both.rungs[2], check_error=0.95 * diagnosis.before.check_error)
    less = unnamed(replace(both, rungs=(*both.rungs[:2], little)))
    text = verdict(replace(less, verdict="undecided"))
    assert f"stribeck at device and {other} help, but explain less than half" in text


def with_floor(diagnosis, *, floors, drawn=1.0, held=False):
    """The diagnosis with a floor of which the last model leaves so many."""
    value = diagnosis.after.check_error / floors
    floor = replace(diagnosis.floor, value=value, drawn=drawn * value, held=held, at_command=1.0)
    return replace(diagnosis, floor=floor)


def test_what_is_left_is_near_noise_or_more_is_missing_or_may_hide_in_a_floor_that_was_held(
    diagnosis,
):
    near = verdict(with_floor(diagnosis, floors=1.5))
    assert "The remaining error is near what sensor noise alone would leave, " in near
    far = with_floor(diagnosis, floors=4.0, drawn=3.0)
    assert f"error is {number(far.left, 2)} times what sensor noise" in verdict(far)
    assert "more is missing." in verdict(far)
    held = with_floor(diagnosis, floors=4.0, drawn=3.0, held=True)
    assert f"the noise floor of {percent(held.floor.value)}" in verdict(held)
    assert f"sensor errors leave {percent(held.floor.drawn)}" in verdict(held)
    assert "more is missing" in verdict(with_floor(diagnosis, floors=4.0, drawn=1.1, held=True))


def test_what_is_left_at_one_moment_is_reported_with_the_rest_of_the_record(diagnosis):
    moment = Moment("fit.csv", "device", 1.0, 1.5, 1.25)
    one = replace(with_floor(diagnosis, floors=4.0), moment=moment)
    sentence = f"1.2 times without one moment ({moment})"
    assert sentence.replace("1.2 ", f"{number(1.25, 2)} ") in verdict(one)
    only = replace(one, rungs=one.rungs[:1], verdict="model_adequate")
    assert "Your model is adequate" in verdict(only) and f"({moment})" in verdict(only)
    close = with_floor(diagnosis, floors=1.806)
    close = replace(close, moment=replace(moment, without=1.768))
    for text in (verdict(close), ladder_text.sentence(close)):
        assert "1.81 " in text and " 1.77 " in text, "not: 1.8, but 1.8 without one moment"
    plain = replace(only, moment=None)
    assert verdict(plain).endswith(
        "sensor noise alone would leave " + percent(plain.floor.value) + "."
    )


@pytest.mark.parametrize(
    ("value", "printed"),
    [
        (99994.0, "99994"),
        (99999.6, "1.000·10⁵"),
        (1e5, "1.000·10⁵"),
        (1e-3, "0.001000"),
        (9.99e-4, "9.990·10⁻⁴"),
        (0.09999, "0.09999"),
        (-1.0, "−1.000"),
    ],
)
def test_powers_of_ten_are_printed_from_a_hundred_thousand_and_below_a_thousandth(value, printed):
    assert number(value) == printed


@pytest.mark.parametrize(
    ("value", "error", "printed"),
    [
        (123456.0, 100.0, ("1.2346·10⁵", "100")),
        (-0.5, 0.012, ("−0.500", "0.012")),
        (0.0, 1e-9, ("0", "1.0·10⁻⁹")),
        (3.0, 25.0, ("3", "25")),
        (3.0, 250.0, ("3.0", "250")),
        (1e-9, 1e-12, ("1.0000·10⁻⁹", "1.0·10⁻¹²")),
        (2.0, math.inf, ("2.000", "–")),
        (2.0, 0.0, ("2.000", "–")),
    ],
)
def test_a_value_stops_at_the_second_digit_of_its_error(value, error, printed):
    assert with_error(value, error) == printed


def test_an_entry_of_a_diagnosis_is_a_sentence_and_nothing_is_none():
    assert sentence_of("what is left") == "What is left."
    assert sentence_of(None) == sentence_of("") == ""


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
