"""Two ports of masses, dampers and springs over a box: certificates as their matrices say."""

import itertools
from fractions import Fraction

import pytest
from passivity.test_certificates_over_a_box import is_accepted, made

#: entries 11, 12, 21, 22 of a matrix, v from -1 to 2, and whether it is symmetric and >= 0 there
MATRICES = {
    "nothing": (("0", "0", "0", "0"), True),
    "one alone": (("v + 1", "0", "0", "0"), True),
    "both": (("v + 3/2", "1/2", "1/2", "1"), True),
    "just enough": (("v + 2", "1", "1", "1"), True),
    "too little at an end": (("v + 2", "1", "1", "99/100"), False),
    "first below zero at an end": (("v + 99/100", "0", "0", "1"), False),
    "second below zero at an end": (("1", "0", "0", "199/100 - v"), False),
    "coupled without a diagonal": (("0", "1", "1", "4"), False),
}
PLAIN = MATRICES["nothing"][0]


def certificate(kind, masses=PLAIN, dampers=PLAIN, springs=PLAIN, below="s"):
    """Z = (M s^2 + D s + K) / d."""
    entries = [
        f"({m})*s**2 + ({d})*s + ({k})" for m, d, k in zip(masses, dampers, springs, strict=True)
    ]
    more = {"scale": "1"} if kind.startswith("positive") else {}
    return made(kind, numerators=[entries[:2], entries[2:]], denominator=below, **more)


@pytest.mark.parametrize("kind", ["positive real over a box", "absolute stability over a box"])
@pytest.mark.parametrize("place", ["masses", "dampers", "springs"])
@pytest.mark.parametrize("name", MATRICES)
def test_what_couples_both_ports_alike_is_accepted_where_its_matrix_is_positive(kind, place, name):
    entries, holds = MATRICES[name]
    assert is_accepted(certificate(kind, **{place: entries})) is holds
    # beside others that are passive
    beside = {"masses": ("1", "0", "0", "2"), "dampers": ("2", "1", "1", "1")}
    assert is_accepted(certificate(kind, **beside | {place: entries})) is holds


OPPOSITE = ("v + 3/2", "1", "-1", "v + 3/2")


@pytest.mark.parametrize("kind", ["positive real over a box", "absolute stability over a box"])
@pytest.mark.parametrize(
    ("place", "holds"), [("dampers", True), ("springs", False), ("masses", False)]
)
def test_what_couples_the_ports_with_opposite_signs_is_passive_as_a_gyrator_alone(
    kind, place, holds
):
    """Springs with opposite signs drive each other: z12 z21 = -(1/s)^2 is 1/w^2 on the axis."""
    assert is_accepted(certificate(kind, **{place: OPPOSITE})) is holds


@pytest.mark.parametrize("kind", ["positive real over a box", "absolute stability over a box"])
@pytest.mark.parametrize(
    ("below", "holds"),
    [
        ("s", True),
        ("-s", False),  # negative springs
        ("s*(s + v + 3/2)", True),
        ("-s*(s + v + 3/2)", False),
        ("s*(s - v - 3)", False),
        ("s + v + 3/2", True),
        ("s**2", False),
        ("s*(s**2 + 1)", False),
        ("s*(s + v)", False),
    ],
)
def test_poles_lie_at_the_left_or_once_at_zero_and_signs_are_those_of_the_fraction(
    kind, below, holds
):
    """(s + v + 3/2) / d at both ports, which cancels where d has the same factor."""
    both = ("1", "0", "0", "1")
    numerator = ("v + 3/2", "0", "0", "v + 3/2")
    made_so = certificate(kind, dampers=both, springs=numerator, below=below)
    assert is_accepted(made_so) is holds
    negative = certificate(
        kind,
        dampers=("-1", "0", "0", "-1"),
        springs=("-v - 3/2", "0", "0", "-v - 3/2"),
        below=f"-({below})",
    )
    assert is_accepted(negative) is holds, "a fraction is the same with both signs turned"


@pytest.mark.parametrize("kind", ["positive real over a box", "absolute stability over a box"])
def test_an_entry_that_grows_faster_than_a_mass_is_refused(kind):
    """From port to port alone, between two masses, s^3 becomes what passes like s, s^4 does not."""
    for k in range(4):
        entries = ["s + 1", "0", "0", "s + 1"]
        assert is_accepted(two(kind, entries))
        entries[k] = f"{entries[k]} + s**4*(v + 3/2)"
        assert not is_accepted(two(kind, entries))


def two(kind, entries, below="v + 3/2"):
    more = {"scale": "1"} if kind.startswith("positive") else {}
    return made(kind, numerators=[entries[:2], entries[2:]], denominator=below, **more)


def test_any_coupling_of_dampers_is_decided_as_by_llewellyn():
    """Dampers 1 and 1, z12 and z21 from -2 to 2: 2 - z12 z21 >= abs(z12 z21), or the sum is PSD."""
    sizes = ["-2", "-1", "-1/2", "0", "1/2", "1", "3/2", "2"]
    for forth, back in itertools.product(sizes, sizes):
        x, y = Fraction(forth), Fraction(back)
        entries = ["1", forth, back, "1"]
        stable = 2 - x * y >= abs(x * y)
        passive = abs(x + y) <= 2
        assert is_accepted(two("absolute stability over a box", entries, "1")) is stable
        assert is_accepted(two("positive real over a box", entries, "1")) is passive
