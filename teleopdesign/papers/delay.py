"""Compensation with a delay: P47 to P49. Energy is that *given out* by the compensator."""

from __future__ import annotations

import numpy as np
import sympy as sp
from scipy.optimize import brentq

from ._laws import dahl_rate
from ._proof import Equal, Holds, Limit, NotNegative, ProofSteps, proof
from ._statement import BERNSTEIN, DERIVED, Numbers, figure_near, numbers_of, shows
from .dahl_loop import POSITIVE_SHARE
from .describing_functions import DAHL_FRICTION, DAHL_SPRING, u
from .describing_functions import f as DAHL_LEVEL

angle, a1, b1 = sp.symbols("theta a_1 b_1", real=True)
A, f_D, f_C, omega, tau, mass = sp.symbols("A f_D f_C omega tau m_hat", positive=True)
late = omega * tau
FRICTIONLIKE, SPRINGLIKE, TURN = sp.symbols("frictionlike springlike turn", nonnegative=True)


def work_over_cycle(force: sp.Expr) -> sp.Expr:
    """Work of a force, an expression in `angle`, over a cycle of x = A sin(angle)."""
    return sp.integrate(sp.expand(sp.expand_trig(force * A * sp.cos(angle))), (angle, 0, 2 * sp.pi))


LATE_FRICTION = work_over_cycle(a1 * sp.sin(angle - late) + b1 * sp.cos(angle - late))


@shows(47, DERIVED, "delay in eq (9) of Mahvash 2006")
def late_friction() -> ProofSteps:
    """A late friction compensator releases less energy: it under-compensates and pushes against the
    motion after a reversal. A user feels this push, but it dissipates.

    formula: W = pi A (b_1 cos(omega tau) - a_1 sin(omega tau)), a_1 = 2 f_D I_1(u)/cosh u, b_1 = (4
        f_D/pi)(1 - tanh(u)/u); Coulomb: 4 f_D A cos(omega tau)
    assumes: pi I_1(u) = integral of e^(u cos t) cos t over 0..pi (DLMF 10.32.3)
    """
    k = sp.Symbol("k", integer=True, positive=True)
    shift, c = sp.Symbol("shift", real=True), sp.Symbol("c", positive=True)
    harmonic = sp.sin((k + 1) * angle + shift) * sp.cos(angle)
    whole = -sp.cos((k + 2) * angle + shift) / (2 * (k + 2)) - sp.cos(k * angle + shift) / (2 * k)
    turned = (angle, angle + 2 * sp.pi)
    return proof(
        Equal(
            "higher harmonics k + 1 do no work: antiderivative",
            sp.expand_trig(sp.expand(sp.diff(whole, angle) - harmonic)),
            0,
        ),
        Equal(
            "is periodic",
            sp.expand_trig(sp.expand(whole.subs(*turned))) - sp.expand_trig(sp.expand(whole)),
            0,
        ),
        Equal(
            "first harmonic, late by tau",
            LATE_FRICTION,
            sp.pi * A * (b1 * sp.cos(late) - a1 * sp.sin(late)),
        ),
        Equal(
            "Coulomb: a_1 = 0, b_1 = 4 f_D/pi",
            LATE_FRICTION.subs({a1: 0, b1: 4 * f_D / sp.pi}),
            4 * f_D * A * sp.cos(late),
        ),
        POSITIVE_SHARE,
        NotNegative(
            "so b_1 >= 0 of Dahl",
            DAHL_FRICTION,
            4 * DAHL_LEVEL / sp.pi * FRICTIONLIKE / u,
            {FRICTIONLIKE: u - sp.tanh(u)},
        ),
        NotNegative(
            "Dahl: I_1 >= 0, its integrand paired at t and pi - t",
            sp.exp(u * c) * c - sp.exp(-u * c) * c,
            2 * c * sp.sinh(u * c),
        ),
        NotNegative(
            "late less prompt work is not positive for 0 <= omega tau <= pi",
            LATE_FRICTION.subs(tau, 0) - LATE_FRICTION,
            sp.pi * A * (2 * FRICTIONLIKE * sp.sin(late / 2) ** 2 + SPRINGLIKE * TURN),
            {FRICTIONLIKE: b1, SPRINGLIKE: a1, TURN: sp.sin(late)},
        ),
        Equal(
            "a_1 is the spring part of Dahl",
            DAHL_SPRING * sp.cosh(u),
            2 * DAHL_LEVEL * sp.besseli(1, u),
        ),
        assuming=[b1, a1, sp.sin(late)],
    )


