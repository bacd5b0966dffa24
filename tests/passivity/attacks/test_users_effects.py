"""Energies that users' effects declare, true and false, against closed motions that release some.

An effect is a sum of terms. The attacker writes each term in floats too, steps its state along a
motion of some sine waves in short steps, and climbs to the motion that releases most in its last
round, when states have forgotten their start. What a claim calls passive must never release any.
"""

from collections import Counter

import numpy as np
import sympy as sp
from devices import body
from passivity.attacks.budget import attacked, climbed

from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import Effect, Parameter, State, delayed
from teleopdesign.passivity.friction_pairs import friction_pairs, pair_claims

DAHL = controller("dahl", {"level": 0.4, "stiffness": 1e4})
LATE = 0.2


def term(law, numeric, *, stores=False, dissipates=False, rate=None, numeric_rate=None):
    """A term: sympy of now, floats of (x, v, late x, late v, time, state), and what is true of it.

    rate, numeric_rate: of its state, sympy of (now, state), and floats of (x, v, state)
    """
    return law, numeric, stores, dissipates, rate, numeric_rate


def linked(k):
    return {"rate": lambda n, z: n.velocity - k * z, "numeric_rate": lambda x, v, z: v - k * z}


BRISTLE = {"rate": lambda n, z: n.velocity - 3 * sp.Abs(n.velocity) * z,
           "numeric_rate": lambda x, v, z: v - 3 * abs(v) * z}  # fmt: skip
INNER = {
    "rate": lambda n, z: 2 * (n.position - z),
    "numeric_rate": lambda x, v, z: 2 * (x - z),
}
TERMS = {
    "damper": term(lambda n, z: n.velocity, lambda x, v, *_: v, dissipates=True),
    "drag": term(
        lambda n, z: n.velocity * sp.Abs(n.velocity), lambda x, v, *_: v * abs(v), dissipates=True
    ),
    "damper one way": term(
        lambda n, z: n.velocity + sp.Abs(n.velocity), lambda x, v, *_: v + abs(v), dissipates=True
    ),
    "damper of the place": term(
        lambda n, z: n.velocity * sp.cos(n.position) ** 2,
        lambda x, v, *_: v * np.cos(x) ** 2,
        dissipates=True,
    ),
    "wave of dampers": term(
        lambda n, z: n.velocity * sp.cos(3 * n.position), lambda x, v, *_: v * np.cos(3 * x)
    ),
    "spring": term(lambda n, z: n.position, lambda x, *_: x, stores=True, dissipates=True),
    "hard spring": term(
        lambda n, z: n.position**3, lambda x, *_: x**3, stores=True, dissipates=True
    ),
    "late spring": term(
        lambda n, z: delayed(n.position, LATE), lambda x, v, late, *_: late
    ),
    "late damper": term(
        lambda n, z: delayed(n.velocity, LATE), lambda x, v, lx, late, *_: late
    ),
    "spring of the time": term(
        lambda n, z: n.position * sp.sin(n.time), lambda x, v, lx, lv, t, z: x * np.sin(t)
    ),
    "damper of the time": term(
        lambda n, z: n.velocity * sp.sin(n.time) ** 2,
        lambda x, v, lx, lv, t, z: v * np.sin(t) ** 2,
        dissipates=True,
    ),
    "Maxwell element": term(
        lambda n, z: z, lambda x, v, lx, lv, t, z: z, dissipates=True, **linked(2.0)
    ),
    "bristle": term(lambda n, z: z, lambda x, v, lx, lv, t, z: z, dissipates=True, **BRISTLE),
    "inner point": term(
        lambda n, z: n.position - z, lambda x, v, lx, lv, t, z: x - z, dissipates=True, **INNER
    ),
    "inner point, pulled": term(lambda n, z: z, lambda x, v, lx, lv, t, z: z, **INNER),
}  # fmt: skip


