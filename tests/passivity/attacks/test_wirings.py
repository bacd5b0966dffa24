"""Claims on wirings that are strange on purpose, against equations that the attacker writes.

Bodies, laws with states, systems of several inputs, delays that do nothing, sums that feed
themselves: each wiring is written twice, as a diagram and as E dx/dt = A x + B f, all signals and
states among x. Its modes with free ports are the roots of det(s E - A), all of them, what no port
shows included; its admittance is what follows from the same equations on the axis.
"""

from collections import Counter
from fractions import Fraction

import control as ct
import mpmath
import numpy as np
import pytest
import scipy.linalg
from devices import body
from passivity.attacks.budget import attacked

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import (
    ControlLaw,
    Controller,
    ControllerState,
    Stage,
    controller,
    from_control,
)
from teleopdesign.diagrams import Attached, Control, Diagram, Junction, Moving, controller_parts
from teleopdesign.effects import Parameter
from teleopdesign.passivity import ports
from teleopdesign.passivity.linear_diagrams import linear_claims

UNBOUNDED = {"lower": -float("inf"), "upper": float("inf")}
#: z' = a z + b input, output c z + d input: any sign of each
STATE_LAW = ControlLaw(
    law=lambda now, p: p.c * now.z + p.d * now.input,
    states={"z": ControllerState("dimensionless", lambda now, p: p.a * now.z + p.b * now.input)},
    parameters={n: Parameter("dimensionless", "any", **UNBOUNDED) for n in "abcd"},
    linear=True,
    name="law_with_a_state",
)


class Wiring:
    """A diagram and its equations, written side by side; rows of E and A by name."""

    def __init__(self, name):
        self.name, self.blocks, self.sums, self.outside = name, [], [], {}
        self.rows, self.at_ports = [], {}

    def equation(self, rates=None, **terms):
        """sum of rates * d/dt + terms = 0."""
        self.rows.append((rates or {}, terms))

    def body(self, name, m, b=0.0, k=0.0, *, loads=None, driver=None, command=""):
        driver = driver or f"f{name}"
        loads = {driver: 1.0} if loads is None else loads
        values = {"viscous__damping": b} | ({"spring__stiffness": k} if k else {})
        x, command = f"x{name}", command or f"u{name}"
        self.blocks.append(Moving(f"M{name}", body(m, **values), x, command, loads, driver))
        self.outside[driver] = "force"
        self.equation({x: -1.0}, **{f"v{name}": 1.0})
        terms = {f"v{name}": -b, x: -k}
        for signal, w in [(command, 1.0), *loads.items()]:
            terms[signal] = terms.get(signal, 0.0) + w
        self.equation({f"v{name}": -m}, **terms)
        self.at_ports.setdefault(driver, {})
        return x

    def attached(self, name, x, force, m, b, k, sign):
        values = {"viscous__damping": b} | ({"spring__stiffness": k} if k else {})
        self.blocks.append(Attached(f"A{name}", body(m, **values), x, force, sign))
        v = "v" + x[1:]
        self.equation({v: sign * m}, **{force: -1.0, v: sign * b, x: sign * k})

    def junction(self, output, **terms):
        self.sums.append(Junction(output, terms))
        self.equation(**{output: -1.0, **terms})

    def system(self, name, a, b, c, d, source, output, *, kind="ss"):
        """One input, one output."""
        a, b, c = np.atleast_2d(a), np.atleast_1d(b), np.atleast_1d(c)
        if kind == "ss":
            law = from_control(ct.ss(a, b[:, None], c[None], [[d]]))
        elif kind == "law":
            values = dict(zip("abcd", map(float, (a[0, 0], b[0], c[0], d)), strict=True))
            law = Controller((Stage(STATE_LAW, values),))
        self.blocks.append(Control(f"C{name}", law, source, output))
        self.states(name, a, b[:, None], c[None], [[d]], [source], [output])

    def states(self, name, a, b, c, d, inputs, outputs):
        z = [f"z_{name}_{i}" for i in range(len(a))]
        for i in range(len(a)):
            terms = dict(zip(z, a[i], strict=True))
            for j, u in enumerate(inputs):
                terms[u] = terms.get(u, 0.0) + b[i][j]
            self.equation({z[i]: -1.0}, **terms)
        for i, y in enumerate(outputs):
            terms = dict(zip(z, c[i], strict=True)) if len(z) else {}
            for j, u in enumerate(inputs):
                terms[u] = terms.get(u, 0.0) + d[i][j]
            terms[y] = terms.get(y, 0.0) - 1.0
            self.equation(**terms)

    def matrix_system(self, name, a, b, c, d, inputs, outputs):
        made = ct.ss(a, b, c, d)
        controls, sums = controller_parts(
            made, name=f"C{name}", inputs=tuple(inputs), outputs=tuple(outputs), motion=""
        )
        self.blocks += controls
        self.sums += sums
        self.states(name, a, b, c, d, inputs, outputs)

    def gain(self, name, g, source, output):
        law = from_control(ct.tf([g], [1.0])) if g < 0 else controller("gain", {"gain": g})
        self.blocks.append(Control(f"C{name}", law, source, output))
        self.equation(**{output: -1.0, source: g})

    def delay(self, name, time, source, output):
        self.blocks.append(Control(f"C{name}", controller("delay", {"time": time}), source, output))
        self.equation(**{output: -1.0, source: 1.0})

    def diagram(self):
        return Diagram(self.name, tuple(self.blocks), tuple(self.sums), self.outside, ())

    def pencil(self):
        """E, A, B (a column for each force), exact; names of x."""
        forces = list(self.outside)
        names = sorted({n for r, t in self.rows for n in (*r, *t)} - set(forces))
        assert len(names) == len(self.rows), (names, len(self.rows))
        at = {n: k for k, n in enumerate(names)}
        e, a, b = (
            [[Fraction(0)] * n for _ in self.rows] for n in (len(names), len(names), len(forces))
        )
        for i, (rates, terms) in enumerate(self.rows):
            for n, w in rates.items():
                e[i][at[n]] -= Fraction(repr(float(w)))
            for n, w in terms.items():
                if n in at:
                    a[i][at[n]] += Fraction(repr(float(w)))
                else:
                    b[i][forces.index(n)] += Fraction(repr(float(w)))
        return e, a, b, names, forces