@shows(48, BERNSTEIN, "text on delay")
def late_inertia() -> ProofSteps:
    """Cancellation of inertia with any delay releases energy. A late friction compensator within
    the level of ideal Coulomb friction releases none, so limit cycles have another source.

    formula: cancelled inertia gives out pi mhat A^2 omega^2 sin(omega tau) > 0 for omega tau < pi
    printed: motion-based cancellation suffers from delay, seen as limit cycles at reversal
    """
    work = work_over_cycle(mass * -A * omega**2 * sp.sin(angle - late))
    less = sp.Symbol("less", nonnegative=True)
    coulomb_work = LATE_FRICTION.subs({a1: 0, b1: 4 * f_D / sp.pi})
    return proof(
        Equal("work of mhat x''(t - tau)", work, sp.pi * mass * A**2 * omega**2 * sp.sin(late)),
        Limit("positive in slow motion: sin(x)/x -> 1", sp.sin(u) / u, u, sp.S(0), sp.S(1)),
        NotNegative(
            "late Coulomb compensator: friction takes 4 f_C A, it gives 4 f_D A cos(omega tau)",
            4 * f_C * A - coulomb_work,
            4 * A * (less + 2 * f_D * sp.sin(late / 2) ** 2),
            {less: f_C - f_D},
        ),
        assuming=[f_C - f_D],
    )


def least_damping() -> Numbers:
    """The constant in the condition on the smallest damper, -min sin(x)/x."""
    x = float(brentq(lambda x: np.sin(x) - x * np.cos(x), np.pi, 1.5 * np.pi))
    # half a last digit
    return numbers_of(figure_near("-min sin(x)/x", -np.sin(x) / x, 0.2172, 5e-5))


@shows(49, DERIVED, "small motion on a presliding plant", numbers=least_damping)
def late_stiffness() -> ProofSteps:
    """Damping that a late Dahl compensator needs in small motion, where the compensator is a
    negative spring.

    formula: Re Z >= 0 iff B >= kappa sigma_D tau, kappa = -min sin(x)/x = -cos x*, tan x* = x*,
        0.2172; and sigma_D <= sigma_p
    """
    s = sp.Symbol("s")
    sigma_p, sigma_D, B, x, v = sp.symbols("sigma_p sigma_D B x v", positive=True)
    z = B + (sigma_p - sigma_D * sp.exp(-s * tau)) / s  # force per velocity
    at_omega = z.subs(s, sp.I * omega)
    slope = sp.sin(x) - x * sp.cos(x)  # x^2 times the slope of -sin(x)/x
    seventeen = 17 * sp.pi / 12
    return proof(
        Equal("near rest Dahl is a spring", dahl_rate(sp.S(0), v, f_D, sigma_D), sigma_D * v),
        Equal(
            "real part at j omega",
            (at_omega + sp.conjugate(at_omega)) / 2,
            B + sigma_D * tau * sp.sin(late) / late,
        ),
        Equal(
            "pole at 0: its residue must not be negative",
            sp.expand(z * s).subs(s, 0),
            sigma_p - sigma_D,
        ),
        Equal("slope of -sin(x)/x", sp.diff(-sp.sin(x) / x, x), slope / x**2),
        Equal(
            "its numerator has the slope x sin x: up to pi, down to 2 pi",
            sp.diff(slope, x),
            x * sp.sin(x),
        ),
        Holds("from 0 at 0", slope.subs(x, 0), "==", 0),
        Holds("over pi at pi", slope.subs(x, sp.pi), ">", 0),
        Holds(
            "to -1 at 3 pi/2: one zero x* between, where -sin x*/x* = -cos x*",
            slope.subs(x, 3 * sp.pi / 2),
            "<",
            0,
        ),
        Equal("the value there", (-sp.sin(x) / x - -sp.cos(x)).subs(sp.sin(x), x * sp.cos(x)), 0),
        Equal(
            "it is above the value at 17 pi/12",
            (-sp.sin(x) / x).subs(x, seventeen),
            3 * (sp.sqrt(6) + sp.sqrt(2)) / (17 * sp.pi),
        ),
        Holds(
            "which is above 2/(3 pi), and no later abs(sin x)/x exceeds that",
            81 * (sp.sqrt(6) + sp.sqrt(2)) ** 2,
            ">",
            34**2,
        ),
    )
