"""Claims on two ports: no wave and no pair of passive terminations beats what is proved.

At any s of the open right half plane with angle phi, passive impedances take every value of the
cone abs(arg) <= phi, and no other. So a two-port is not absolutely stable if and only if, at some
s, a value Z2 of the cone leaves -z_in = L/(z22 + Z2) - z11 in the cone: then Z1 = -z_in. The
attacker looks for such s and Z2, makes dampers, masses and springs of both values, and sees the
pole again to sixty digits.
"""

from collections import Counter
from fractions import Fraction

import mpmath
import numpy as np
import sympy as sp
from passivity.attacks.budget import attacked
from passivity.attacks.rational import KINDS as ONE_PORTS
from passivity.attacks.rational import (
    added,
    at,
    expression,
    number,
    part,
    plus,
    random_ratio,
    roots,
    suspects,
    times,
    values,
)

from teleopdesign.passivity import absolutely_stable, delayed_spring, passive, two_port

DIGITS = 60
KINDS = (
    "passive network",
    "passive network, one entry changed",
    "residues of rank one, off the diagonal changed",
    "one way through",
    "unstable transfer",
    "masses beyond their limit",
    "teleoperator",
    "teleoperator with unequal gains",
    "teleoperator whose slave falls over",
    "poles nearly cancelled",
)


def _diagonal_and_through(rng, shape, rank_two):
    """shape times a symmetric positive semidefinite matrix, as four ratios."""
    v, w = (
        [number(rng), number(rng) * int(rng.choice([-1, 1]))],
        [number(rng) * rank_two, number(rng)],
    )
    m = [[v[i] * v[j] + w[i] * w[j] * rank_two for j in (0, 1)] for i in (0, 1)]
    return [([m[i][j] * c for c in shape[0]], shape[1]) for i in (0, 1) for j in (0, 1)]


def _network(rng, rank_two=None):
    z = None
    for _ in range(int(rng.integers(1, 3))):
        two = int(rng.integers(2)) if rank_two is None else rank_two
        one = _diagonal_and_through(rng, part(rng, lossy=True), two)
        z = one if z is None else [added(a, b) for a, b in zip(z, one, strict=True)]
    lossy = rng.random(2) < 0.7
    return [
        added(z[0], ([number(rng) * int(lossy[0])], [1])), z[1], z[2],
        added(z[3], ([number(rng) * int(lossy[1])], [1])),
    ]  # fmt: skip


def _more(rng):
    return 1 + number(rng) * int(rng.choice([-1, 1])) / 10 ** int(rng.integers(0, 8))


def random_matrix(rng, kind):
    """Four ratios z11, z12, z21, z22."""
    if kind.startswith("teleoperator"):
        master, slave = ([number(rng), number(rng) / 3] for _ in range(2))
        link = [number(rng) / 3, number(rng) * 3], [1, 0]
        z = [added((master, [1]), link), ([-c for c in link[0]], [1, 0]),
             ([-c for c in link[0]], [1, 0]), added((slave, [1]), link)]  # fmt: skip
        if kind.endswith("gains"):
            z[2] = [c * _more(rng) for c in z[2][0]], z[2][1]
        if kind.endswith("over"):
            z[3] = added(z[3], ([-number(rng)], [1, 0]))
        return z
    z = _network(rng, 0 if kind.startswith("residues") else None)
    if kind == "passive network, one entry changed":
        k = int(rng.integers(4))
        z[k] = added(z[k], random_ratio(rng, ONE_PORTS[int(rng.integers(len(ONE_PORTS)))]))
    elif kind.startswith("residues"):
        more = _more(rng)
        z[1] = [c * more for c in z[1][0]], z[1][1]
        if rng.random() < 0.5:
            z[2] = [c * more for c in z[2][0]], z[2][1]
    elif kind == "one way through":
        z[1 + int(rng.integers(2))] = [0], [1]
    elif kind == "unstable transfer":
        small = number(rng) / 10 ** int(rng.integers(0, 7))
        z[1 + int(rng.integers(2))] = [number(rng)], [1, -small]
    elif kind == "masses beyond their limit":
        a, b = number(rng), number(rng)
        z = [([a, number(rng)], [1]), ([a * _more(rng), 0], [1]), ([b * _more(rng), 0], [1]),
             ([b, number(rng)], [1])]  # fmt: skip
    elif kind == "poles nearly cancelled":
        zero = number(rng) * int(rng.choice([-1, 1, 1]))
        pole = zero * (1 + int(rng.integers(-1, 2)) * number(rng) / 10 ** int(rng.integers(3, 12)))
        k = int(rng.integers(4))
        z[k] = times(z[k][0], [1, zero]), times(z[k][1], [1, pole])
    return z


