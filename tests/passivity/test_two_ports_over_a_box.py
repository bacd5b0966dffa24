"""Two-ports over a box whose truth is known: searched for, and checked as certificates alone.

Springs, dampers and masses between two ports are passive. With forces passed on a times and motion
1/a times as large they are not, yet stable with all that is passive. Resistances r, with transfers
whose product is c r^2, are stable so up to c = 1 (Llewellyn).
"""

from fractions import Fraction

import pytest
import sympy as sp
from passivity.test_certificates_over_a_box import HIGH, LOW, is_accepted, made

from teleopdesign.passivity.growing_mode import growing_mode
from teleopdesign.passivity.linear.conditions import is_shown
from teleopdesign.passivity.linear.family import Family, family_of_matrix
from teleopdesign.passivity.linear.matrices import close, dampers
from teleopdesign.passivity.linear.signs import Signs
from teleopdesign.realise.lti import S

V = sp.Symbol("v", real=True)


def between(damping, stiffness="5", first="1", second="2", forth="1", back="1"):
    """Numerators over s of two masses with a spring and damper between them; transfers scaled."""
    link = f"({damping})*s + {stiffness}"
    return (
        [[f"({first})*s**2 + {link}", f"-({forth})*({link})"],
         [f"-({back})*({link})", f"({second})*s**2 + {link}"]],
        "s",
    )  # fmt: skip


def resistors(product, first="3", second="3", lag="1"):
    """Two resistances and a transfer of that product over nine, with a lag in one way."""
    return ([[f"{first}*({lag})", f"9*({product})"], ["1", f"{second}*({lag})"]], lag)


CASES = {
    # v from -1 to 2; whether it is passive, whether stable with all that is passive
    "link": (between("v + 2"), True, True),
    "link without loss at one end": (between("v + 1"), True, True),
    "link that drives": (between("v"), False, False),
    "link that drives as a pair": (between("-v - 2"), False, False),
    "spring that pushes apart": (between("v + 2", stiffness="v"), False, False),
    "masses that vary": (between("1", first="v + 1", second="v + 5"), True, True),
    "a mass below zero": (between("1", first="v"), False, False),
    "force and motion scaled": (between("v + 2", forth="2", back="1/2"), False, True),
    "force and motion scaled by what varies": (between("1", forth="v + 2", back="1"), False, False),
    "gyrator": (([["1", "v"], ["-v", "1"]], "1"), True, True),
    "gyrator of one way": (([["1", "v + 2"], ["0", "1"]], "1"), False, True),
    "transfers up to one": (resistors("(v + 1)/3"), False, True),
    "transfers a little above one": (resistors("(v + 1)/3 + 1/1000"), False, False),
    "transfers against each other": (resistors("-(v + 1)/3"), False, True),
    "a lag of one way": (resistors("(v + 1)/3", lag="s + 1"), False, True),
    "a resistance below zero": (resistors("0", first="v"), False, False),
    "another one": (resistors("0", second="v"), False, False),
    "a pole that grows": (([["s + 1", "0"], ["0", "s + 1"]], "s - 1/2"), False, False),
    "two poles at zero": (([["s + 1", "0"], ["0", "s + 1"]], "s**2"), False, False),
    "a spring and a mass squared": (([["s**3 + s", "0"], ["0", "1"]], "s"), False, False),
    "with its sign in both": (
        ([["-s**2 - (v + 2)*s - 3", "s"], ["s", "-s**2 - 2*s - 3"]], "-s"), True, True,
    ),
}  # fmt: skip


def held(case):
    (numerators, denominator), passive, stable = CASES[case]
    return {"numerators": numerators, "denominator": denominator}, passive, stable


RING = sp.ring((S, V), sp.QQ)[0]


def family(numerators, denominator):
    """The family of N/d, texts in s and v, over the interval of v; no further modes."""
    names = {"s": S, "v": V}
    n = [[RING.from_expr(sp.expand(sp.sympify(e, locals=names))) for e in r] for r in numerators]
    d = RING.from_expr(sp.expand(sp.sympify(denominator, locals=names)))
    return Family(n, d, close(n, d, dampers(n, d)), names=("v",), ends=((LOW, HIGH),))


def is_shown_over(made, claim, margin=Fraction(0)):
    return is_shown(Signs(made.ends), made, claim, margin)


@pytest.mark.parametrize("case", CASES)
def test_a_search_shows_a_two_port_passive_or_stable_only_where_it_is(case):
    _, passive, stable = held(case)
    made = family(*CASES[case][0])
    assert is_shown_over(made, "passive") == passive
    assert is_shown_over(made, "absolutely stable") == stable


# of the one left out the checker looks at every part of the box before it refuses
@pytest.mark.parametrize("case", [c for c in CASES if c != "link that drives"])
def test_a_certificate_of_a_two_port_is_accepted_only_where_it_is_true(case):
    fields, passive, stable = held(case)
    assert is_accepted(made("positive real over a box", scale="1", **fields)) == passive
    assert is_accepted(made("absolute stability over a box", **fields)) == stable


BAND = 2 * S / (S**2 + 2 * S + 100)
NARROW = S / 10 / (S**2 + S / 10 + 100)
LITTLE = sp.Rational(1, 10**6)
TRANSFERS = {
    # times nine, of two resistances of three; how much the product exceeds what is allowed
    "at every frequency": (sp.S(1) + LITTLE, True),
    "in a band": (BAND * (1 + LITTLE), True),
    "in a narrow gap": (NARROW * (1 + LITTLE / 1000), True),
    "turned by its phase": ((1 - S) / (1 + S) * (1 + LITTLE), True),
    "exactly as much": (BAND, False),
    "a little less": (NARROW * (1 - LITTLE), False),
}


def exact(number):
    assert number >= 0
    return sp.Rational(number.numerator, number.denominator)


@pytest.mark.parametrize("case", TRANSFERS)
@pytest.mark.parametrize("turned", [False, True])
def test_terminations_between_which_the_motion_grows_are_detected_however_little_is_too_much(
    case, turned
):
    transfer, grows = TRANSFERS[case]
    above, below = (9 * transfer, sp.S(1)) if not turned else (sp.S(1), 9 * transfer)
    z = sp.ImmutableMatrix([[3, above], [below, 3]])
    mode = growing_mode(family_of_matrix(sp.ImmutableMatrix(z)))
    assert (mode is not None) == grows
    for candidate in filter(None, [mode]):
        assert grows and candidate.is_confirmed() and candidate.rate > 0 and candidate.energy > 0
        # both terminations take energy, and with them the loop is singular where it grows
        s = exact(candidate.rate) + sp.I * exact(candidate.frequency)
        first, second = (exact(t.damping) + exact(t.inertia) * s + exact(t.stiffness) / s
                         for t in candidate.terminations)  # fmt: skip
        entries = z.subs(S, s)
        products = (
            (entries[0, 0] + first) * (entries[1, 1] + second),
            entries[0, 1] * entries[1, 0],
        )
        passing, back = (sp.N(product, 60) for product in products)
        if not any(t.clamped for t in candidate.terminations):
            assert abs(passing - back) < 1e-40 * abs(passing)
