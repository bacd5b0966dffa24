"""Random two-ports of every kind, and an attacker that knows nothing of the criterion.

The attacker holds both ports by dampers, masses, springs and resonators tuned to the two-port's own
frequencies, and looks at the roots of the closed loop in floating point. A root it reports is
computed again to fifty digits.
"""

from fractions import Fraction
from functools import reduce

import mpmath
import numpy as np
import sympy as sp

from teleopdesign.passivity import impedance
from teleopdesign.realise.lti import S

KINDS = (
    "passive parts",
    "passive parts and a gyrator",
    "residues of rank one",
    "residues that are not semidefinite",
    "lossless",
    "lossless and not semidefinite",
    "one way",
    "cancelled in the product",
    "improper",
    "multiple poles",
    "a mode that grows",
    "any",
    "teleoperator",
    "teleoperator with unequal gains",
    "a slave that falls over",
)


def number(rng, low=1, high=10):
    return sp.Rational(int(rng.integers(low, high)), int(rng.integers(1, 10)))


def semidefinite(rng, rank):
    """A symmetric matrix of that rank, positive semidefinite."""
    m = sp.zeros(2, 2)
    for _ in range(rank):
        v = sp.Matrix([number(rng), number(rng) * int(rng.choice([-1, 1]))])
        m += v * v.T
    return m


def shapes(rng, *, lossy):
    """Positive-real functions of s: constant, poles at 0, infinity, on the axis, decaying ones."""
    entries = [sp.S(1), 1 / S, S, S / (S**2 + number(rng)), S / (S**2 + number(rng))]
    if lossy:
        entries += [1 / (S + number(rng)), (S + 1) / (S**2 + number(rng) * S + number(rng))]
    chosen = rng.permutation(len(entries))[: int(rng.integers(1, 4))]
    return [entries[k] for k in chosen]


def spoiled(rng, m):
    """A little or much beyond semidefinite, off the diagonal, evenly or not."""
    more = 1 + sp.Rational(1, int(10 ** rng.integers(0, 7)))
    out = m.copy()
    out[0, 1] *= more
    if rng.random() < 0.7:
        out[1, 0] *= more
    return out


def random_two_port(rng, kind):
    """2x2 matrix, rational in s, with short coefficients; time and size over many decades."""
    z = _made(rng, kind)
    if rng.random() < 0.25:
        time, size = (sp.Integer(10) ** int(k) for k in rng.integers(-6, 7, 2))
        z = size * z.subs(S, S * time)
    return z


def _made(rng, kind):
    half = sp.Rational(1, 2)
    if kind.startswith(("passive parts", "residues", "lossless")):
        lossy = not kind.startswith("lossless")
        rank = 1 if kind == "residues of rank one" or rng.random() < 0.6 else 2
        parts = [(shape, semidefinite(rng, rank)) for shape in shapes(rng, lossy=lossy)]
        if kind.endswith("not semidefinite"):
            parts = [(s, spoiled(rng, m) if rng.random() < 0.7 else m) for s, m in parts]
        z = sum((s * m for s, m in parts), sp.zeros(2, 2))
        if lossy:
            z += sp.diag(number(rng, 0), number(rng, 0))
        if kind.endswith("gyrator") or (not lossy and rng.random() < 0.3):
            turn = number(rng)
            z += sp.Matrix([[0, turn], [-turn, 0]])
        return z
    if kind == "one way":
        z = sp.diag(*(sum(shapes(rng, lossy=True), number(rng)) for _ in range(2)))
        z[1, 0] = sum(shapes(rng, lossy=True)) * int(rng.choice([-3, 3]))
        return z
    if kind == "cancelled in the product":
        up, down = (S + number(rng) * int(rng.choice([-1, 1, 1])) for _ in range(2))
        c = number(rng) * int(rng.choice([-1, 1])) / 4
        return sp.Matrix([[number(rng) + S, c * up / down], [c * down / up, number(rng) + 1 / S]])
    if kind == "improper":
        m = semidefinite(rng, 1)
        z = S * (spoiled(rng, m) if rng.random() < 0.5 else m)
        z += sp.diag(number(rng), number(rng))
        if rng.random() < 0.2:
            z[0, 1] += S**2 / 10
        return z
    if kind == "multiple poles":
        w = S**2 + number(rng)
        z = sp.diag(number(rng) + S / w, number(rng) + S / w)
        z[0, 1] = 1 / w ** int(rng.integers(1, 3))
        z[1, 0] = number(rng, 0) * w ** int(rng.integers(-1, 2))
        return z
    if kind == "a mode that grows":
        z = sp.diag(number(rng), number(rng)) + semidefinite(rng, 1) / S
        grows = [1 / (S - number(rng)), 1 / (S**2 - number(rng) * S / 9 + 1 + number(rng))]
        i, j = (int(k) for k in rng.integers(0, 2, 2))
        z[i, j] += number(rng) * grows[int(rng.integers(0, 2))]
        return z
    if kind == "any":
        q = [sp.prod([S + number(rng) for _ in range(int(rng.integers(0, 3)))]) for _ in range(4)]
        z = [
            sum(int(rng.integers(-2, 7)) * S**k for k in range(int(sp.degree(d, S)) + 1)) / d
            for d in (sp.sympify(x) for x in q)
        ]
        z[0] += number(rng, 3) + S
        z[3] += number(rng, 3) + 1 / S
        return sp.Matrix(2, 2, z)
    masses, dampings = [number(rng) for _ in range(2)], [number(rng) / 3 for _ in range(2)]
    k, d = number(rng) * 10, number(rng, 0) / 5
    link = k / S + d
    back = link
    if kind == "teleoperator with unequal gains":
        part = 1 + half ** int(rng.integers(1, 16)) * int(rng.choice([-1, 1]))
        back = (k * part if rng.random() < 0.7 else k) / S + (d * part if rng.random() < 0.7 else d)
    z = sp.Matrix([[link, -link], [-back, back]])
    z += sp.diag(*(m * S + b for m, b in zip(masses, dampings, strict=True)))
    if kind == "a slave that falls over":
        z[1, 1] -= number(rng) / S
    return z


