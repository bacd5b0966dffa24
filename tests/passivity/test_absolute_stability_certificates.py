"""Certificates of absolute stability hold Z alone: what is false is refused, whatever is forged."""

import hashlib
import json
import re

import numpy as np
import pytest
import sympy as sp
from clock import takes_less_than
from passivity.random_two_ports import KINDS, attack, random_two_port

from teleopdesign.passivity.checker import Refused, check
from teleopdesign.passivity.claims.certificate import matrix_certificate

TANK = "s/(s**2 + 2)"
TRIES = 60  # as in test_two_port_attack


def sealed(rows, **other):
    """As a forger would: with a digest that fits."""
    body = {"kind": "absolute stability", "title": "", "impedance": rows, **other}
    text = json.dumps(body, sort_keys=True)
    return {**body, "digest": hashlib.sha256(text.encode()).hexdigest()}


@pytest.mark.parametrize(
    "rows",
    [
        [["s + 1 + 1/s", "2/s"], ["2/s", "s + 1 + 1/s"]],
        [["1", "1/s"], ["1/s", "1"]],
        [["s + 1", "s"], ["s", "1 + s/2"]],
        [["0", TANK], [TANK, "1"]],
        [[TANK, TANK], [TANK, f"999999/1000000*{TANK}"]],
        [[f"1 + {TANK}", f"2*{TANK}"], [f"2*{TANK}", f"1 + {TANK}"]],
        [["1", "1"], ["1001/1000", "1"]],
        [["1", "0"], ["0", "-1"]],
        [["1/(s - 1)", "0"], ["0", "1"]],
        [["1", "1/(s - 1)"], ["0", "1"]],
        [["1", "0"], ["1/(s**2 - s + 1)", "1"]],
        [["1", "0"], ["1/s**2", "1"]],
        [["1", "s**2"], ["0", "1"]],
        [["1", "1/(s**2 + 1)**2"], ["0", "1"]],
        [["1", "(s - 1)/(s - 1)/s"], ["1/s", "1"]],
    ],
)
def test_a_false_certificate_is_refused(rows):
    with pytest.raises(Refused, match="absolutely stable"):
        check(sealed(rows))


def test_the_limit_itself_is_proved():
    """r11 r22 = r12 r21 with equal signs: equality; and lossless poles that are shared fairly."""
    for rows in (
        [["1", "1"], ["1", "1"]],
        [["1 + 1/s", "1/s"], ["1/s", "1 + 1/s"]],
        [[f"1 + {TANK}", TANK], [TANK, f"1 + {TANK}"]],
        [["s + 1", "3"], ["-3", "s + 1"]],
        [["0", "3"], ["-3", "0"]],
        [["0", "0"], ["0", "0"]],
    ):
        assert "absolutely stable" in check(sealed(rows))


@pytest.mark.parametrize(
    "content",
    [
        sealed([["1", "0"], ["0"]]),
        sealed([["1"]]),
        sealed([["1", "0"], ["0", "r"]]),
        sealed([["1", "0"], ["0", "exp(-s)"]]),
        sealed([["1", "0"], ["0", "1/0"]]),
        sealed([["1", "0"], ["0", "1/(s - s)"]]),
        sealed([["1", "0"], ["0", 1]]),
        sealed([["1", "0"], ["0", "1"]], proofs={}),
        sealed("1"),
        sealed([["1", "0"], ["0", "1"]]) | {"title": "changed"},
    ],
)
def test_what_is_no_matrix_of_rational_functions_of_s_is_refused(content):
    with pytest.raises(Refused):
        check(content)


@pytest.mark.slow
@pytest.mark.parametrize("number", [400])
def test_what_is_accepted_of_mutated_matrices_survives_an_attack(number):
    """A number, sign or place of a random Z is changed; what is accepted has no bad termination."""
    rng = np.random.default_rng(7)
    accepted, refused = 0, 0
    for i in range(number):
        z = random_two_port(rng, KINDS[i % len(KINDS)])
        rows = [[mutated(rng, str(sp.together(e))) for e in row] for row in z.tolist()]
        try:
            check(sealed(rows))
        except Refused:
            refused += 1
            continue
        accepted += 1
        s = sp.Symbol("s")
        matrix = sp.Matrix([[sp.sympify(e, locals={"s": s}) for e in row] for row in rows])
        matrix = matrix.subs(s, next(iter(z.free_symbols), s))
        assert attack(rng, matrix, TRIES) is None, rows
    assert min(accepted, refused) >= number // 10, (accepted, refused)


def mutated(rng, text):
    """The text with a number or a sign changed, one time in three."""
    places = [m for m in re.finditer(r"(?<!\*)\b\d+\b|[+-]", text)]
    if not places or rng.random() > 1 / 3:
        return text
    place = places[int(rng.integers(len(places)))]
    if place[0] in "+-":
        new = "-" if place[0] == "+" else "+"
    else:
        new = str(max(1, int(place[0]) + int(rng.integers(-1, 3))))
    return text[: place.start()] + new + text[place.end() :]


@pytest.mark.parametrize(
    "entry",
    [
        pytest.param("1/(s + 1)**4000", marks=pytest.mark.slow),
        pytest.param("(s**2 + 1)**300/(s + 1)**601", marks=pytest.mark.slow),
        "+".join(f"{k + 3}*s**{k}" for k in range(120)),
        pytest.param(
            "1/(" + "+".join(f"1{'0' * 60}{7 * k + 3}*s**{k}" for k in range(60)) + ")",
            marks=pytest.mark.slow,
        ),
        f"{'9' * 3900}*s + {'7' * 3900}/(s + {'3' * 3900})",
        f"1/(s**2 + {'1' * 3000}) + 1/(s**2 + {'1' * 2999}2)",
    ],
    ids=["high power", "touching", "dense", "long and dense", "long", "poles close together"],
)
def test_the_effort_of_one_file_is_bounded(entry):
    """Ten seconds, as for the other kinds; it may be proved or refused in that time."""
    for rows in ([[entry, "0"], ["0", "1"]], [["1", entry], [entry, "1"]]):
        with takes_less_than(10):
            try:
                check(sealed(rows))
            except Refused as problem:
                assert "\n" not in str(problem)


def test_a_written_matrix_is_read_as_it_was_meant():
    s = sp.Symbol("s")
    z = [[s + 1 / s, sp.Rational(1, 3) / s], [sp.Rational(1, 3) / s, s + 1 / s]]
    certificate = matrix_certificate("any title", z, "absolute stability")
    assert certificate.kind == "absolute stability"
    assert "Z(s) = [[s + 1/s, 1/(3*s)], [1/(3*s), s + 1/s]]" in certificate.check()


@pytest.mark.parametrize(("coupled", "holds"), [("1/5", True), ("1/4", True), ("3/10", False)])
@pytest.mark.parametrize("below", [1, 4, 9])
def test_masses_at_high_frequency_are_coefficients_over_those_of_the_denominator(
    coupled, holds, below
):
    """Masses of 1/4 kg at both ports, written over a denominator that is not monic."""
    at_port = f"({below}*s**2/4 + s + 1)/({below}*s + 1)"
    content = sealed([[at_port, f"{coupled}*s"], [f"{coupled}*s", at_port]])
    if holds:
        assert check(content)
    else:
        with pytest.raises(Refused, match="absolutely stable"):
            check(content)
