"""Two-ports with dead times of any kind, against hands on both sides and the axis.

    Z = [[n11, n12 e^(-s T1)], [n21 e^(-s T2), n22]]/d,   d of decaying modes, some hardly damped

The attacker writes det(Z + Z_hands) d, whose growing zeros are growing modes because those of d
decay, and evaluates the inequalities of both claims on the axis to fifty digits.
"""

from collections import Counter
from functools import reduce

import mpmath
import numpy as np
import sympy as sp
from passivity.attacks.budget import attacked
from passivity.attacks.late_modes import count_growing

from teleopdesign.passivity import absolutely_stable, passive, two_port
from teleopdesign.realise.lti import S

#: of the sizes of the terms of an inequality: less than this is rounding of its zero
CLEARLY = 1e-20


def number(x):
    return float(f"{x:.3g}")


def mode(rng):
    """A factor s + a, or a resonance, damped by 1 to 1e-4."""
    w = 10 ** rng.uniform(-1, 2)
    if rng.random() < 0.5:
        return [1.0, number(w)]
    return [1.0, number(2 * 10 ** rng.uniform(-4, 0) * w), number(w * w)]


def random_two_port(rng):
    """Numerators, d, and the dead times, s; often near a limit of the claims."""
    d = reduce(np.polymul, [mode(rng) for _ in range(int(rng.integers(0, 3)))], [1.0])
    r = np.round(10 ** rng.uniform(-0.5, 0.5, 2), 2)
    mass = np.round(10 ** rng.uniform(-2, 0, 2) * rng.integers(0, 2, 2), 3)
    at_ports = [np.polymul([m, x], d) for m, x in zip(mass, r, strict=True)]
    share = 1 + rng.choice([-1, 1]) * 10 ** rng.uniform(-4, 0)
    size = float(np.sqrt(r[0] * r[1])) * share
    ratio = 10 ** rng.uniform(-0.5, 0.5) if rng.random() < 0.5 else 1.0
    shape = rng.integers(0, 3)
    if shape == 0:  # late dampers of one size at all frequencies
        across = [np.multiply(x, d) for x in (size * ratio, size / ratio * rng.choice([1, -1]))]
    elif shape == 1 and len(d) > 1:  # a resonance passes from port to port, and is at each
        peak = np.polymul([1.0, 0.0], [1.0] + [0.0] * (len(d) - 3)) if len(d) > 2 else [1.0]
        height = d[-2] if len(d) > 2 else d[-1]
        at_ports = [
            np.polyadd(x, np.multiply(height * y, peak)) for x, y in zip(at_ports, r, strict=True)
        ]
        across = [np.multiply(size * height * y, peak) for y in (ratio, 1 / ratio)]
    else:
        k = number(10 ** rng.uniform(-1, 2))
        d = np.polymul(d, [1.0, 0.0])
        at_ports = [np.polyadd(np.polymul(x, [1.0, 0.0]), np.multiply(k, d[:-1])) for x in at_ports]
        across = [np.multiply(-k, d[:-1])] * 2  # a late spring
    times = [number(10 ** rng.uniform(-3, 1)) * int(rng.random() < 0.8) for _ in range(2)]
    if shape == 2 and rng.random() < 0.7:  # P (T1 + T2)/2 is compared with the dampers
        times = [number(np.sqrt(r[0] * r[1]) / k * share)] * 2
    if not any(times):
        times[0] = 0.1
    rounded = [[float(f"{c:.9g}") for c in p] for p in (*at_ports, *across, d)]
    return rounded[:2], rounded[2:4], rounded[4], times


def in_sympy(at_ports, across, d, times):
    below = sp.Poly([sp.Rational(repr(float(c))) for c in d], S).as_expr()

    def entry(p, time=0.0):
        above = sp.Poly([sp.Rational(repr(float(c))) for c in p], S).as_expr()
        return above / below * sp.exp(-S * sp.Rational(repr(time)))

    return [
        [entry(at_ports[0]), entry(across[0], times[0])],
        [entry(across[1], times[1]), entry(at_ports[1])],
    ]


def on_axis(at_ports, across, d, times, w):
    """Sizes of the two inequalities at w, relative to their terms, to fifty digits."""
    with mpmath.workdps(50):
        s = mpmath.mpc(0, w)
        z = [[0, 0], [0, 0]]
        below = mpmath.polyval([mpmath.mpf(repr(c)) for c in d], s)
        for i in range(2):
            z[i][i] = mpmath.polyval([mpmath.mpf(repr(c)) for c in at_ports[i]], s) / below
            late = mpmath.exp(-s * mpmath.mpf(repr(times[i])))
            z[i][1 - i] = mpmath.polyval([mpmath.mpf(repr(c)) for c in across[i]], s) / below * late
        r1, r2 = z[0][0].real, z[1][1].real
        mixed = z[0][1] + mpmath.conj(z[1][0])
        product = z[0][1] * z[1][0]
        size = abs(r1 * r2) + abs(mixed) ** 2 + abs(product) + mpmath.mpf("1e-300")
        raisbeck = (4 * r1 * r2 - abs(mixed) ** 2) / size
        llewellyn = (2 * r1 * r2 - product.real - abs(product)) / size
        least = min(r1 / abs(z[0][0]), r2 / abs(z[1][1]))
        return float(min(raisbeck, least)), float(min(llewellyn, least))


def hands(rng):
    """A passive hand as (above, below), its size anywhere."""
    w, r = 10 ** rng.uniform(-2, 3), 10 ** rng.uniform(-3, 3)
    m, k = (rng.integers(0, 2) * 10 ** rng.uniform(-2, 2) * x for x in (r / w, r * w))
    return np.array([m, r * rng.integers(0, 2), k]), np.array([1.0, 0.0])


def grows(rng, at_ports, across, d, times, tries=40):
    """Hands with which a mode grows, or None."""
    for _ in range(tries):
        (a1, b1), (a2, b2) = hands(rng), hands(rng)
        sides = [
            np.polyadd(np.polymul(n, b), np.polymul(a, d))
            for n, a, b in ((at_ports[0], a1, b1), (at_ports[1], a2, b2))
        ]
        f = np.polymul(*sides)
        late = -reduce(np.polymul, (across[0], across[1], b1, b2))
        count = count_growing([(f, 0.0), (late, sum(times))])
        if count and np.isfinite(count):
            return (a1, a2), count
    return None


@attacked(3, 60)
def test_no_hands_and_no_frequency_beat_a_late_two_port_that_holds(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for _ in range(number):
        case = random_two_port(rng)
        system = two_port(in_sympy(*case))
        claims = [judge(system) for judge in (passive, absolutely_stable)]
        modes = np.abs(np.roots(case[2]))
        modes = modes[modes > 0]
        w = np.geomspace(1e-4, 1e5, 300)
        across = [
            x * (1 + y) for x in modes for y in np.linspace(-1, 1, 41) * 10 ** rng.uniform(-5, -1)
        ]
        for k, claim in enumerate(claims):
            counts[("passive", "absolutely stable")[k], claim.status] += 1
            if not claim.holds:
                continue
            least = min((on_axis(*case, x)[k], x) for x in (*w, *across))
            assert least[0] > -CLEARLY, (k, case, least, claim)
            beaten = grows(rng, *case)
            assert beaten is None, (k, case, beaten, claim)
        assert not (claims[0].holds and claims[1].status == "refuted"), (case, claims)
    print(dict(counts))
