"""A claim is about the numbers in its words, exactly, and in the units of its axis."""

import math
import random
import re

import pytest
import sympy as sp
from devices import body
from passivity.test_hypotheses import FUNCTIONS, NAMES, NARROW, inside

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.passivity import (
    bounded_compensation,
    claim_over_intervals,
    positive_real,
    sampled_passivity,
)
from teleopdesign.realise.lti import S

#: a unit of a prismatic axis behind a number
LINEAR = re.compile(r"\d (N|N/m|N s/m|kg|m|m/s)(?![\w/^*]| m\b| s/)")


def test_numbers_that_differ_in_their_last_digit_have_claims_of_other_words():
    level, above = 0.3, 0.1 + 0.2
    claims = [bounded_compensation(coulomb_level=0.3, bound=b) for b in (level, above)]
    assert [c.status for c in claims] != ["proved", "proved"]
    assert claims[0].statement != claims[1].statement
    texts = [positive_real(0.15 * S + b).statement for b in (4, 4.0000001)]
    assert len(set(texts)) == 2
    z = sp.Symbol("z")
    limit = 2 / (sp.Rational(1, 1000))
    walls = [sampled_passivity(k, damping=1, sample_time=1e-3) for k in (limit, limit + 1e-6)]
    assert [w.status for w in walls] == ["proved", "refuted"]
    assert walls[0].statement != walls[1].statement
    held = [sampled_passivity(-100 / z, damping=1, sample_time=1e-3, stiffness=k) for k in (1, 200)]
    assert [w.status for w in held] == ["refuted", "proved"]
    assert held[0].statement != held[1].statement


@pytest.mark.parametrize(
    "function",
    [
        pytest.param(f, marks=pytest.mark.slow if n == "sampled_compensation" else (), id=n)
        for f, n in zip(FUNCTIONS, NAMES, strict=True)
    ],
)
def test_the_same_words_never_have_opposite_verdicts(function):
    """Each number in turn, by one unit in its last place and by decades."""
    rng = random.Random(17)
    arguments = inside(function, rng)
    first = function(**arguments)
    for name in [n for n, x in arguments.items() if isinstance(x, float) and n not in NARROW]:
        value = arguments[name]
        for other in (math.nextafter(value, math.inf), value * 10 ** rng.uniform(-4, 4)):
            try:
                changed = function(**arguments | {name: other})
            except ModelError:  # two levels out of order
                continue
            opposite = {first.status, changed.status} == {"proved", "refuted"}
            assert not (opposite and changed.statement == first.statement), (name, value, other)


@pytest.mark.parametrize("function", FUNCTIONS, ids=NAMES)
def test_a_claim_on_a_rotary_joint_has_its_units(function):
    rng = random.Random(19)
    arguments = inside(function, rng)
    linear, rotary = function(**arguments), function(**arguments, axis="revolute")
    texts = [rotary.statement, str(getattr(rotary.verdict, "method", rotary.verdict))]
    assert rotary.status == linear.status and not any(map(LINEAR.search, texts)), texts
    unit = getattr(rotary.verdict, "unit", "")
    assert unit.split(" of ")[0] not in ("N", "N/m", "N s/m", "m")
    with pytest.raises(ModelError, match=r'axis: found "rotary", expected prismatic or revolute'):
        function(**arguments, axis="rotary")


def test_boxes_whose_ends_differ_in_the_eighth_digit_have_claims_of_other_words():
    """The largest passive gain of a low-passed force feedback, b/(a m), is between both."""
    law = controller("low_pass", {"bandwidth": 20.0}).then(controller("gain", {"gain": 0.2}))
    diagram = haptic_interface(body(0.15, viscous__damping=4.0), force_feedback=law)
    limit = 4.0 / (2 * math.pi * 20.0 * 0.15)
    ends = limit * (1 - 1e-7), limit * (1 + 1e-7)
    claims = [claim_over_intervals(diagram, {"H.gain.gain": (0.1, end)}) for end in ends]
    assert [c.status for c in claims] == ["proved", "refuted"]
    assert claims[0].statement != claims[1].statement
    assert all(str(end) in c.statement for end, c in zip(ends, claims, strict=True))