def _scaled(rng, z):
    """In other units of time and size."""
    time, size = (sp.Integer(10) ** int(k) for k in rng.integers(-6, 7, 2))
    scaled = []
    for p, q in z:
        scaled.append((
            [int(size) * c * int(time) ** (len(p) - 1 - k) if size >= 1 and time >= 1 else c
             for k, c in enumerate(p)],
            [c * int(time) ** (len(q) - 1 - k) if size >= 1 and time >= 1 else c
             for k, c in enumerate(q)],
        ))  # fmt: skip
    return scaled


def matrix(z):
    return two_port(
        [[expression(*z[0]), expression(*z[1])], [expression(*z[2]), expression(*z[3])]]
    )


def points(rng, z):
    polynomials = [p for one in z for p in one]
    loop = plus(
        times(z[0][0], z[3][0], z[1][1], z[2][1]), times(z[1][0], z[2][0], z[0][1], z[3][1]), -1
    )
    return suspects([*polynomials, loop], rng, 400)


def wave(rng, z):
    """s at which the Hermitian part of Z is not positive, to sixty digits; None if not found."""
    s = points(rng, z)
    z11, z12, z21, z22 = (values(one, s) for one in z)
    half = (z12 + z21.conj()) / 2
    lowest = (z11.real + z22.real) / 2 - np.sqrt(
        ((z11.real - z22.real) / 2) ** 2 + np.abs(half) ** 2
    )
    size = np.abs(z11) + np.abs(z12) + np.abs(z21) + np.abs(z22)
    share = np.where(np.isfinite(lowest / size), lowest / size, 1.0)
    for k in np.argsort(share)[:12]:
        if share[k] > 1e-9:
            break
        with mpmath.workdps(2 * DIGITS):  # beside a pole, half of them are lost in s^2 + w^2
            a, b, c, d = (at(one, mpmath.mpc(s[k].real, s[k].imag)) for one in z)
            size, rounding = abs(b + mpmath.conj(c)) ** 2, mpmath.mpf(10) ** (10 - DIGITS)
            if min(a.real + rounding * abs(a), d.real + rounding * abs(d)) < 0:
                return s[k]
            if 4 * a.real * d.real < size * (1 - rounding):  # of rank one both are the same
                return s[k]
    return None


def grown(rng, z, value_of=None):
    """(s, Z1, Z2): passive terminations at s between which it grows; None if none is found."""
    s = points(rng, z)
    z11, z12, z21, z22 = (values(one, s) for one in z) if value_of is None else value_of(s)
    phi = np.angle(s)
    sizes = np.concatenate([[0.0], np.geomspace(1e-5, 1e5, 15)])
    loop, port = (z12 * z21)[:, None, None], z22[:, None, None]
    middle = np.abs(z22)[:, None, None] + 1e-300
    turned = np.linspace(-1, 1, 9)[None, None, :] * phi[:, None, None] * (1 - 1e-9)
    held = middle * sizes[None, :, None] * np.exp(1j * turned)
    # and the reactance that makes most of the transfer, as near to it as the cone allows
    with np.errstate(all="ignore"):
        best = z22.real * np.tan(np.angle(z12 * z21) / 2) - z22.imag
        best = np.nan_to_num(np.abs(best) / np.tan(phi) * (1 + 1e-9) + 1j * best)[:, None, None]
        least = np.nan_to_num(np.abs(z22.imag) / np.tan(phi) * (1 + 1e-9) - 1j * z22.imag)
    tuned = np.concatenate([best, least[:, None, None]], axis=1).repeat(9, axis=2)
    tuned[np.abs(tuned) > 1e200] = 0  # of a port that is infinite there
    held = np.concatenate([held, tuned * np.linspace(0.8, 1.2, 9)], axis=1)
    with np.errstate(all="ignore"):
        need = loop / (port + held) - z11[:, None, None]
        inside = phi[:, None, None] - np.abs(np.angle(need))
    inside = np.where(np.isfinite(inside) & (np.abs(need) > 0), inside, -9.0)
    real = (s.imag == 0)[:, None, None]  # there the cone is a line
    inside = np.where(real, np.where(need.real > 0, 1.0, -9.0), inside)
    # what grows fast stands out
    inside = np.minimum(inside, (s.real / np.abs(s))[:, None, None])
    flat = inside.reshape(len(s), -1)
    where = np.argsort(-flat.max(axis=1))[:10]
    for k in where:
        j = int(np.argmax(flat[k]))
        if flat[k, j] > 1e-12:
            first, second = need.reshape(len(s), -1)[k, j], held.reshape(len(s), -1)[k, j]
            if value_of is not None or _is_pole(z, s[k], first, second):
                return s[k], first, second
    if value_of is not None:
        return None
    for port in (z[0], z[3]):
        if (alone := _beside_a_clamped_port(port, s)) is not None:
            return alone, None, None
    for through in (z[1], z[2]):
        for r in roots(through[1]):
            if r.real > 1e-9 * abs(r) and _is_pole(z, r, 1.0 + 0j, 1.0 + 0j):
                return r, 1.0, 1.0
    return None


