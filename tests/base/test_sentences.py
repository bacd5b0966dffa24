"""Numbers with few digits are on the right side, and end where their standard errors do."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.base.sentences import (
    amount,
    join_names,
    number_on_page,
    percent,
    percent_on_page,
    round_down,
    round_near,
    round_up,
    short_on_page,
    typeset,
    unit_on_page,
    with_error_on_page,
    with_standard_error,
)

numbers = st.floats(
    allow_nan=False, allow_infinity=False, min_value=-1e200, max_value=1e200
).filter(lambda x: x == 0 or abs(x) > 1e-200)


@given(value=numbers, digits=st.integers(1, 8))
def test_a_number_is_held_between_its_two_roundings(value, digits):
    low, high = round_down(value, digits=digits), round_up(value, digits=digits)
    assert low <= value <= high
    assert high - low <= 1.001 * abs(value) * 10.0 ** (1 - digits)
    for one in (low, high):
        assert float(f"{one:.{digits}g}") == one


@given(value=numbers, digits=st.integers(1, 8))
def test_one_that_has_few_digits_stays(value, digits):
    few = round_near(value, digits=digits)
    assert round_down(few, digits=digits) == few == round_up(few, digits=digits)


@pytest.mark.parametrize("value", [0.0, math.inf, -math.inf])
def test_what_has_no_digits_stays(value):
    assert round_down(value) == value == round_up(value)


def test_a_hair_below_a_round_number_is_rounded_below_it():
    """A level of a hair less than 0.2 N is no level of 0.2 N."""
    assert round_down(0.2 * (1 - 1e-13), digits=4) == 0.1999
    assert round_up(0.2 * (1 + 1e-13), digits=4) == 0.2001


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (109.7, 21.3, "110 +- 21"),
        (0.02444, 0.00093, "0.02444 +- 0.00093"),
        (0.1972, 3e-4, "0.19720 +- 0.00030"),
        (263_100.0, 3100.0, "2.631e+05 +- 3.1e+03"),
        (-9e-3, 0.17, "-0.01 +- 0.17"),
        (5.0, 0.0996, "5.00 +- 0.10"),
        (2.0, math.nan, "2"),
        (2.0, math.inf, "2"),
        (2.5e-9, 1.3e-10, "2.50e-09 +- 1.3e-10"),
        (0.0, 1e-9, "0 +- 1e-09"),
    ],
)
def test_value_and_error_end_at_the_same_decimal(value, error, text):
    assert with_standard_error(value, error) == text


values = st.floats(allow_nan=False, allow_infinity=False, min_value=-1e12, max_value=1e12)


@given(values, st.floats(min_value=1e-12, max_value=1e12))
def test_what_is_printed_is_within_a_tenth_of_the_error(value, error):
    """Seven digits are the most that a terminal shows of a value known better than that."""
    best, between, sure = with_standard_error(value, error).partition(" +- ")
    assert between and abs(float(best) - value) <= max(0.1 * error, 1e-6 * abs(value))
    assert float(sure) == pytest.approx(error, rel=0.051)


FINITE = st.floats(-1e12, 1e12).filter(lambda x: x == 0 or abs(x) > 1e-12)


def read(text):
    """The value of a printed number."""
    digits = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻−", "0123456789--")
    head, _, power = text.partition("·10")
    return float(head.translate(digits)) * 10.0 ** int(power.translate(digits) or 0)


@given(FINITE, st.integers(2, 6))
def test_a_number_reads_back_to_its_digits(x, digits):
    # half a unit of the last digit kept, and rounding of the power of ten
    assert read(number_on_page(x, digits)) == pytest.approx(
        x, rel=0.51 * 10.0 ** (1 - digits), abs=0
    )
    assert read(short_on_page(x, digits)) == read(number_on_page(x, digits))


@given(FINITE, st.floats(1e-9, 1e6))
def test_a_value_and_its_error_are_printed_to_the_same_decimal(x, error):
    value, spread = with_error_on_page(x, error)
    assert read(spread) == pytest.approx(error, rel=0.06)  # two significant digits
    # a value with 7 digits or more is cut there
    assert read(value) == pytest.approx(x, rel=1e-6, abs=0.051 * 10 * error)


@pytest.mark.parametrize(
    ("printed", "expected"),
    [
        (number_on_page(0.19717), "0.1972"),
        (number_on_page(-12300.0), "−12300"),
        (number_on_page(1.2e-6, 2), "1.2·10⁻⁶"),
        (number_on_page(None), "–"),
        (number_on_page(math.nan), "–"),
        (number_on_page(0.0), "0"),
        (short_on_page(60.0), "60"),
        (short_on_page(7.2e-6), "7.2·10⁻⁶"),
        (percent_on_page(0.07071), "7.07\u202f%"),
        (unit_on_page("N*s/m"), "N·s/m"),
        (unit_on_page("kg*m^2"), "kg·m²"),
        (unit_on_page("1"), ""),
        (join_names(["a"]), "a"),
        (join_names(["a", "b", "c"], "or"), "a, b or c"),
        (with_error_on_page(0.19717, 0.00081), ("0.19717", "0.00081")),
        (with_error_on_page(1.0, None), ("1.000", "–")),
    ],
)
def test_numbers_are_printed_as_a_person_would(printed, expected):
    assert printed == expected


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
    assert number_on_page(value) == printed


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
    assert with_error_on_page(value, error) == printed


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


def test_amounts_have_units_that_read_well():
    assert amount(0.004, "velocity", "prismatic") == "4.0 mm/s"
    assert amount(0.3, "force", "prismatic") == "0.30 N"
    assert amount(0.012, "force", "revolute") == "12 mN m"
    assert amount(0.12, "dimensionless", "prismatic") == "12 %"


def test_a_part_that_is_no_number_is_unknown():
    assert percent(0.07071) == "7.07 %" and percent(0.5, ".0f") == "50 %"
    assert percent(math.nan) == "unknown" and percent(math.inf, unknown="not told") == "not told"
