"""Claims on diagrams against the modes of all their states, held by passive parts at every port.

The attacker writes each controller in states of its own, those that a zero hides included, holds
the ports by random masses, dampers and springs, and looks at the eigenvalues of the whole.
"""

from collections import Counter
from fractions import Fraction

import control as ct
import mpmath
import numpy as np
import sympy as sp
from passivity.attacks.budget import attacked, near
from passivity.attacks.friction import bristle, drawn, largest
from passivity.attacks.rational import number, times

from teleopdesign import EFFECTS, Body, Value
from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import Control, Diagram, Junction, Moving, haptic_interface
from teleopdesign.passivity import Search, diagram_claims, ports
from teleopdesign.passivity.linear_diagrams import linear_claims

KINDS = ("springs and dampers", "filters", "a pole that grows", "a pole that grows, cancelled",
         "unequal gains", "springs and dampers, in series", "negative spring",
         "poles at 0, cancelled")  # fmt: skip
TWO = ("springs and dampers", "unequal gains", "springs and dampers, in series", "negative spring")
WHOLE = ("the port, any motion", "both ports, any motion", "all ports, any motion")


def transfer(rng, kind):
    """Stages (numerator, denominator) in series; with position in, force out."""
    k, b, a = number(rng) * 10, number(rng), number(rng)
    spring = [([a * b + k, a * k], [Fraction(1), a])]  # k + b s, low-passed
    if kind == "negative spring":
        return [([-k], [Fraction(1)])]
    if kind == "springs and dampers, in series":
        return [*spring, ([Fraction(1), a], [Fraction(1), a])]
    if kind == "poles at 0, cancelled":
        times_there = int(rng.integers(1, 3))
        slow = ([Fraction(1)], [Fraction(1), *[Fraction(0)] * times_there])
        roots = times(*[[Fraction(1), number(rng)]] * times_there)
        ends = ([k * c for c in slow[1]], roots)
        return [[slow, ends], [ends, slow], [(ends[0], slow[1])]][int(rng.integers(3))]
    if kind == "filters":
        return [([k], [Fraction(1)]), ([number(rng)], [Fraction(1), number(rng)])]
    if kind.startswith("a pole that grows"):
        p = number(rng) / 10 ** int(rng.integers(0, 3))
        grows = ([k], [Fraction(1), -p])
        near_it = 0 if kind.endswith("cancelled") else Fraction(1, 3)
        zero = ([Fraction(1), -p * (1 + near_it)], [Fraction(1), a])
        return [grows, zero] if rng.random() < 0.5 else [zero, grows]
    return spring


def random_diagram(rng, kind):
    """(masses, dampings, controls): controls are (from, to, sign, stages)."""
    # of two bodies the simple ones: a refutation of a high order takes a minute
    two = kind in TWO and rng.random() < 0.6
    masses = [number(rng) / 10 for _ in range(1 + two)]
    dampings = [number(rng) for _ in masses]
    stages = transfer(rng, kind)
    controls = [(0, 0, -1, stages)]
    if two:
        controls += [(1, 0, 1, stages), (0, 1, 1, stages), (1, 1, -1, stages)]
        if kind == "unequal gains":
            more = [(times([1 + number(rng) / 100], stages[0][0]), stages[0][1]), *stages[1:]]
            controls[2] = (0, 1, 1, more)
    return masses, dampings, controls


def as_diagram(masses, dampings, controls):
    parts, junctions, outside = [], [], {}
    for i, (m, b) in enumerate(zip(masses, dampings, strict=True)):
        body = Body("prismatic", {"inertia": Value(float(m))})
        body = body.with_effect(EFFECTS["viscous"], {"damping": float(b)})
        parts.append(Moving(f"M{i}", body, f"x{i}", f"u{i}", {f"f{i}": 1}, f"f{i}"))
        outside[f"f{i}"] = "force"
    terms = [{} for _ in masses]
    for k, (source, to, sign, stages) in enumerate(controls):
        signal = f"x{source}"
        for j, (p, q) in enumerate(stages):
            law = from_control(ct.tf([float(c) for c in p], [float(c) for c in q]), name="law")
            parts.append(Control(f"C{k}_{j}", law, signal, f"y{k}_{j}", f"x{source}"))
            signal = f"y{k}_{j}"
        terms[to][signal] = sign
    junctions = [Junction(f"u{i}", t) for i, t in enumerate(terms)]
    return Diagram("random", tuple(parts), tuple(junctions), outside, ())


def exactly(x):
    """The decimal that a float is written as: what the diagram is given."""
    return Fraction(repr(float(x)))


