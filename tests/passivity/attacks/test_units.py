"""The same system in other units of length, force and time has the same claim, exactly.

Numbers of every theorem, impedances of one port and of two. What is proved in one unit is proved in
all; a motion that refutes may be lost in rounding in another, and is unknown then.
"""

import random
from collections import Counter
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from passivity.attacks.budget import attacked
from passivity.attacks.rational import KINDS, random_ratio
from passivity.test_hypotheses import FUNCTIONS, inside

from teleopdesign.base.errors import ModelError
from teleopdesign.passivity import absolutely_stable, passive, positive_real, two_port
from teleopdesign.realise.lti import S

#: powers of the units of force, length and time in each number of a theorem, by a word of its name
DIMENSIONS = {
    "delay_growth": (0, 0, 0),
    "smoothing_velocity": (0, 1, -1),
    "stribeck_velocity": (0, 1, -1),
    "wave_impedance": (1, -1, 1),
    "level": (1, 0, 0),
    "bound": (1, 0, 0),
    "stiffness": (1, -1, 0),
    "damping": (1, -1, 1),
    "inertia": (1, -1, 2),
    "cancelled": (1, -1, 2),
    "time": (0, 0, 1),
    "delay": (0, 0, 1),
    "step": (0, 1, 0),
    "travel": (0, 1, 0),
    "reserve": (1, 1, 0),
}
#: numbers without a unit, and what is no number
PLAIN = {"late", "order", "scale", "paths", "rng", "delay_growth"}
WITH_UNITS = [
    function
    for function in FUNCTIONS
    if function.__name__ not in ("wave_teleoperator", "free_motion", "energy_tank")
]


def units(rng):
    """Of force, length and time: powers of ten, and ratios that no decimal has."""
    return [
        rng.choice([Fraction(10) ** rng.randint(-6, 6), Fraction(rng.randint(1, 9), 7)])
        for _ in range(3)
    ]


def dimension(name):
    return next(d for word, d in DIMENSIONS.items() if word in name)


def converted(name, value, factors):
    if name in PLAIN or value is None:
        return value
    if name in ("controller", "coupling"):  # a gain: force over position
        name = "stiffness"
    whole = Fraction(1)
    for factor, power in zip(factors, dimension(name), strict=True):
        whole *= factor**power
    return Fraction(str(value)) * whole


def agree(first, second):
    return first == second or {first, second} == {"refuted", "unknown"}


@pytest.mark.parametrize("function", WITH_UNITS, ids=lambda f: f.__name__)
@attacked(1, 10)
def test_numbers_in_other_units_have_the_same_claim(function, seed, number):
    rng, counts = random.Random(seed), Counter()
    for _ in range(number):
        numbers = inside(function, rng)
        for name, needs in function.hypotheses.items():
            if needs.text.endswith("or None") and rng.random() < 0.5:
                numbers[name] = None
        factors = units(rng)
        there = {n: converted(n, v, factors) for n, v in numbers.items()}
        try:
            statuses = function(**numbers).status, function(**there).status
        except ModelError:
            counts["refused"] += 1
            continue
        assert agree(*statuses), (numbers, factors, statuses)
        counts[statuses[0]] += 1
    print(function.__name__, dict(counts))
    assert counts["refused"] < number


def other(ratio, size, time):
    """Z(s) in units of that impedance and time: size * Z(time * s)."""
    p, q = ratio
    p = [size * c * time ** (len(p) - 1 - k) for k, c in enumerate(p)]
    return p, [c * time ** (len(q) - 1 - k) for k, c in enumerate(q)]


def written(ratio):
    above, below = (
        sum(sp.Rational(c.numerator, c.denominator) * S ** (len(x) - 1 - k)
            for k, c in enumerate(x))
        for x in ratio
    )  # fmt: skip
    return above / below


@attacked(0, 6)
def test_impedances_in_other_units_have_the_same_claim(seed, number):
    rng, small = np.random.default_rng(seed), random.Random(seed)
    counts = Counter()
    for k in range(number):
        ratio = random_ratio(rng, KINDS[k % len(KINDS)])
        first, _, time = units(small)
        statuses = [positive_real(written(r)).status for r in (ratio, other(ratio, first, time))]
        assert agree(*statuses), (ratio, first, time, statuses)
        counts["one port", statuses[0]] += 1
        entries = [random_ratio(rng, "passive parts") for _ in range(2)]
        between = random_ratio(rng, KINDS[(k + 1) % len(KINDS)])
        # each port in a unit of its own: a lever of it changes neither claim on either port alone
        lever = Fraction(small.randint(1, 5))
        shares = [[lever**2, lever], [lever, Fraction(1)]]
        for claim in (passive, absolutely_stable):
            results = []
            for size, t, share in ((1, 1, None), (first, time, shares)):
                whole = [[entries[0], between], [between, entries[1]]]
                made = [
                    [written(other(z, size * (share[i][j] if share else 1), t))
                     for j, z in enumerate(row)]
                    for i, row in enumerate(whole)
                ]  # fmt: skip
                results.append(claim(two_port(made)).status)
            assert agree(*results), (claim.__name__, entries, between, first, time, lever, results)
            counts[claim.__name__, results[0]] += 1
    print(dict(counts))
