"""Certificates, changed and made to deceive: what the checker accepts survives the attack.

What is accepted of changed storage functions and single ports is evaluated by `certificate_attack`;
a matrix is read by Python's own parser and attacked as a two-port.
"""

import ast
import copy
import json
import random
import re
from collections import Counter
from fractions import Fraction

import numpy as np
import pytest
from passivity.attacks.budget import attacked
from passivity.attacks.rational import added, expression, times
from passivity.attacks.test_two_ports import KINDS, grown, random_matrix, wave
from passivity.certificate_attack import falsified
from passivity.small_certificates import impedance, paths_of, sealed, storage

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


def mutated(content, rng):
    """One to three random edits: numbers, signs, exponents, names, left-out parts."""
    c = copy.deepcopy({k: v for k, v in content.items() if k != "digest"})
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        paths = [p for p in paths_of(c) if p[0] not in ("kind", "title")]
        path = rng.choice(paths)
        inner = c
        for step in path[:-1]:
            inner = inner[step]
        old = inner[path[-1]]
        if type(old) is str:
            inner[path[-1]] = _edited(old, c, rng)
        elif type(old) is int:
            inner[path[-1]] = old + rng.choice((-2, -1, 1, 2))
        elif len(path) > 1:
            del inner[path[-1]]
    return sealed(c)


def _edited(text, c, rng):
    tokens = re.findall(r"\w+|\*\*|\S", text)
    if not tokens:
        return "0"
    k = rng.randrange(len(tokens))
    names = [*c.get("constants", ["s"]), *c.get("signals", []), *c.get("rates", {})]
    if tokens[k].isdigit():
        tokens[k] = str(max(int(tokens[k]) + rng.choice((-1, 1, 3, -int(tokens[k]))), 0))
    elif tokens[k] in "+-":
        tokens[k] = rng.choice("+-*")
    elif tokens[k][0].isalpha():
        tokens[k] = rng.choice((*names, f"(-{tokens[k]})", f"{tokens[k]}**2", "1"))
    elif tokens[k] in ("*", "/"):
        tokens[k] = rng.choice(("*", "/", "+", "-"))
    else:
        del tokens[k]
    return "".join(tokens)


def survey_mutations(genuine, number, seed):
    """Number accepted; fails where one of them does not survive the attack."""
    rng, accepted = random.Random(seed), 0
    for k in range(number):
        c = mutated(genuine[k % len(genuine)], rng)
        try:
            check(c)
        except Refused:
            continue
        accepted += 1
        assert falsified(c, rng) is None, json.dumps(c)
    return accepted


@attacked(20, 400)
def test_what_is_accepted_of_mutated_certificates_survives_an_attack(genuine, seed, number):
    """Storage functions and positive real impedances of every kind that the package writes."""
    kinds = [c for c in genuine if c["kind"] in ("storage", "positive real")]
    assert survey_mutations(kinds, number, seed) < number


def test_the_attack_itself_finds_what_is_wrong(genuine):
    """Or its silence would say nothing: conditions and dampings taken away."""
    rng = random.Random(3)
    wrong = [
        storage(supply="p*v - b*v**2"),
        storage(storage="-p**2/(2*k)"),
        storage(storage="p**2/(2*k) + v**2"),
        storage(example={"k": "-1", "b": "1", "v": "1"}),
        storage(rates={"p": "2*k*v"}),
        storage(nonnegative={}),
        storage(invariant={"h": {"expression": "1 - p**2", "rate": "0"}}),
        impedance("(s**2 - 0.1*s + 1)/(s + 1)**2"),
        impedance("1/(s**2 + 2*s + 1)"),
    ]
    for c in wrong:
        assert falsified(c, rng) is not None, c
