"""Claims on sampled controllers: energy is a quadratic form in the travels of the samples.

Over a sample of travel d the held force takes f d, the damping b d^2/T at least, the body's spring
K_0 its energy. The matrix of that form over n samples from rest is written down by a loop over the
controller's difference equation; its lowest eigenvalue is the worst of all motions of n samples.
The encoder's steps, and two positions in turn, are the attack on the quantised spring.
"""

from collections import Counter
from fractions import Fraction

import numpy as np
import sympy as sp
from passivity.attacks.budget import attacked
from passivity.attacks.rational import number, plus, times

from teleopdesign.passivity import (
    quantised_spring,
    required_damping,
    sampled_coupling,
    sampled_passivity,
    stiffest_spring,
    z_width,
)

Z = sp.Symbol("z")
KINDS = (
    "wall",
    "late wall",
    "filtered wall",
    "negative spring",
    "integrator",
    "grows",
    "nothing, or at the edge",
    "any",
)


def law(rng, kind):
    """(numerator, denominator) in z, highest power first, N/m; T = 1."""
    k, b = number(rng), number(rng) * int(rng.choice([-1, 0, 1, 1]))
    wall = [k + b, -b], [Fraction(1), Fraction(0)]
    delay = [Fraction(1), *[Fraction(0)] * int(rng.integers(1, 5))]
    pole = Fraction(int(rng.integers(0, 100)), 100)
    if kind == "wall":
        return wall
    if kind == "nothing, or at the edge":  # H = 0, and a pole at z = -1
        return ([Fraction(0)], [Fraction(1)]) if rng.random() < 0.5 else ([k], [Fraction(1)] * 2)
    if kind == "late wall":
        return wall[0], times(wall[1], delay)
    if kind == "filtered wall":
        p = plus([k, -k * pole], [b * (1 - pole), -b * (1 - pole)])
        return p, [Fraction(1), -pole]
    if kind == "negative spring":
        return [-k], delay if rng.random() < 0.6 else [Fraction(1)]
    if kind == "integrator":
        return [k + abs(b), -k], [Fraction(1), Fraction(-1)]
    if kind == "grows":
        near = int(rng.choice([0, 1]))
        out = 1 + Fraction(1, int(10 ** rng.integers(0, 3)))
        p = [k, -k * out * (1 + Fraction(1, int(10 ** rng.integers(2, 6))))] if near else [k]
        return p, [Fraction(1), -out]
    n = int(rng.integers(1, 4))
    poles = [Fraction(int(rng.integers(-99, 100)), 100) for _ in range(n)]
    q = times(*[[Fraction(1), -x] for x in poles])
    return [number(rng) * int(rng.choice([-1, 1])) for _ in range(n + 1)], q


def answer(p, q, n):
    """Samples of the controller's answer to a position of 1 m at sample 0, by its recursion."""
    p, q = [float(c) for c in p], [float(c) for c in q]
    p = [0.0] * (len(q) - len(p)) + p
    out = np.zeros(n)
    for k in range(n):
        out[k] = p[k] if k < len(p) else 0.0
        for j in range(1, min(k, len(q) - 1) + 1):
            out[k] -= q[j] * out[k - j]
        out[k] /= q[0]
    return out


def held(p, q, n):
    """Matrix from travels to held forces, (n, n): of sample k by the positions up to its begin."""
    h = answer(p, q, n)
    step = np.concatenate([[0.0], np.cumsum(h)])  # to a travel of 1 m, which stays
    return np.array([[step[k - j] if k > j else 0.0 for j in range(n)] for k in range(n)])


def least(matrix):
    """Lowest eigenvalue of the form, over its size; and the travel."""
    form = (matrix + matrix.T) / 2
    value, vector = np.linalg.eigh(form)
    return value[0] / (np.abs(form).max() or 1.0), vector[:, 0]