# the attacker


def closed_loop(z):
    """d, d z11, d z22, d det Z with the pole polynomial d: four polynomials, exact."""
    entries = [impedance(e) for e in z]
    common = reduce(sp.lcm, [e.q for e in entries])
    n11, n12, n21, n22 = (e.p * common.quo(e.q) for e in entries)
    above, below = n11 * n22 - n12 * n21, common * common
    shared = sp.gcd(above, below)
    above, below = above.quo(shared), below.quo(shared)
    d = sp.lcm(common, below)
    return [d, n11 * d.quo(common), n22 * d.quo(common), above * d.quo(below)]


def _floats(poly):
    return np.array([float(c) for c in poly.all_coeffs()])


def corner_frequencies(parts):
    """Sizes of poles and zeros, 1/s."""
    roots = [r for p in parts if p.degree() > 0 for r in np.roots(_floats(p))]
    return sorted({abs(r) for r in roots if abs(r) > 0}) or [1.0]


def random_termination(rng, frequencies, size):
    """(numerator, denominator) of a passive impedance: R, m s, k/s, two of them, a resonator."""
    w = rng.choice(frequencies) * 10 ** rng.normal(0, 0.3 * (rng.random() < 0.7))
    r, m, k = size * 10 ** rng.uniform(-4, 4, 3)
    m, k = m / w, k * w
    kind = rng.integers(0, 9)
    if kind == 0:
        return np.array([r]), np.array([1.0])
    if kind == 1:
        return np.array([m, 0.0]), np.array([1.0])
    if kind == 2:
        return np.array([k]), np.array([1.0, 0.0])
    if kind == 3:
        return np.array([m, r]), np.array([1.0])
    if kind == 4:
        return np.array([r, k]), np.array([1.0, 0.0])
    if kind == 5:  # mass and spring that move freely at w
        return np.array([m, 0.0, m * w * w]), np.array([1.0, 0.0])
    if kind == 6:  # a mass held by a spring: infinite at w
        return np.array([k, 0.0]), np.array([1.0, 0.0, w * w])
    if kind == 7:
        return np.array([k, 0.0]), np.array([1.0, 1e-3 * w, w * w])
    return np.array([0.0]), np.array([1.0])


def characteristic(parts, held):
    """The closed loop's characteristic polynomial: det(Z + diag(Z1, Z2)) d times denominators.

    parts: the four of `closed_loop`, held: numerators and denominators, all arrays, highest first
    """
    d, d11, d22, det = parts
    (a1, b1), (a2, b2) = held
    terms = ((det, b1, b2), (d11, b1, a2), (d22, a1, b2), (d, a1, a2))
    total = np.zeros(1)
    for p, first, second in terms:
        total = np.polyadd(total, np.convolve(p, np.convolve(first, second)))
    return total


def growth(polynomial):
    """Largest real part of a root over its size; -1 without roots."""
    polynomial = np.trim_zeros(polynomial)
    if len(polynomial) < 2 or not np.all(np.isfinite(polynomial)):
        return -1.0
    roots = np.roots(polynomial)
    roots = roots[np.abs(roots) > 0]
    return float(np.max(roots.real / np.abs(roots))) if len(roots) else -1.0


