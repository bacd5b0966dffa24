"""Names and numbers that a certificate may hold, and all others: refused in one line."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.passivity.checker import Refused
from teleopdesign.passivity.checker.algebra import (
    expect,
    expect_fields,
    read_matrix,
    read_number,
    read_words,
)
from teleopdesign.passivity.checker.effort import (
    longest,
    spend,
    spend_from,
)

LETTERS = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"


@pytest.mark.parametrize("name", ["a", "Z9", "v_1", "x" * 60, "a_b_c", "k_"])
def test_a_plain_word_is_a_name(name):
    assert read_words(["q", name], "signals") == ["q", name]


@pytest.mark.parametrize(
    "name",
    ["", "_a", "1a", "a b", "a;b", "a.b", "a-b", "é", "aé", "a\n", "x" * 61, "a__b", "__a", "a__",
     None, 1, ["a"], b"a", True],
)  # fmt: skip
def test_what_is_no_plain_word_is_no_name(name):
    with pytest.raises(Refused, match="signals: a name that is no plain word"):
        read_words(["q", name], "signals")


@given(st.text("aZ9_é -", max_size=6))
def test_a_name_begins_with_a_letter_and_goes_on_with_letters_digits_and_single_lines(name):
    plain = (
        name != ""
        and name[0] in LETTERS
        and all(c in LETTERS + "0123456789_" for c in name)
        and "__" not in name
    )
    try:
        assert read_words([name], "n") == [name] and plain
    except Refused:
        assert not plain


def test_each_name_stands_once_and_there_are_at_most_sixty():
    names = [f"n{k}" for k in range(60)]
    assert read_words(names, "n") == names and read_words([], "n") == []
    for wrong in (["a", "b", "a"], [*names, "more"]):
        with pytest.raises(Refused, match="n: a name twice, or too many"):
            read_words(wrong, "n")
    with pytest.raises(Refused, match="n: expected list, found tuple"):
        read_words(("a",), "n")


@given(st.integers(), st.integers(1, 10**6))
def test_a_number_is_read_exactly(above, below):
    assert read_number(f"{above}/{below}", "n") == Fraction(above, below)
    assert read_number(f"{above}/00{below}", "n") == Fraction(above, below)
    assert read_number(str(above), "n") == above


@pytest.mark.parametrize(
    "text",
    ["", "1.5", "1e3", "+1", "--1", "1/0", "1/00", "1/-2", "1/", "/2", " 1", "1 ", "1/2/3", "٣",
     "1_0", "inf", 1, 1.5, None, True, "1" * 4001, "0x1"],
)  # fmt: skip
def test_what_is_no_fraction_is_no_number(text):
    with pytest.raises(Refused, match="n: expected a fraction such as -1/2"):
        read_number(text, "n")
    assert read_number("1" * 4000, "n") == int("1" * 4000)


def test_types_and_fields_are_exactly_those_that_are_expected():
    assert expect(int, 3, "x") == 3
    for kind, value in ((int, True), (float, 1), (list, ()), (dict, [])):
        with pytest.raises(Refused, match=f"x: expected {kind.__name__}, found"):
            expect(kind, value, "x")
    expect_fields({"a": 1, "b": 2}, "b", "a")
    for fields in ({"a": 1}, {"a": 1, "b": 2, "c": 3}, {}):
        with pytest.raises(Refused, match="expected exactly the fields a, b"):
            expect_fields(fields, "a", "b")


@pytest.mark.parametrize(
    "rows",
    [[], [["s", "1"]], [["s"], ["1"]], [["1", "2"], ["3"]], [["1"] * 3] * 3, "s", [["1"], "1"]],
)
def test_a_matrix_is_square_and_of_a_size_that_is_allowed(rows):
    with pytest.raises(Refused):
        read_matrix(rows, (1, 2))
    _, entries, text = read_matrix([["s", " 1 /\n 2"], ["0", "3*s"]], (1, 2))
    assert text == "[s, 1 / 2], [0, 3*s]"
    assert [len(row) for row in entries] == [2, 2]


def test_effort_is_taken_until_none_is_left():
    left = [10]
    spend_from(left, 4)
    assert left == [6]
    spend_from(left, 6)  # down to nothing is allowed
    with pytest.raises(Refused, match="more work than a certificate may ask for"):
        spend_from(left, 1)
    short, long = [Fraction(3)], [Fraction(2**1000, 3)]
    costs = []
    for a, b in ((short, short), (long, short), (long, long)):
        left = [10**6]
        spend(left, 100, a, b)
        costs.append(10**6 - left[0])
    assert costs[0] == costs[1] == 101  # a product of short numbers costs one
    assert costs[2] == 1 + 100 * (1 + 1001**2 // 2**17)


def test_numbers_are_at_most_a_hundred_thousand_bits_long():
    assert longest([]) == 0 and longest([Fraction(1)]) == 1
    assert longest([Fraction(5, 9), Fraction(-(2**20))]) == 21
    assert longest([Fraction(1, 2**70)]) == 71
    assert longest([Fraction(2**99_999)]) == 100_000
    with pytest.raises(Refused, match="a number is too long"):
        longest([Fraction(2**100_000)])
