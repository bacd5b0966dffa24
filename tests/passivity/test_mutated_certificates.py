"""Certificates with a number, a name or a part changed: what the checker accepts is still true."""

import copy
import json
import random
import re

import pytest
from passivity.certificate_attack import falsified
from passivity.small_certificates import impedance, paths_of, sealed, storage

from teleopdesign.passivity.checker import Refused, check


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


@pytest.mark.slow
def test_what_is_accepted_of_mutated_certificates_survives_an_attack(genuine):
    assert survey_mutations(genuine, 40, 1) < 40


@pytest.mark.slow
def test_what_is_accepted_of_hundreds_of_mutated_certificates_survives_an_attack(genuine):
    assert survey_mutations(genuine, 400, 2) < 400


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
