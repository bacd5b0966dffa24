"""Two-ports over a box whose truth is known: searched for, and checked as certificates alone.

Springs, dampers and masses between two ports are passive. With forces passed on a times and motion
1/a times as large they are not, yet stable with all that is passive. Resistances r, with transfers
whose product is c r^2, are stable so up to c = 1 (Llewellyn).
"""

import pytest
from passivity.test_certificates_over_a_box import is_accepted, made


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


# of the one left out the checker looks at every part of the box before it refuses
@pytest.mark.parametrize("case", [c for c in CASES if c != "link that drives"])
def test_a_certificate_of_a_two_port_is_accepted_only_where_it_is_true(case):
    fields, passive, stable = held(case)
    assert is_accepted(made("positive real over a box", scale="1", **fields)) == passive
    assert is_accepted(made("absolute stability over a box", **fields)) == stable