def _beside_a_clamped_port(impedance, s):
    """s at which an impedance has a negative real part: it grows, held by what is minus it."""
    with np.errstate(all="ignore"):
        z = values(impedance, s)
        inside = np.angle(s) - np.abs(np.angle(-z))
    inside = np.where(np.isfinite(inside) & (np.abs(z) > 0), inside, -9.0)
    for k in np.argsort(-inside)[:6]:
        with mpmath.workdps(DIGITS):
            if inside[k] > 0 and at(impedance, mpmath.mpc(s[k].real, s[k].imag)).real < 0:
                return s[k]
    return None


def _made(value, s):
    """(damping, inertia, stiffness) >= 0 with that value at s; None if it takes none of these."""
    if s.imag == 0:
        return (value.real, 0, 0) if value.real >= 0 else None
    if value.imag >= 0:
        mass = value.imag / s.imag
        rest = value.real - mass * s.real
        return (rest, mass, 0) if rest >= 0 else None
    spring = -value.imag * abs(s) ** 2 / s.imag
    rest = value.real - spring * s.real / abs(s) ** 2
    return (rest, 0, spring) if rest >= 0 else None


def _is_pole(z, s, first, second):
    """Whether the inverse has a pole beside s, s Re > 0, between those parts; to sixty digits."""
    made = _made(first, s), _made(second, s)
    if None in made:
        return False
    with mpmath.workdps(DIGITS):
        ends = [[mpmath.mpf(float(x)) for x in one] for one in made]

        def parts_at(x):
            z11, z12, z21, z22 = (at(one, x) for one in z)
            a, b = (r + m * x + k / x for r, m, k in ends)
            return z11 + a, z12, z21, z22 + b

        def determinant(x):
            a, b, c, d = parts_at(x)
            return a * d - b * c

        root = mpmath.mpc(s.real, s.imag)
        before, step = root * (1 + mpmath.mpf("1e-12")), abs(root)
        try:
            for _ in range(40):  # secants
                f, g = determinant(root), determinant(before)
                step = f * (root - before) / (f - g) if f != g else mpmath.mpf(0)
                before, root = root, root - step
                if abs(step) < abs(root) * mpmath.mpf(10) ** (8 - DIGITS):
                    break
            if root.real <= 1e-9 * abs(root) or abs(step) > 1e-40 * abs(root):
                return False
            near, far = (
                max(abs(x / determinant(y)) for x in parts_at(y))
                for y in (root * (1 + mpmath.mpf("1e-30")), root * (1 + mpmath.mpf("1e-15")))
            )
        except ZeroDivisionError:
            return False
        return near > 1e9 * far