def matrix(masses, dampings, controls, held):
    """d/dt of (x, v of each body, states of each stage), exact; held: (mass, damper, spring)."""
    sizes = [[len(q) - 1 for _, q in stages] for *_, stages in controls]
    n = 2 * len(masses) + sum(map(sum, sizes))
    columns = []
    for unit in range(n):
        y = [Fraction(int(k == unit)) for k in range(n)]
        x, v = y[: len(masses)], y[len(masses) : 2 * len(masses)]
        at, rates, forces = 2 * len(masses), [], [Fraction(0)] * len(masses)
        for source, to, sign, stages in controls:
            signal = x[source]
            for p, q in stages:
                p, q = [exactly(c) for c in p], [exactly(c) for c in q]
                order = len(q) - 1
                p = [c / q[0] for c in [Fraction(0)] * (len(q) - len(p)) + p]
                q = [c / q[0] for c in q]
                z = y[at : at + order]  # controllable form
                last = signal - sum((q[order - k] * z[k] for k in range(order)), Fraction(0))
                rates += [*z[1:], last] if order else []
                out = p[0] * signal
                out += sum(
                    ((p[order - k] - p[0] * q[order - k]) * z[k] for k in range(order)), Fraction(0)
                )
                at, signal = at + order, out
            forces[to] += sign * signal
        moved = [
            (f - (exactly(b) + r) * vi - k * xi) / (exactly(m) + more)
            for f, b, vi, xi, m, (more, r, k) in zip(
                forces, dampings, v, x, masses, held, strict=True
            )
        ]
        columns.append([*v, *moved, *rates])
    return [[columns[j][i] for j in range(n)] for i in range(n)]


def grows(rng, system, tries=25):
    """Whether some mode grows between random passive terminations, seen again to fifty digits."""
    for k in range(tries):
        held = [
            tuple(
                Fraction(float(10 ** rng.uniform(-3, 3))).limit_denominator(10**6)
                * int(k > 0 and rng.random() < 0.5)
                for _ in range(3)
            )
            for _ in system[0]
        ]
        exact = matrix(*system, held)
        values = np.linalg.eigvals(np.array([[float(c) for c in row] for row in exact]))
        if values.real.max() < 1e-7 * np.abs(values).max():
            continue
        with mpmath.workdps(50):
            precise = mpmath.matrix(
                [[mpmath.mpf(c.numerator) / c.denominator for c in row] for row in exact]
            )
            values = mpmath.eig(precise, left=False, right=False)
            size = max(abs(e) for e in values)
            if max(e.real for e in values) > mpmath.mpf("1e-12") * size:
                return True
    return False


def chained(rng, system):
    """Whether a mode at 0 drives another one, between lossy springs: the rank of A and of A^2."""
    held = [tuple(number(rng) for _ in range(3)) for _ in system[0]]
    exact = sp.Matrix([[sp.Rational(c) for c in row] for row in matrix(*system, held)])
    return exact.rank() != (exact * exact).rank()


@attacked(2, 15)
def test_no_mode_grows_in_a_diagram_that_is_proved_at_all_its_ports(seed, number):
    rng = np.random.default_rng(seed)
    counts = Counter()
    for k in range(number):
        kind = KINDS[k % len(KINDS)]
        system = random_diagram(rng, kind)
        diagram = as_diagram(*system)
        claims = linear_claims(diagram, ports(diagram))
        proved = [c.topic for c in claims if c.claim.status == "proved"]
        unstable = grows(rng, system) or chained(rng, system)
        assert not (proved and unstable), (kind, system, proved)
        counts[bool(proved), unstable] += 1
    print(dict(counts))
    assert counts[True, False] >= number / 8 and counts[False, True] >= number / 8


@attacked(1, 10)
def test_no_motion_beats_a_diagram_with_friction_that_is_proved(seed, number):
    """Viscous and Coulomb friction, or a bristle, and a compensator: the claim on the whole."""
    rng = np.random.default_rng(seed)
    counts = Counter()
    for _ in range(number):
        f_c, b = (float(10 ** rng.uniform(-1, 1)) for _ in range(2))
        stiffness, gives = f_c * 1e4, rng.random() < 0.6
        body = Body("prismatic", {"inertia": Value(0.1)})
        body = body.with_effect(EFFECTS["viscous"], {"damping": b})
        body = body.with_effect(EFFECTS["coulomb"], {"level": f_c})
        if gives:
            presliding = EFFECTS["presliding"].without("bristle_damping")
            body = body.with_effect(presliding, {"stiffness": stiffness})
        f_d = near(rng, f_c) if rng.random() < 0.6 else f_c * rng.uniform(0.2, 1)
        softness = near(rng, stiffness * np.sqrt(f_d / f_c))
        law = controller("dahl", {"level": f_d, "stiffness": softness})
        diagram = haptic_interface(body, cancellation=law)
        claims = diagram_claims(diagram, rng=rng, search=Search(tries=1)).claims
        proved = any(c.claim.status == "proved" and c.topic in WHOLE for c in claims)

        def helped(d, x, v, share, f_d=f_d, softness=softness):
            return bristle(d, x, f_d, softness)

        def resisted(p, x, v, share, f_c=f_c, stiffness=stiffness, b=b, gives=gives):
            p, work = bristle(p, x, f_c, stiffness) if gives else (p, f_c * np.abs(x))
            return p, work + b * v * np.abs(x)

        motions = drawn(rng, 2000, 12, [f_d / softness, f_c / stiffness], [1e-4 * f_c / b])
        turned = f_d * np.abs(motions[:, :, 0]).sum(axis=1)
        most = float((largest(motions, helped, resisted) / turned).max())
        assert not (proved and most > 1e-9), (f_c, f_d, softness, gives, most)
        counts[proved, most > 1e-9] += 1
    print(dict(counts))
    assert counts[True, False]