def surely_grows(parts, held):
    """The same with exact coefficients and fifty digits; > 1e-6."""
    ends = [
        tuple(sp.Poly([sp.Rational(Fraction(float(x))) for x in c], S, domain="QQ") for c in pair)
        for pair in held
    ]
    d, d11, d22, det = parts
    (a1, b1), (a2, b2) = ends
    whole = det * b1 * b2 + d11 * b1 * a2 + d22 * a1 * b2 + d * a1 * a2
    if whole.is_zero:
        return False
    plain = whole.sqf_part()  # a multiple root is lost by half its digits
    plain = plain.quo(sp.Poly(S, S)) if plain.eval(0) == 0 else plain
    if plain.degree() < 1:
        return False
    middle = np.median(np.abs(np.roots(_floats(plain))))
    even = sp.Poly(plain.as_expr().subs(S, S * sp.Integer(10) ** round(np.log10(middle))), S)
    for root in even.nroots(n=50, maxsteps=3000, cleanup=False):
        re, size = float(sp.re(root)), float(sp.Abs(root))
        if size > 0 and re > 1e-6 * size:
            return True
    return False


def attack(rng, z, tries):
    """Terminations between which it grows; None where none of so many was found."""
    exact = closed_loop(z)
    parts = [_floats(p) for p in exact]
    frequencies = corner_frequencies(exact)
    beside = frequencies[len(frequencies) // 2] * (0.1 + 1.1j)  # where no pole on the axis is
    d, *rest = (np.polyval(p, beside) for p in parts)
    size = max(abs(rest[0] / d), abs(rest[1] / d), abs(rest[2]) ** 0.5 / abs(d) ** 0.5) or 1.0
    scored = []
    for _ in range(tries):
        held = tuple(random_termination(rng, frequencies, size) for _ in range(2))
        scored.append((growth(characteristic(parts, held)), held))
    scored.sort(key=lambda one: -one[0])
    best, held = scored[0]
    for _ in range(tries // 2):  # climb: a step is kept where it grows faster
        near = tuple((a * 10 ** rng.normal(0, 0.3, len(a)), b) for a, b in held)
        rate = growth(characteristic(parts, near))
        if rate > best:
            best, held = rate, near
    suspects = [held, *(h for g, h in scored[:3] if g > 1e-6)]
    for held in suspects if best > 1e-6 else ():
        if surely_grows(exact, held):
            return held
    return None


def is_free_motion(mode, digits=120):
    """Whether Z(s) + diag(terminations) is singular at the mode's s to half the digits, not beside.

    Or, where z12 or z21 is infinite there, that the other one lets its port rest.
    """
    with mpmath.workdps(digits):
        entries = [sp.lambdify(S, e, "mpmath") for e in mode.impedance]
        rate, w = (mpmath.mpf(x.numerator) / x.denominator for x in (mode.rate, mode.frequency))
        s = mpmath.mpc(rate, w)
        try:
            here = _distance_from_singular(entries, mode, s)
        except ZeroDivisionError:
            here = None
        if 0 in mode.velocity and not any(held.clamped for held in mode.terminations):
            moved = 0 if mode.velocity[1] == 0 else 1
            near, far = (
                [abs(entries[k](s * (1 + mpmath.mpf(d)))) for k in (1 + moved, 2 - moved)]
                for d in ("1e-12", "1e-6")
            )
            # a pole, and a zero of the other entry that keeps the product finite
            return near[0] > 1e5 * far[0] and near[0] * near[1] < 10 * far[0] * far[1] + 1e-300
        beside = _distance_from_singular(entries, mode, s * mpmath.mpf("1.3717"))
        return here is not None and here < mpmath.mpf(10) ** (-digits // 2) < beside


def _distance_from_singular(entries, mode, s):
    ends = [
        None if h.clamped else sum(x * p for x, p in zip(_parts(h), (1, s, 1 / s), strict=True))
        for h in mode.terminations
    ]
    z11, z12, z21, z22 = (e(s) for e in entries)
    if ends[0] is None or ends[1] is None:
        impedance, end = (z11, ends[0]) if ends[1] is None else (z22, ends[1])
        return abs(impedance + end) / abs(impedance)
    left, right = (z11 + ends[0]) * (z22 + ends[1]), z12 * z21
    return abs(left - right) / (abs(left) + abs(right))


def _parts(held):
    sizes = (held.damping, held.inertia, held.stiffness)
    return [mpmath.mpf(x.numerator) / x.denominator for x in sizes]