def lowest(p, q, b, k_0):
    """Over several numbers of samples; b in N s/m over T = 1 s."""
    values = []
    for n in (2, 3, 6, 20, 120):
        with np.errstate(all="ignore"):  # what grows may leave the numbers of the machine
            m = held(p, q, n) + b * np.eye(n) + k_0 / 2 * np.ones((n, n))
        if not np.all(np.isfinite(m)):
            break
        values.append(least(m)[0])
    return min(values)


def in_z(p, q):
    return sum(sp.Rational(c) * Z ** (len(p) - 1 - k) for k, c in enumerate(p)) / sum(
        sp.Rational(c) * Z ** (len(q) - 1 - k) for k, c in enumerate(q)
    )


def energy_in(travel, p, q, b, k_0):
    """Energy into the body, J, sample by sample."""
    n = len(travel)
    p, q = [float(c) for c in p], [float(c) for c in q]
    p = [0.0] * (len(q) - len(p)) + p
    x, positions, forces, total = 0.0, [], [], 0.0
    for d in travel:
        positions.append(x)
        k = len(positions) - 1
        f = sum(p[j] * positions[k - j] for j in range(min(k, len(p) - 1) + 1))
        f -= sum(q[j] * forces[k - j] for j in range(1, min(k, len(q) - 1) + 1))
        forces.append(f / q[0])
        total += forces[-1] * d + b * d * d
        x += d
    assert n == len(positions)
    return total + k_0 * x * x / 2


def interval_claim(rng, kind):
    p, q = law(rng, kind)
    period, size = (Fraction(10) ** int(k) for k in rng.integers(-6, 7, 2))
    k_0 = number(rng) if kind == "negative spring" or rng.random() < 0.2 else Fraction(0)
    need = required_damping(in_z(p, q), sample_time=1, stiffness=sp.Rational(k_0))
    b = number(rng)
    if np.isfinite(need):
        share = 1 + float(rng.choice([-1, 1, 1])) * 10 ** rng.uniform(-6, 0)
        b = Fraction(max(need * share, 0.0)).limit_denominator(10**9)
    claim = sampled_passivity(
        in_z([size * c for c in p], q),
        damping=sp.Rational(b * size * period),
        sample_time=sp.Rational(period),
        stiffness=sp.Rational(k_0 * size),
    )
    value = lowest(p, q, float(b), float(k_0))
    if claim.status == "proved":
        assert value > -1e-11, (kind, p, q, b, k_0, value)
    elif claim.status == "refuted":  # unknown: so near its limit that it takes too many samples
        travel = claim.record.travel
        if len(travel) < 3000:
            assert energy_in(travel, p, q, float(b), float(k_0)) < 0, (kind, p, q, b, k_0)
    return claim.status, value < -1e-11


@attacked(0, 50)
def test_no_motion_takes_energy_out_of_a_sampled_body_that_is_proved_passive(seed, number):
    rng = np.random.default_rng(seed)
    counts = Counter(interval_claim(rng, KINDS[k % len(KINDS)]) for k in range(number))
    print(dict(counts))
    assert counts["proved", False] > number / 6
    assert sum(n for (status, _), n in counts.items() if status == "unknown") <= number / 8
    # what needs more than 120 samples to show stays unseen
    assert counts["refuted", True] > 2 * counts["refuted", False]


@attacked(2, 20)
def test_no_two_motions_take_energy_out_of_a_sampled_coupling_that_is_proved(seed, number):
    rng = np.random.default_rng(seed)
    counts = Counter()
    for k in range(number):
        p, q = law(rng, KINDS[k % 3])
        need = required_damping(in_z(p, q), sample_time=1)
        # parallel: b_m b_s/(b_m + b_s) about what is needed
        share = 1 + float(rng.choice([-1, 1])) * 10 ** rng.uniform(-6, 0)
        ratio = 10 ** rng.uniform(-2, 2)
        b_m = max(need * share, 0.0) * (1 + ratio)
        b_s = b_m / ratio
        claim = sampled_coupling(in_z(p, q), master_damping=b_m, slave_damping=b_s, sample_time=1)
        f = held(p, q, 80)
        both = np.block([[f, -f], [-f, f]]) + np.diag(np.repeat([b_m, b_s], 80))
        value = least(both)[0]
        if claim.status == "proved":
            assert value > -1e-11, (p, q, b_m, b_s, value)
        counts[claim.status, value < -1e-11] += 1
    print(dict(counts))
    assert counts["proved", False] > number / 8 and counts["refuted", True] > number / 8