def interval_claim(rng, kind):
    z = random_matrix(rng, kind)
    if rng.random() < 0.25:
        z = _scaled(rng, z)
    system = matrix(z)
    is_passive, stable = passive(system), absolutely_stable(system)
    against, unstable = wave(rng, z), grown(rng, z)
    if is_passive.status == "proved":
        assert against is None, (kind, z, against)
        assert stable.status == "proved", (kind, z, stable)
    if stable.status == "proved":
        assert unstable is None, (kind, z, unstable)
    if stable.status == "refuted":
        assert stable.record.replay() > 0, (kind, z)
        assert is_passive.status != "proved"
    return is_passive.status, stable.status, against is not None, unstable is not None


@attacked(2, 15)
def test_nothing_beats_a_two_port_that_is_proved(seed, number):
    rng = np.random.default_rng(seed)
    counts = Counter(interval_claim(rng, KINDS[k % len(KINDS)]) for k in range(number))
    print(*counts.items(), sep="\n")
    of = {k: Counter() for k in (0, 1)}
    for one, n in counts.items():
        for k in (0, 1):
            of[k][one[k], one[k + 2]] += n
    for k in (0, 1):
        assert of[k]["proved", False] > number / 8
        # the attacker sees what there is to see, or its silence would say nothing
        assert of[k]["refuted", True] >= 3 * of[k]["refuted", False], of[k]


@attacked(3, 20)
def test_no_terminations_beat_a_delayed_spring_that_is_proved(seed, number):
    rng = np.random.default_rng(seed)
    counts = Counter()
    for _ in range(number):
        scale = 10.0 ** rng.uniform(-6, 6, 2)
        b_m, b_s = 10 ** rng.uniform(-1, 1, 2) * scale[0]
        delay = 10 ** rng.uniform(-1, 1) * scale[1]
        share = 1 + float(rng.choice([-1, 1])) * 10 ** rng.uniform(-6, 0)
        stiffness = np.sqrt(b_m * b_s) / delay * abs(share)
        m_m, m_s = 10 ** rng.uniform(-2, 2, 2) * scale[0] * delay * (rng.random(2) < 0.8)
        claim = delayed_spring(
            master_inertia=m_m, master_damping=b_m, slave_inertia=m_s, slave_damping=b_s,
            stiffness=stiffness, delay=delay,
        )  # fmt: skip

        def value_of(s, b=(b_m, b_s), m=(m_m, m_s), k=stiffness, late=delay):
            spring = k / s
            through = -spring * np.exp(-s * late)
            return m[0] * s + b[0] + spring, through, through, m[1] * s + b[1] + spring

        corners = [[1.0, float(x)] for x in (1 / delay, b_m / (m_m or b_m), b_s / (m_s or b_s))]
        growth = grown(rng, [(c, [1]) for c in corners] + [([1], [1])], value_of)
        assert not (claim.status == "proved" and growth), (claim, growth)
        assert claim.status != "refuted" or share > 1
        counts[claim.status, growth is not None] += 1
    print(dict(counts))
    assert counts["proved", False] > number / 4


def test_the_attacker_takes_no_rounding_beside_a_pole_for_a_motion():
    """Of rank one and without loss, one entry written with a factor that cancels."""
    z = [
        ([Fraction(625), Fraction(0)], [Fraction(10000), Fraction(0), Fraction(8)]),
        *[([Fraction(2500, 3), Fraction(0)], [Fraction(10000), Fraction(0), Fraction(8)])] * 2,
        (
            [Fraction(1000000, 9), Fraction(10000, 9), Fraction(0)],
            [Fraction(1000000), Fraction(10000), Fraction(800), Fraction(8)],
        ),
    ]
    assert passive(matrix(z)).status == "proved"
    assert all(wave(np.random.default_rng(seed), z) is None for seed in range(20))


def test_the_attacker_sees_what_the_axis_does_not_show():
    one = ([1], [1])
    for z in (
        [([1, 1, 1], [1, 0]), ([2], [1, 0]), ([2], [1, 0]), ([1, 1, 1], [1, 0])],
        [one, ([1], [1, 0]), ([1], [1, 0]), one],
        [([1, 1], [1]), ([1, 0], [1]), ([1, 0], [1]), ([0.5, 1], [1])],
    ):
        z = [tuple([Fraction(c) for c in x] for x in r) for r in z]
        assert absolutely_stable(matrix(z)).status == "refuted"
        assert grown(np.random.default_rng(1), z) is not None
