"""Compensation of ideal Coulomb friction: P37 to P42.

The joint obeys m a = u_link + f_comp - f_friction + f_ext: the compensator pushes along the motion,
friction against it. Energy given out by the pair is the work of the compensator less the work that
friction takes.
"""

from __future__ import annotations

import numpy as np
import sympy as sp
from scipy.optimize import brentq

from ..blocks import Body, Value
from ..controllers import controller
from ..diagrams import haptic_interface
from ..effects import EFFECTS
from ..simulate import simulate
from ._laws import coulomb, dahl_rate, dahl_step, smoothed_coulomb, viscous
from ._proof import Equal, Grows, Holds, Limit, NotNegative, ProofStep, ProofSteps, proof
from ._statement import DERIVED, MAHVASH, Figure, Numbers, claim, figure_near, shows
from .dahl_loop import SHARE, loop_energy, rising_share

f_C, f_D, sigma, w, X, u, B, a, d = sp.symbols("f_C f_D sigma_D w X u B a d", positive=True)
f = sp.Symbol("f", real=True)
SIZE, MORE, UNUSED = sp.symbols("size more unused", nonnegative=True)
UNDER = f_C - f_D


def pair_power(force: sp.Expr, velocity: sp.Expr) -> sp.Expr:
    """Power that the pair of friction and compensation takes in."""
    return (coulomb(velocity, f_C) - force) * velocity


@shows(37, MAHVASH, "eqs (12) to (21)")
def saturated_compensator() -> ProofSteps:
    """Ideal Coulomb friction with any compensator that stays within the friction level is passive
    at every instant, with no stored energy. Such pairs, added to the joints of a passive
    teleoperator, keep the teleoperator passive.

    formula: (f_C sgn v - f_dahl) v >= (f_C - abs(f_dahl)) abs(v) >= 0 for abs(f_dahl) <= f_D <= f_C
    printed: f_c, f_C and f_D are mixed in (15), (16); the sign in (11) is that of the resisting
        force
    """
    steps: list[ProofStep] = []
    for way in (1, -1):
        for side in (1, -1):
            here = f"v {'>' if way > 0 else '<'} 0, f_dahl {'>' if side > 0 else '<'} 0"
            power = pair_power(side * SIZE, way * w)
            steps.append(
                NotNegative(
                    f"power less (f_C - abs(f_dahl)) abs(v): {here}",
                    power - (f_C - SIZE) * w,
                    SIZE * w * (1 - way * side),
                )
            )
    return proof(
        steps,
        NotNegative(
            "that bound is not negative; powers of joints and of the teleoperator add up",
            (f_C - SIZE) * w,
            (MORE + UNUSED) * w,
            {MORE: f_D - SIZE, UNUSED: UNDER},
        ),
        assuming=[UNDER, f_D - SIZE],
    )


@shows(38, MAHVASH, "section IV-B")
def only_saturation_counts() -> ProofSteps:
    """From a force within its level, eq (9) stays within the level for any next positions: late,
    held, rounded or noisy. So do smoothed Coulomb friction and a force of the wrong sign, and P37
    covers all of them. A step of forward Euler with q = 3/2 leaves the level and releases energy.

    formula: only abs(f_comp) <= f_D <= f_C is used, at every instant
    printed: proved for the Dahl compensator; its forward Euler step leaves the level, here at q =
        3/2
    """
    above, below, rest = sp.symbols("above below rest", nonnegative=True)
    q = sp.Symbol("q", positive=True)
    kept = sp.exp(-sigma * d / f_D)
    up = dahl_step(f, d, 1, f_D, sigma)
    levels = {above: f_D - f, below: f_D + f, rest: 1 - kept}
    v = sp.Symbol("v", positive=True)
    euler = f + dahl_rate(f, q * f_D / sigma, f_D, sigma)
    twice = euler.subs({f: -f_D, q: sp.Rational(3, 2)})
    return proof(
        Grows(
            "share of the distance to the level that a travel takes away",
            1 - kept,
            d,
            sigma / f_D * kept,
        ),
        NotNegative(
            "eq (9) stays below f_D for any next position, late, rounded or noisy",
            f_D - up,
            above * kept,
            levels,
        ),
        NotNegative("and above -f_D", f_D + up, below * kept + 2 * f_D * rest, levels),
        NotNegative(
            "smoothed Coulomb friction too",
            f_D - smoothed_coulomb(v, f_D, a),
            f_D * a / (a + v),
            strictly=True,
        ),
        NotNegative("-f has the same size as f: a wrong sign", f**2 - (-f) ** 2, sp.S(0)),
        Equal("forward Euler, q = 3/2, f_D = f_C: from -f_D to", twice, 2 * f_D),
        NotNegative(
            "moving on, the pair then gives out f_C abs(v)",
            -pair_power(twice.subs(f_D, f_C), w) - f_C * w,
            sp.S(0),
        ),
        assuming=[f_D - f, f_D + f],
    )