def random_effect(rng):
    """(the package's effect, its terms with their factors, whether its declaration is true)"""
    names = [str(n) for n in rng.choice(list(TERMS), size=rng.integers(1, 3), replace=False)]
    states = [n for n in names if TERMS[n][4] is not None]
    names = [n for n in names if n not in states[1:]]
    signs = [float(s) for s in rng.choice([1.0, -1.0], p=[0.8, 0.2], size=len(names))]
    energy = str(rng.choice(["stores", "dissipates"], p=[0.3, 0.7]))
    terms = [(sign, TERMS[n]) for sign, n in zip(signs, names, strict=True)]

    def law(now, p):
        z = getattr(now, "z", sp.S(0))
        return p.size * sum(sign * one[0](now, z) for sign, one in terms)

    rates = [one[4] for _, one in terms if one[4] is not None]
    made = Effect(
        role="force",
        law=law,
        parameters={"size": Parameter("dimensionless", "how much")},
        absent={"size": 0.0},
        states={"z": State("position", lambda now, p: rates[0](now, now.z))} if rates else {},
        energy=energy,
    )
    kept = all(one[2 if energy == "stores" else 3] for _, one in terms)
    return made.named("mine", "An effect."), terms, kept and min(signs) > 0


def released(terms, motions, rounds=3, steps=500):
    """Most energy that the last of some rounds gives out, over what it turns over, (n,).

    motions: (n, 9): angular frequency, sizes and phases of four waves
    """
    w, sizes, phases = np.abs(motions[:, :1]), motions[:, 1:5], motions[:, 5:]
    k = np.arange(1, 5)
    period = 2 * np.pi / w[:, 0]

    def at(t):
        angle = k * w * t[:, None] + phases
        x = (sizes * np.sin(angle)).sum(axis=1)
        return x, (sizes * k * w * np.cos(angle)).sum(axis=1)

    numeric_rate = next((one[5] for _, one in terms if one[5] is not None), None)
    z, out, turned = np.zeros(len(motions)), np.zeros(len(motions)), np.zeros(len(motions))
    dt = period / steps
    for n in range(rounds * steps):
        t = (n + 0.5) * dt
        (x, v), late = at(t), at(t - LATE)
        if numeric_rate is not None:  # of second order: the state in the middle of the step
            z_mid = z + dt / 2 * numeric_rate(*at(n * dt), z)
            z, z_now = z + dt * numeric_rate(x, v, z_mid), z_mid
        else:
            z_now = z
        power = v * sum(sign * one[1](x, v, *late, t, z_now) for sign, one in terms)
        if n >= (rounds - 1) * steps:
            out -= power * dt
            turned += np.abs(power) * dt
    return out / np.maximum(turned, 1e-300)


@attacked(1, 15)
def test_no_closed_motion_releases_energy_of_an_effect_on_which_a_claim_rests(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for _ in range(number):
        effect, terms, true = random_effect(rng)
        device = body(0.1, viscous__damping=1.0, coulomb__level=0.5)
        made = haptic_interface(device.with_effect(effect, {"size": 3.0}), cancellation=DAHL)
        pairs = friction_pairs(made)
        claims = [one for pair in pairs for one in pair_claims(pair, simulated=False)]
        holds = any(one.claim.holds for one in claims)
        start = np.hstack([
            10 ** rng.uniform(-1, 1, (40, 1)),
            10 ** rng.uniform(-1.5, 0.5, (40, 4)) * (rng.random((40, 4)) < 0.6),
            rng.uniform(0, 2 * np.pi, (40, 4)),
        ])  # fmt: skip
        most, motion = climbed(rng, lambda m, terms=terms: released(terms, m), start, rounds=5)
        assert not (holds and most > 1e-3), (effect.expression(), effect.rates(), motion)
        counts["proved" if holds else "open", "beaten" if most > 1e-3 else "not beaten"] += 1
        counts["true, and open"] += true and not holds
    print(dict(counts))
    assert counts["open", "beaten"] >= number // 6
    assert counts["true, and open"] <= 0.05 * counts["proved", "not beaten"]
