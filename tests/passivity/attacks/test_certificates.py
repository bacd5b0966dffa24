"""Certificates on two-ports, changed and made to deceive: what is accepted survives the attack.

`test_mutated_certificates.py` and `test_false_certificates.py` do so for storage functions and
single ports; here each accepted matrix is read by Python's own parser and attacked as a two-port.
"""

import ast
import copy
import json
import random
from collections import Counter
from fractions import Fraction

import numpy as np
import pytest
from passivity.attacks.budget import attacked
from passivity.attacks.rational import added, expression, times
from passivity.attacks.test_two_ports import KINDS, grown, random_matrix, wave
from passivity.small_certificates import sealed
from passivity.test_mutated_certificates import mutated

from teleopdesign.passivity.checker import Refused, check

TITLES = "positive real", "absolute stability"


def ratio(text):
    """Numerator and denominator of an expression in s, by Python's syntax tree."""

    def walk(node):
        if isinstance(node, ast.Constant):
            return [Fraction(str(node.value))], [Fraction(1)]
        if isinstance(node, ast.Name):
            assert node.id == "s"
            return [Fraction(1), Fraction(0)], [Fraction(1)]
        if isinstance(node, ast.UnaryOp):
            p, q = walk(node.operand)
            return [-c for c in p], q
        (a, b), right = walk(node.left), node.right
        if isinstance(node.op, ast.Pow):
            power = ast.literal_eval(right)
            a, b = (a, b) if power >= 0 else (b, a)
            return times(*[a] * abs(power)), times(*[b] * abs(power))
        c, d = walk(right)
        if isinstance(node.op, ast.Mult):
            return times(a, c), times(b, d)
        if isinstance(node.op, ast.Div):
            return times(a, d), times(b, c)
        sign = 1 if isinstance(node.op, ast.Add) else -1
        return added((a, b), ([sign * x for x in c], d))

    def trimmed(p):
        first = next((k for k, c in enumerate(p) if c), len(p) - 1)
        return p[first:]

    p, q = walk(ast.parse(text.strip(), mode="eval").body)
    return trimmed(p), trimmed(q)


def is_false(rng, content):
    """Whether an attack shows that what an accepted certificate states is not so."""
    z = [ratio(e) for row in content["impedance"] for e in row]
    if len(z) == 1:
        z = [z[0], ([Fraction(0)], [Fraction(1)]), ([Fraction(0)], [Fraction(1)]), z[0]]
    motion = wave(rng, z) if content["kind"] == "positive real" else grown(rng, z)
    return motion is not None


def certificate(kind, z):
    text = [str(expression(*one)) for one in z]
    return sealed({"kind": kind, "title": "", "impedance": [text[:2], text[2:]]})


@attacked(5, 120)
def test_matrices_that_are_made_to_deceive_are_accepted_only_where_no_attack_beats_them(
    seed, number
):
    """Random two-ports, most of them beyond a limit by a hair, under either heading."""
    rng, counts = np.random.default_rng(seed), Counter()
    for k in range(number):
        content = certificate(TITLES[k % 2], random_matrix(rng, KINDS[k % len(KINDS)]))
        try:
            statement = check(content)
        except Refused:
            counts["refused"] += 1
            continue
        counts["accepted"] += 1
        assert all(row in statement for row in (e for r in content["impedance"] for e in r))
        assert not is_false(rng, content), json.dumps(content)
    print(dict(counts))
    assert min(counts["refused"], counts["accepted"]) > number / 8


@attacked(6, 280)
def test_mutated_matrices_are_accepted_only_where_no_attack_beats_them(seed, number):
    rng, words = np.random.default_rng(seed), random.Random(seed)
    genuine = []
    while len(genuine) < 10:
        content = certificate(TITLES[len(genuine) % 2], random_matrix(rng, KINDS[0]))
        try:
            check(content)
        except Refused:
            continue
        genuine.append(content)
    counts = Counter()
    for k in range(number):
        content = mutated(copy.deepcopy(genuine[k % len(genuine)]), words)
        if words.random() < 0.2:
            content = sealed({**content, "kind": words.choice(TITLES)})
        try:
            check(content)
        except Refused:
            counts["refused"] += 1
            continue
        counts["accepted"] += 1
        assert not is_false(rng, content), json.dumps(content)
    print(dict(counts))
    assert counts["refused"] > number / 4


@pytest.mark.parametrize("text", ["(s**2+1)/(2*s-3)**2", "-1/2*s**-2+3", "s/(s+1)-1/(s*(s+2))"])
def test_the_attackers_reader_reads_what_the_text_says(text):
    p, q = ratio(text)
    for s in (1.7, 2.0 + 3.0j):
        expected = eval(text, {"s": s})
        assert np.polyval([float(c) for c in p], s) / np.polyval(
            [float(c) for c in q], s
        ) == pytest.approx(expected)