@shows(39, DERIVED, "converse of Mahvash 2006, eq (21)")
def unlimited_motion() -> ProofSteps:
    """The bound is tight where the travel is unlimited.

    formula: given out over X one way: (f_D - f_C) X - f_D lambda (1 - exp(-X/lambda)); passive for
        all motions iff f_D <= f_C
    """
    s = sp.Symbol("s", positive=True)
    energy = sp.integrate(dahl_step(sp.S(0), s, 1, f_D, sigma) - coulomb(w, f_C), (s, 0, X))
    scale = f_D / sigma
    over = sp.Symbol("over", positive=True)
    return proof(
        Equal(
            "energy given out, from f = 0",
            energy,
            (f_D - f_C) * X - f_D * scale * (1 - sp.exp(-X / scale)),
        ),
        Limit(
            "f_D = f_C + over: without bound",
            energy.subs(f_C, f_D - over).subs({f_D: 1, sigma: 1}) / X,
            X,
            sp.oo,
            over,
        ),
    )


def needed_amplitude() -> Numbers:
    """Amplitude u above which a ratio f_D/f_C gives out energy, and simulations near it."""
    # half of the last digit stated
    table: dict[float, tuple[float, float]] = {1.02: (51, 0.5), 1.05: (21, 0.5), 1.1: (11, 0.5)}
    table |= {1.2: (6, 0.5), 1.5: (2.98, 0.005), 2.0: (1.92, 0.005)}
    figures = [
        figure_near(
            f"u from which f_D = {ratio} f_C gives out energy",
            float(brentq(lambda x, r=ratio: r * (1 - np.tanh(x) / x) - 1, 1e-3, 1e3)),
            *expected,
        )
        for ratio, expected in table.items()
    ]
    for ratio, bristle, grows in ((1.05, 5e-5, True), (1.05, 1e-3, False), (1.2, 1e-3, False)):
        size = swing(ratio, bristle)
        what = f"f_D = {ratio} f_C, lambda {1e3 * bristle:g} mm: last swing over first"
        low, high = (1.0, np.inf) if grows else (-np.inf, 1.0)
        figures.append(Figure(what, size, low, high))
    return Numbers(tuple(figures))


def swing(ratio: float, bristle: float) -> float:
    """Last amplitude over first of a mass on a spring, Coulomb friction compensated by Dahl.

    0.1 kg on 400 N/m (10 Hz), 0.5 N, started 2 mm from rest, 0.5 s

    ratio: f_D/f_C;  bristle: f_D/sigma_D (m)
    """
    level = 0.5
    device = Body("prismatic", {"inertia": Value(0.1)})
    device = device.with_effect(EFFECTS["coulomb"], {"level": level})
    device = device.with_effect(EFFECTS["spring"], {"stiffness": 400.0})
    values = {"level": ratio * level, "stiffness": ratio * level / bristle}
    output = simulate(
        haptic_interface(device, cancellation=controller("dahl", values)),
        duration=0.5,
        initial={"L": 2e-3},
        computer="continuous",
        give=1e-6,
    )["L"].values
    return float(np.abs(output[-110:]).max() / 2e-3)  # the last cycle and a tenth


@shows(40, DERIVED, "converse of Mahvash 2006, eq (21)", numbers=needed_amplitude)
def limited_motion() -> ProofSteps:
    """For plain cycles of limited amplitude the bound is not tight: with a soft compensator
    over-compensation shows only in large motion. Steps at the reversals show over-compensation
    earlier, see P56.

    formula: a cycle of amplitude A gives out energy iff f_D (1 - tanh(u)/u) > f_C,  u = sigma_D
        A/f_D
    """
    amplitude = u * f_D / sigma
    released = loop_energy(f_D, sigma, amplitude) / (4 * amplitude) - coulomb(w, f_C)
    return proof(Equal("energy given out per travel", released, f_D * SHARE - f_C), rising_share())


onset = claim(
    41,
    MAHVASH,
    "experiment",
    "Instability began when f_D exceeded the identified Coulomb level of the prismatic joint.",
    (39, 40),
)


@shows(42, DERIVED, "with a damper")
def damped_excess() -> ProofSteps:
    """Viscous damping limits the effect of over-compensation: the device is not passive, but
    self-motion stops growing at v*.

    formula: f_D > f_C: speed tends to v* = (f_D - f_C)/B
    """
    top = (f_C - f_D) / -B
    net = f_D - coulomb(w, f_C) - viscous(w, B)  # at w > 0, compensator at its level
    slow = sp.Symbol("slow", positive=True)
    return proof(
        Equal("force on the moving joint", net, B * (top - w)),
        NotNegative(
            "slower than v*: it speeds up",
            net.subs(f_D, f_C + B * (w + slow)),
            B * slow,
            strictly=True,
        ),
        NotNegative("faster: it slows down", -net.subs(w, top + slow), B * slow, strictly=True),
        Holds(
            "at rest it gives out energy: f_D = 2, f_C = 1, B = 1, v = 1/2",
            net.subs({f_D: 2, f_C: 1, B: 1, w: sp.Rational(1, 2)}),
            ">",
            0,
        ),
    )