@attacked(2, 10)
def test_walls_within_a_z_width_are_passive_and_walls_beyond_it_are_not(seed, number):
    rng = np.random.default_rng(seed)
    for _ in range(number):
        b, delay = float(10 ** rng.uniform(-3, 3)), int(rng.integers(0, 3))
        widths = z_width(
            damping=b, sample_time=1, delay=delay, wall_damping=b * rng.uniform(0, 1, 3)
        )
        for wall, k in zip(widths.wall_damping, widths.stiffness, strict=True):
            if not np.isfinite(k):
                continue
            q = [1.0, *[0.0] * (delay + 1)]
            assert lowest([k * (1 - 1e-6) + wall, -wall], q, b, 0) > -1e-11, (b, delay, wall)
            assert lowest([k * 1.05 + 1e-2 * b + wall, -wall], q, b, 0) < 0, (b, delay, wall)


def best_round(k, step, b, left, positions):
    """Most energy that a round through some of the positions gives out, J; T = 1."""
    rounded = step * np.floor(positions / step + 0.5) if step else positions
    d = positions[None, :] - positions[:, None]
    best = -(k * rounded[:, None] * d + b * d * d + left * np.abs(d))
    for _ in range(6):  # of 2, 4 ... 64 moves
        best = np.maximum(best, (best[:, :, None] + best[None, :, :]).max(axis=1))
    return float(np.diag(best).max())


@attacked(6, 160)
def test_no_round_takes_energy_out_of_a_quantised_spring_that_is_proved(seed, number):
    rng = np.random.default_rng(seed)
    counts = Counter()
    for _ in range(number):
        force, length = 10.0 ** rng.uniform(-6, 6, 2)
        step = float(length * rng.choice([0, 1, 1, 1]))
        b, f_c = 10 ** rng.uniform(-1, 1, 2) * (force / length, force)
        f_d = f_c * float(rng.choice([0.0, 0.5, 0.99, 1.1]))
        share = 1 + float(rng.choice([-1, 1])) * 10 ** rng.uniform(-5, 0)
        k = (
            share
            * stiffest_spring(
                damping=b, sample_time=1, step=step, coulomb_level=f_c, compensator_level=f_d
            )
            + (f_d > f_c) * 1e-3 * b
        )
        claim = quantised_spring(
            stiffness=k, damping=b, sample_time=1, step=step, coulomb_level=f_c,
            compensator_level=f_d,
        )  # fmt: skip
        edges = (np.arange(-3, 4) + 0.5)[:, None] * length
        beside = length * np.array([-1e-6, -1e-3, -0.1, -1e-12, 1e-12, 1e-6, 1e-3, 0.1])
        positions = np.concatenate([(edges + beside).ravel(), length * rng.uniform(-3, 3, 6),
                                    length * rng.uniform(-1e4, 1e4, 4)])  # fmt: skip
        energy = best_round(k, step, b, f_c - f_d, positions)
        size = k * length**2
        if claim.status == "proved":
            assert energy <= 1e-11 * size * 1e8, (claim, energy)
            near = np.abs(positions) < 10 * length
            assert best_round(k, step, b, f_c - f_d, positions[near]) <= 1e-11 * size, claim
        if claim.status == "refuted":
            flip = claim.record
            x = np.array([step / 2 + flip.distance, step / 2 - flip.distance])
            assert best_round(k, step, b, f_c - f_d, x) > 0, claim
        counts[claim.status, energy > 1e-3 * size] += 1
    print(dict(counts))
    refuted = sum(n for (status, _), n in counts.items() if status == "refuted")
    assert min(counts["proved", False], refuted) > number / 5
