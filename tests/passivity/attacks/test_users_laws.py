"""Bounds that users' laws declare, true and false, against the largest force that a search finds.

The attacker writes each law twice: with sympy for the package, and with floats for itself. It steps
the states as a computer of that period does, or in steps that are short against all times of the
law, along random motions that it climbs. A claim for continuous time, for a computer's period or
for any time is beaten by a force above the bound in such a time.
"""

from collections import Counter
from math import exp, inf

import numpy as np
import sympy as sp
from devices import body
from passivity.attacks.budget import attacked, climbed

from teleopdesign.controllers import ControlLaw, ControllerState, controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import Parameter
from teleopdesign.passivity.friction_pairs import friction_pairs, pair_claims
from teleopdesign.passivity.law_facts import law_facts

LEVEL, EDGE = 0.4, 0.01
#: forces over their level: sympy of (velocity, speed, input), the same in floats, and the largest
SHAPES = {
    "fraction": (lambda v, s, x: v / (EDGE + s), lambda v, x: v / (EDGE + abs(v)), 1.0),
    "tanh": (lambda v, s, x: sp.tanh(v / EDGE), lambda v, x: np.tanh(v / EDGE), 1.0),
    "root": (
        lambda v, s, x: v / sp.sqrt(EDGE**2 + s**2),
        lambda v, x: v / np.sqrt(EDGE**2 + v * v),
        1.0,
    ),
    "sign": (lambda v, s, x: sp.sign(v), lambda v, x: np.sign(v), 1.0),
    "one way": (
        lambda v, s, x: (v + s) / 2 / (EDGE + s),
        lambda v, x: max(v, 0.0) / (EDGE + abs(v)),
        1.0,
    ),
    "limited spring": (
        lambda v, s, x: sp.Max(sp.Min(50 * x, 1), -1),
        lambda v, x: np.clip(50 * x, -1, 1),
        1.0,
    ),
    "rising edge": (
        lambda v, s, x: sp.sign(v) * (1 - sp.exp(-s / EDGE)),
        lambda v, x: np.sign(v) * (1 - np.exp(-abs(v) / EDGE)),
        1.0,
    ),
    "late push": (lambda v, s, x: v / EDGE, lambda v, x: v / EDGE, inf),
    "hump": (
        lambda v, s, x: 3 * v * EDGE / (EDGE + s) ** 2,
        lambda v, x: 3 * v * EDGE / (EDGE + abs(v)) ** 2,
        0.75,
    ),
}
#: factors of a period, sympy and floats alike
FACTORS = {
    "none": lambda T: 1,
    "grows": lambda T: 1 + 1000 * T,
    "falls": lambda T: 1 / (1 + 1000 * T),
}
RATE = 100.0
#: steps of a state that follows a force: sympy and floats alike of (state, force, period, exp)
STEPS = {
    "exact, by the package": (None, inf),
    "forward Euler": (lambda z, f, T, e: z + T * RATE * (f - z), 1 / RATE),
    "exact, written": (lambda z, f, T, e: f + (z - f) * e(-RATE * T), inf),
    "backward Euler": (lambda z, f, T, e: (z + T * RATE * f) / (1 + T * RATE), inf),
    "too far": (lambda z, f, T, e: z + 2 * (f - z), 0.0),
}
PARAMETERS = {"level": Parameter("force", "F")}


def random_law(rng):
    """(the package's law, its force in floats, its state, largest share at T, longest period)"""
    shape, numeric, most = SHAPES[str(rng.choice(list(SHAPES)))]
    factor = FACTORS[str(rng.choice(list(FACTORS), p=[0.6, 0.2, 0.2]))]
    share = float(rng.choice([0.5, 1 - 1e-6, 1.0, 1 + 1e-6, 1.5]))

    def largest(T):
        return share * most * factor(T)

    def force(now, p):
        made = shape(now.velocity, now.speed, now.input)
        return sp.Rational(str(share)) * p.level * factor(now.period) * made

    def in_floats(v, x, T):
        return share * LEVEL * factor(T) * numeric(v, x)

    longest, step, states, law = inf, None, {}, force
    if rng.random() < 0.5:
        step, longest = STEPS[str(rng.choice(list(STEPS)))]

        def rate(now, p):
            return RATE * (force(now, p) - now.z)

        def stepped(now, p):
            return step(now.z, force(now, p), now.period, sp.exp)

        states = {"z": ControllerState("force", rate, stepped if step else None)}
        law = lambda now, p: now.z  # noqa: E731
    made = ControlLaw(law=law, parameters=PARAMETERS, states=states, bound="level")
    return made.named("mine", "A law."), in_floats, (bool(states), step), largest, longest


def largest_force(rng, in_floats, state, period):
    """The largest size of force over random motions, in samples of that period, over its level."""
    follows, step = state

    def along(motions):
        out = np.zeros(len(motions))
        for k, motion in enumerate(motions):
            z = x = 0.0
            for v in motion:
                x += v * max(period, 1e-3)
                f = in_floats(v, x, period)
                if follows and step is None or period == 0:  # exact for a held input
                    z = f + (z - f) * exp(-RATE * (period or 1e-3))
                elif follows:
                    z = step(z, f, period, exp)
                out[k] = max(out[k], abs(z if follows else f))
        return out / LEVEL

    speeds = EDGE * 10 ** rng.uniform(-2, 5, (20, 30)) * rng.choice([-1, 1], (20, 30))
    return climbed(rng, along, speeds, rounds=4)[0]


def proved(law):
    """The times for which a claim rests on the bound of the law."""
    made = haptic_interface(
        body(0.1, viscous__damping=1.0, coulomb__level=0.5),
        cancellation=controller(law, {"level": LEVEL}),
    )
    claims = [one for pair in friction_pairs(made) for one in pair_claims(pair, simulated=False)]
    return {one.time for one in claims if one.claim.status == "proved"}


@attacked(0, 30)
def test_no_force_exceeds_a_bound_on_which_a_claim_rests(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for _ in range(number):
        law, in_floats, state, size_at, longest = random_law(rng)
        (stage,) = controller(law, {"level": LEVEL}).stages
        times = proved(law)
        period = float(10 ** rng.uniform(-4, -1))
        for time, holds, true in (
            (0.0, bool(times), size_at(0.0) <= 1),
            (period, law_facts(stage, (period, period)).bound is not None,
             size_at(period) <= 1 and period <= longest),
            (period, "any" in times, max(size_at(0.0), size_at(inf)) <= 1 and longest == inf),
        ):  # fmt: skip
            largest = largest_force(rng, in_floats, state, time)
            assert not (holds and largest > 1 + 1e-9), (law, longest, time, largest)
            counts["proved" if holds else "open", "beaten" if largest > 1 else "not beaten"] += 1
            counts["true, and open"] += true and not holds
    print(dict(counts))
    assert counts["open", "beaten"] > number / 2
    assert counts["true, and open"] <= 0.05 * counts["proved", "not beaten"]
