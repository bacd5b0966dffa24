"""Claims with a dead time against Re Z over the open right half plane, and claims of evidence.

What is claimed of a cancellation that acts late is a claim on Z(s) with e^(-s tau): passive if and
only if Re Z >= 0 wherever Re s > 0. The attacker evaluates Z there, and nothing else.
"""

from collections import Counter

import mpmath
import numpy as np
import sympy as sp
from passivity.attacks.budget import attacked, near

from teleopdesign.passivity import (
    cancelled_inertia,
    delayed_small_motion,
    largest_passive_inertia,
)
from teleopdesign.passivity.linear.family import family_of_matrix
from teleopdesign.passivity.linear.judge import passive_claim
from teleopdesign.realise.lti import S


def active(rng, z, corners, number=4000):
    """s with Re s > 0 and Re Z < 0 beyond rounding; None if none is found.

    z: of s, with numpy or mpmath's `exp`
    """
    w = rng.choice(corners, number) * 10 ** rng.uniform(-4, 4, number)
    w[: number // 2] = rng.choice(corners, number // 2) * rng.uniform(0, 30, number // 2)
    s = w * (10.0 ** rng.uniform(-12, 0, number) * (rng.random(number) < 0.9) + 1j)
    s = np.concatenate([s + 1e-14 * w, w[:300].astype(complex)])
    value = z(s, np.exp)
    for _ in range(3):
        best = np.argsort(value.real / np.abs(value))[:40]
        near_best = np.repeat(s[best], 50)
        turned = 10.0 ** rng.uniform(-7, -1, len(near_best)) * rng.choice([-1, 1], len(near_best))
        more = near_best.real * 10 ** rng.uniform(-1, 1, len(near_best)) + 1j * near_best.imag * (
            1 + turned
        )
        s = np.concatenate([s[best], more])
        value = z(s, np.exp)
    k = int(np.argmin(value.real / np.abs(value)))
    with mpmath.workdps(50):
        exact = z(mpmath.mpc(s[k].real, s[k].imag), mpmath.exp)
        return s[k] if exact.real < 0 else None


def small_motion(rng):
    force, length, time = 10.0 ** rng.uniform(-6, 6, 3)
    sigma_d = force / length
    sigma_p = near(rng, sigma_d) if rng.random() < 0.4 else sigma_d * rng.uniform(1, 3)
    tau = time * (rng.random() < 0.9)
    b = (
        near(rng, 0.2173 * sigma_d * tau) * (1 + (rng.random() < 0.5))
        if tau
        else sigma_d * time * 0.1
    )
    claim = delayed_small_motion(
        damping=b, compensator_stiffness=sigma_d, delay=tau, presliding_stiffness=sigma_p
    )

    def z(s, exp):
        return b + (sigma_p - sigma_d * exp(-s * tau)) / s

    corners = [1 / time, sigma_d / (b or 1)]
    return claim.status, active(rng, z, corners)


def inertia(rng):
    mass, time = 10.0 ** rng.uniform(-6, 6, 2)
    order, t = int(rng.integers(1, 3)), time * 10 ** rng.uniform(-1, 1) * (rng.random() < 0.8)
    tau = time * (rng.random() < 0.8)
    b = mass / time
    limit = order * b * t or mass
    if t and tau and order == 2 and rng.random() < 0.3:
        limit = largest_passive_inertia(damping=b, delay=tau, time_constant=t)
    amount = near(rng, limit)
    m = mass * 10 ** rng.uniform(-1, 1) * (rng.random() < 0.9)
    claim = cancelled_inertia(
        inertia=m, damping=b, cancelled=amount, delay=tau, time_constant=t, order=order
    )

    def z(s, exp):
        return m * s + b - amount * s * exp(-s * tau) / (1 + s * t) ** order

    return claim.status, active(rng, z, [1 / time, *([1 / t] if t else []), b / (m or mass)])


def late_term(rng, kind, b, time):
    """(numerator, denominator, dead time) of a part about as large as the damping b allows."""
    late = time * 10 ** rng.uniform(-1, 1)
    slow = time * 10 ** rng.uniform(-1, 1)
    w = 1 / (time * 10 ** rng.uniform(-1, 1))
    if kind == "spring":
        return [near(rng, b / late)], [1, 0], late
    if kind == "spring with a low-pass":
        return [near(rng, b / (late + slow))], [slow, 1, 0], late
    if kind == "low-pass":
        return [near(rng, b) * rng.choice([1, -1])], [slow, 1], late
    if kind == "resonance":
        z = 10 ** rng.uniform(-4, 0)
        return [near(rng, b) * 2 * z * w, 0], [1, 2 * z * w, w**2], late
    if kind == "swing that stays":
        # late by whole turns, or off by as little as a hair
        turns = 2 * np.pi / w * rng.integers(1, 4) * (1 + rng.choice([0, 10 ** rng.uniform(-9, 0)]))
        return [b * w * 10 ** rng.uniform(-2, 1), 0], [1, 0, w**2], turns
    if kind == "grows":
        return [b * rng.choice([1, -1])], [slow, -1], late
    if kind == "does not fade":
        return [near(rng, b) * rng.choice([1, -1])], [1], late
    return [b * time * rng.choice([1, -1]) * 10 ** rng.uniform(-2, 1), 0], [1], late  # a mass


LATE = ("spring", "spring with a low-pass", "low-pass", "resonance", "swing that stays", "grows",
        "does not fade", "mass")  # fmt: skip


def one_port(rng):
    b, time = 10.0 ** rng.uniform(-6, 6, 2)
    kinds = rng.choice(LATE, int(rng.choice([1, 1, 2])), p=[0.25, 0.2, 0.2, 0.15, *[0.05] * 4])
    terms = [late_term(rng, str(kind), b / len(kinds), time) for kind in kinds]
    terms.append(([b * time * 10 ** rng.uniform(-2, 1) * (rng.random() < 0.8), b], [1], 0.0))
    terms = [
        ([float(f"{c:.4g}") for c in p], [float(f"{c:.4g}") for c in q], float(f"{t:.6g}"))
        for p, q, t in terms
    ]

    def written(p):
        return sp.Poly([sp.Rational(repr(c)) for c in p], S).as_expr()

    whole = sp.Add(
        *(written(p) / written(q) * sp.exp(-S * sp.Rational(repr(t))) for p, q, t in terms)
    )
    claim = passive_claim(family_of_matrix(sp.ImmutableMatrix([[whole]])))

    def z(s, exp, number=float):
        def at(p):
            return sum(number(c) * s ** (len(p) - 1 - k) for k, c in enumerate(p))

        return sum(at(p) / at(q) * exp(-s * number(t)) for p, q, t in terms)

    if claim.status == "refuted":
        wave = claim.record
        with mpmath.workdps(60):
            s = mpmath.mpc(
                *(mpmath.mpf(x.numerator) / x.denominator for x in (wave.rate, wave.frequency))
            )
            # beside a pole the last digit counts: 8.255 is the decimal, not the float
            assert z(s, mpmath.exp, lambda x: mpmath.mpf(repr(x))).real < 0 < s.real, terms
    roots = np.concatenate([np.roots(q) for _, q, _ in terms])
    return claim.status, active(rng, z, [1 / time, *np.abs(roots[roots != 0])])


def counted(number, judge, rng):
    counts = Counter()
    for _ in range(number):
        status, counterexample = judge(rng)
        assert status not in ("proved", "evidence") or counterexample is None, (
            status,
            counterexample,
        )
        counts[status, counterexample is not None] += 1
    print(dict(counts))
    assert counts["proved", False] + counts["evidence", False] >= number / 10
    assert counts["refuted", True] >= counts["refuted", False]


@attacked(4, 50)
def test_no_wave_beats_small_motion_that_is_proved_passive(seed, number):
    counted(number, small_motion, np.random.default_rng(seed))


@attacked(4, 50)
def test_no_wave_beats_a_late_cancellation_of_inertia_that_is_proved_passive(seed, number):
    counted(number, inertia, np.random.default_rng(seed))


@attacked(4, 50)
def test_no_wave_beats_a_late_one_port_that_evidence_calls_passive(seed, number):
    counted(number, one_port, np.random.default_rng(seed))