def exact_modes(e, a):
    """Roots of det(s E - A) to 60 digits; None where it is zero for all s."""
    n = len(a)
    points = range(-(n // 2) - 1, n // 2 + 2)
    values = [
        determinant([[s * e[i][j] - a[i][j] for j in range(n)] for i in range(n)]) for s in points
    ]
    coefficients = interpolated(list(points), values)
    while coefficients and not coefficients[-1]:
        coefficients.pop()
    if not coefficients:
        return None
    low = next(k for k, c in enumerate(coefficients) if c)
    kept = coefficients[low:][::-1]
    if len(kept) == 1:
        return [mpmath.mpc(0)] * low
    with mpmath.workdps(120):
        numbers = [mpmath.mpf(c.numerator) / c.denominator for c in kept]
        size = mpmath.power(abs(numbers[-1] / numbers[0]), mpmath.mpf(1) / (len(kept) - 1))
        degree = len(kept) - 1
        scaled = [c * size ** (degree - k) for k, c in enumerate(numbers)]
        top = max(map(abs, scaled))
        roots = mpmath.polyroots(
            [c / top for c in scaled], maxsteps=2000, extraprec=600, error=False
        )
        return [mpmath.mpc(0)] * low + [r * size for r in roots]


def determinant(m):
    m, sign = [row[:] for row in m], Fraction(1)
    for k in range(len(m)):
        pivot = next((i for i in range(k, len(m)) if m[i][k]), None)
        if pivot is None:
            return Fraction(0)
        if pivot != k:
            m[k], m[pivot], sign = m[pivot], m[k], -sign
        for i in range(k + 1, len(m)):
            if m[i][k]:
                ratio = m[i][k] / m[k][k]
                m[i] = [x - ratio * y if y else x for x, y in zip(m[i], m[k], strict=True)]
    for k in range(len(m)):
        sign *= m[k][k]
    return sign


def interpolated(points, values):
    """Coefficients, lowest first (Newton)."""
    table, n = list(values), len(points)
    for k in range(1, n):
        for i in range(n - 1, k - 1, -1):
            table[i] = (table[i] - table[i - 1]) / (points[i] - points[i - k])
    out = [table[-1]]
    for k in range(n - 2, -1, -1):
        shifted = [Fraction(0), *out]
        out = [x - points[k] * y for x, y in zip(shifted, [*out, Fraction(0)], strict=True)]
        out[0] += table[k]
    return out


def growth(wiring):
    """Largest real part of all modes over the largest mode, exactly; inf: equations fail."""
    e, a, *_ = wiring.pencil()
    modes = exact_modes(e, a)
    if modes is None:
        return np.inf
    return max(
        (float(r.real / max(abs(r), mpmath.mpf("1e-300"))) for r in modes if r), default=-1.0
    )


def port_rows(wiring, diagram, names, forces):
    """Velocities of the ports, (ports, x), and their forces, as the claim has them."""
    rows, order = [], []
    for port in ports(diagram):
        row = np.zeros(len(names))
        for motion, weight in port.weights.items():
            row[names.index("v" + motion[1:])] = float(weight)
        rows.append(row)
        order.append(forces.index(port.force))
    return np.array(rows), order


def least_power(wiring, diagram):
    """Least eigenvalue of Y + Y^H on the axis over its largest entry, at ports that are moved."""
    e, a, b, names, forces = wiring.pencil()
    c, order = port_rows(wiring, diagram, names, forces)
    lowest, where = np.inf, None
    ef, af, bf = (np.array(m, dtype=float) for m in (e, a, b))
    with np.errstate(all="ignore"):
        modes = scipy.linalg.eigvals(af, ef)
    sizes = np.abs(modes[np.isfinite(modes)])
    sizes = sizes[(sizes > 1e-9) & (sizes < 1e9)]
    ends = (sizes.min() / 100, sizes.max() * 100) if len(sizes) else (1e-3, 1e3)
    for w in (*np.geomspace(*ends, 160), *sizes, *(sizes * 1.001), *(sizes * 0.999)):
        try:
            y = c @ np.linalg.solve(1j * w * ef - af, bf[:, order])
        except np.linalg.LinAlgError:
            continue
        if not np.isfinite(y).all() or not np.abs(y).max():
            continue
        h = np.linalg.eigvalsh((y + y.conj().T) / 2)[0] / np.abs(y).max()
        if h < lowest:
            lowest, where = h, w
    return lowest, where


def exactly(x):
    return mpmath.mpf(x.numerator) / x.denominator


def exact_power(wiring, diagram, w):
    """The same at one frequency to 50 digits."""
    e, a, b, names, forces = wiring.pencil()
    c, order = port_rows(wiring, diagram, names, forces)
    with mpmath.workdps(50):
        n = len(a)
        m = mpmath.matrix(n, n)
        for i in range(n):
            for j in range(n):
                m[i, j] = mpmath.mpc(-exactly(a[i][j]), exactly(e[i][j]) * mpmath.mpf(w))
        right = mpmath.matrix(n, len(order))
        for i in range(n):
            for k, j in enumerate(order):
                right[i, k] = exactly(b[i][j])
        columns = [mpmath.lu_solve(m, right[:, k]) for k in range(len(order))]
        y = mpmath.matrix(len(order), len(order))
        for i in range(len(order)):
            for k in range(len(order)):
                y[i, k] = sum(mpmath.mpf(c[i][j]) * columns[k][j] for j in range(n))
        h = (y + y.H) / 2
        values = mpmath.eighe(h, eigvals_only=True)
        return float(min(values) / max(abs(x) for x in y))


def pick(rng, low=-1.0, high=1.0):
    return float(f"{10 ** rng.uniform(low, high):.3g}")


def sign(rng):
    return float(rng.choice([-1.0, 1.0]))


def stable_law(rng, name, w, source, output, kind="ss"):
    """Low-passed spring or damper, or a pole that grows."""
    a = -pick(rng) if rng.random() < 0.8 else pick(rng, -3, 0)
    d = pick(rng) * rng.integers(0, 2)
    w.system(name, [[a]], [1.0], [sign(rng) * pick(rng)], d, source, output, kind=kind)


def sums_that_feed_themselves(rng):
    """A law with direct feed-through around a sum, at the port or beside it."""
    w = Wiring("sums")
    w.body("1", pick(rng, -2, 0), pick(rng), pick(rng) * rng.integers(0, 2))
    d = pick(rng, -1, 1) * sign(rng)
    back = float(rng.choice([1 / d if 1 / d == float(f"{1 / d:.12g}") else 1.0, -1.0, 0.5, 2.0]))
    d = 1.0 if rng.random() < 0.2 else d
    back = 1.0 if rng.random() < 0.2 else back
    a = -pick(rng) if rng.random() < 0.6 else pick(rng, -2, 0)
    c = pick(rng) * sign(rng) * rng.integers(0, 2)
    is_observed = rng.random() < 0.5
    w.junction("e", x1=1.0, y=back)
    w.system("L", [[a]], [1.0], [c], d, "e", "y", kind=str(rng.choice(["ss", "law"])))
    w.junction("u1", **({"y": -pick(rng)} if is_observed else {"x1": -pick(rng)}))
    return w


def one_signal_twice(rng):
    """A law's output through two sums, a force twice among what drives, terms that cancel."""
    w = Wiring("twice")
    two = rng.random() < 0.5
    load = {"f1": 1.0, "y": sign(rng)} if rng.random() < 0.5 else {"f1": sign(rng) * 2.0}
    w.body("1", pick(rng, -2, 0), pick(rng), loads=load, driver="f1")
    stable_law(rng, "L", w, "x1", "y", str(rng.choice(["ss", "law"])))
    a, b = (float(rng.choice([1.0, -1.0, 0.5])) for _ in range(2))
    if two:
        w.body("2", pick(rng, -2, 0), pick(rng), loads={"f2": 1.0, "y": -sign(rng)}, driver="f2")
        w.junction("u2", s=b, y=float(rng.choice([1.0, -1.0])))
    w.junction("s", y=a, x1=-pick(rng))
    w.junction("u1", s=1.0, y=-a if rng.random() < 0.5 else b)
    return w


def forces_on_several_bodies(rng):
    """A force from outside on two bodies by lever arms of either sign, a spring between them."""
    w = Wiring("levers")
    arm = sign(rng) * float(rng.choice([1.0, 0.5, 2.0]))
    w.outside["f"] = "force"
    w.body("1", pick(rng, -2, 0), pick(rng), loads={"f": sign(rng)}, driver="f")
    w.body("2", pick(rng, -2, 0), pick(rng), loads={"g": 1.0}, driver="f")
    w.junction("g", f=arm)
    k = [pick(rng) for _ in range(2)]
    k[1] = k[0] if rng.random() < 0.6 else k[1]
    w.junction("d", x1=1.0, x2=-1.0)
    w.gain("1", -k[0], "d", "u1")
    w.gain("2", k[1], "d", "u2")
    return w


def beside_the_port(rng):
    """A law whose output reaches nothing, or in what cancels, its pole on either side."""
    w = Wiring("beside")
    w.body("1", pick(rng, -2, 0), pick(rng), pick(rng) * rng.integers(0, 2))
    a = sign(rng) * pick(rng, -6, 0) * float(rng.random() < 0.8)
    b = pick(rng, -9, 0) * float(rng.random() < 0.7)
    kind = str(rng.choice(["ss", "law"]))
    w.system("L", [[a]], [b], [pick(rng)], 0.0, "x1", "y", kind=kind)
    if rng.random() < 0.5:
        w.system("N", [[a]], [b], [pick(rng)], 0.0, "y", "n", kind=kind)
    w.junction("u1", x1=-pick(rng), **({"y": -pick(rng, -9, -3)} if rng.random() < 0.3 else {}))
    return w


def shared_between_bodies(rng):
    """A system of two inputs and outputs between two bodies: springs, direct terms, what grows."""
    w = Wiring("shared")
    for i in "12":
        w.body(i, pick(rng, -2, 0), pick(rng))
    n = int(rng.integers(1, 3))
    a = -np.diag([pick(rng) for _ in range(n)])
    if rng.random() < 0.4:
        a[0, 0] = pick(rng, -4, 0)
    c = np.array([[pick(rng) * sign(rng) * rng.integers(0, 2) for _ in range(n)] for _ in range(2)])
    b = -c.T if rng.random() < 0.6 else np.array(
        [[pick(rng) * sign(rng) * rng.integers(0, 2) for _ in range(2)] for _ in range(n)]
    )  # fmt: skip
    k = pick(rng)
    d = np.array([[-k, k], [k, -k]]) if rng.random() < 0.7 else -np.diag([k, pick(rng)])
    w.matrix_system("K", a, b, c, d, ["x1", "x2"], ["u1", "u2"])
    return w


def scales_far_apart(rng):
    """Masses from 1e-6, stiffnesses to 1e6, dampings to 1e-6, poles from 1e-6 to 1e6."""
    w = Wiring("scales")
    w.body("1", pick(rng, -6, 2), pick(rng, -6, 2), pick(rng, -6, 6) * rng.integers(0, 2))
    a = -pick(rng, -6, 6)
    c = sign(rng) * pick(rng, -3, 3) * abs(a) if rng.random() < 0.7 else -abs(a) * pick(rng, -6, 6)
    d = -c / a if rng.random() < 0.5 else pick(rng, -3, 6) * rng.integers(0, 2)
    d = float(f"{d:.3g}")
    w.system("L", [[a]], [1.0], [c], d, "x1", "y", kind=str(rng.choice(["ss", "law"])))
    w.junction("u1", y=-1.0)
    return w


def three_ports(rng):
    """Three bodies with springs between them, one of them felt more one way."""
    w = Wiring("three")
    more = float(rng.choice([1.0, 1.0, 1.0, 1 + pick(rng, -4, -1)]))
    for i in "123":
        w.body(i, pick(rng, -2, 0), pick(rng) * rng.integers(0, 2))
    k, q = pick(rng), pick(rng)
    w.junction("u1", x1=-k, x2=k * more)
    w.junction("u2", x1=k, x2=-k - q, x3=q)
    w.junction("u3", x2=q, x3=-q)
    return w


def signs_turned(rng):
    """An attached body with its sign turned, springs that push, gains below zero."""
    w = Wiring("signs")
    m, b, k = pick(rng, -2, 0), pick(rng), pick(rng) * rng.integers(0, 2)
    w.body("1", m, b, k, loads={"f1": sign(rng), "h": 1.0}, driver="f1")
    way = int(rng.choice([1, -1]))
    share = float(rng.choice([0.3, 0.9, 1.0, 1.1]))
    lossy = float(rng.choice([0.3, 1.0, 2.0]))
    numbers = (float(f"{x:.3g}") for x in (m * share, b * lossy, k * share))
    w.attached("H", "x1", "h", *numbers, way)
    w.gain("G", sign(rng) * pick(rng), "x1", "u1")
    return w


def high_passes(rng):
    """A high-pass that feeds itself to become a derivative, another one, and what grows in it."""
    w = Wiring("high passes")
    w.body("1", pick(rng, -2, 0), pick(rng), pick(rng) * rng.integers(0, 2))
    p = -pick(rng) if rng.random() < 0.7 else pick(rng)
    back = 1.0 if rng.random() < 0.6 else float(rng.choice([0.5, -1.0]))
    w.junction("e", x1=1.0, y=back)
    w.system("L", [[p]], [1.0], [p], 1.0, "e", "y")  # s/(s - p)
    source = "y"
    if rng.random() < 0.4:
        w.junction("e2", y=1.0, y2=back)
        w.system("N", [[-1.0]], [1.0], [-1.0], 1.0, "e2", "y2")
        source = "y2"
    w.junction("u1", **{source: sign(rng) * pick(rng, -3, 0)})
    return w


def delays_that_do_nothing(rng):
    """Delays of no time in a loop, and of any time before a gain of zero, beside what grows."""
    w = Wiring("delays")
    w.body("1", pick(rng, -2, 0), pick(rng))
    stable_law(rng, "L", w, "x1", "y")
    gone = rng.random() < 0.5
    w.delay("T", 0.05 * float(gone and rng.random() < 0.5), "y", "late")
    w.gain("G", 0.0 if gone else sign(rng) * pick(rng), "late", "g")
    w.junction("u1", g=-1.0)
    return w


FAMILIES = (
    sums_that_feed_themselves, one_signal_twice, forces_on_several_bodies, beside_the_port,
    shared_between_bodies, scales_far_apart, three_ports, signs_turned, high_passes,
    delays_that_do_nothing,
)  # fmt: skip


def contradiction(wiring, diagram, claims):
    """Why a proved claim is false, or ""; and whether any is proved."""
    proved = [c for c in claims if c.claim.status == "proved"]
    if proved and growth(wiring) > 1e-25:
        return f"grows {growth(wiring)}", proved
    if any("motion" in c.topic for c in proved):
        least, w = least_power(wiring, diagram)
        if least < -1e-9 and exact_power(wiring, diagram, w) < -1e-15:
            return f"takes out {least} at {w}", proved
    return "", proved


def judge(family, rng, counts):
    wiring = family(rng)
    try:
        diagram = wiring.diagram()
        claims = linear_claims(diagram, ports(diagram))
    except ModelError as problem:
        counts[family.__name__, "refused: " + str(problem)[:40]] += 1
        return
    why, proved = contradiction(wiring, diagram, claims)
    assert not why, (family.__name__, why, claims, wiring.blocks, wiring.sums)
    counts[family.__name__, "/".join(c.claim.status for c in claims)] += 1


@pytest.mark.parametrize("family", FAMILIES, ids=lambda f: f.__name__)
@attacked(1, 10)
def test_no_strange_wiring_is_proved_that_grows_or_gives_out_energy(family, seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for _ in range(number):
        judge(family, rng, counts)
    print(dict(counts))
