"""Loops, energy and relatives of the Dahl model: P33 to P36."""

from __future__ import annotations

import sympy as sp

from ._laws import bristle_force, bristle_rate, dahl_loop, dahl_rate, dahl_step, stribeck_level
from ._proof import Equal, Grows, Limit, NotNegative, ProofStep, ProofSteps, proof
from ._statement import DERIVED, MAHVASH, shows

f, x, z = sp.symbols("f x z", real=True)
f_c, sigma, A, u, w, d = sp.symbols("f_c sigma A u w d", positive=True)
SCALED = {A: u * f_c / sigma}  # u = A/lambda
PEAK = f_c * sp.tanh(sigma * A / f_c)
RISING = dahl_loop(x, A, f_c, sigma)
ENERGY = 2 * sp.integrate(RISING, (x, -A, A))  # the falling half is the point mirror
SHARE = 1 - sp.tanh(u) / u  # of 4 f_c A that a cycle dissipates
BEND = sp.tanh(u) - u / sp.cosh(u) ** 2
BENDS = Grows("u/cosh^2 u <= tanh u", BEND, u, 2 * u * sp.tanh(u) / sp.cosh(u) ** 2)
POSITIVE_SHARE = Grows("u >= tanh u", u - sp.tanh(u), u, sp.tanh(u) ** 2)


def loop_energy(level: sp.Expr, stiffness: sp.Expr, amplitude: sp.Expr = A) -> sp.Expr:
    """Energy that a steady cycle dissipates, for other symbols or values."""
    values = {f_c: level, sigma: stiffness, A: amplitude}
    return ENERGY.subs(values, simultaneous=True)


def rising_share() -> list[ProofStep]:
    """The energy per travel, level (1 - tanh(u)/u), rises with u and tends to the level."""
    rest = sp.Symbol("rest", nonnegative=True)
    return [
        BENDS,
        NotNegative("energy per travel rises", sp.diff(SHARE, u), rest / u**2, {rest: BEND}),
        Limit("to the level", SHARE, u, sp.oo, sp.S(1)),
    ]


@shows(33, DERIVED, "from eq (9) of Mahvash 2006")
def steady_loop() -> ProofSteps:
    """Steady loop of amplitude A. Any start converges to this loop, wherever its centre is. So Dahl
    friction forgets offsets and drifts under small biased oscillation.

    formula: rising: f_c (1 - exp(-x/lambda)/cosh u), falling: its point mirror; peak f_c tanh u
    """
    shape = f_c * (1 - sp.exp(-sigma * x / f_c) / sp.cosh(sigma * A / f_c))
    end = dahl_step(f, 2 * A, 1, f_c, sigma)
    back = dahl_step(end, 2 * A, -1, f_c, sigma)
    swung = dahl_step(dahl_step(f, d, 1, f_c, sigma), d, -1, f_c, sigma)
    kept = sp.exp(-4 * sigma * A / f_c)
    return proof(
        Equal("rising branch", RISING, shape),
        Equal("its peak", RISING.subs(x, A), PEAK),
        Equal("it starts at minus the peak: the mirror closes the loop", RISING.subs(x, -A), -PEAK),
        Equal("after a cycle the distance to it has shrunk by", sp.diff(back, f), kept),
        Grows("which is below 1", 1 - kept, A, 4 * sigma / f_c * kept),
        Equal(
            "small swings about a force f pull it towards 0 by 2 sigma d f/f_c each: drift",
            sp.diff(swung, d).subs(d, 0),
            -2 * sigma * f / f_c,
        ),
    )


@shows(34, DERIVED, "from eq (9) of Mahvash 2006")
def energy_per_cycle() -> ProofSteps:
    """Energy that a steady cycle dissipates: proportional to the cube of a small amplitude, 4 f_c
    (A - lambda) for a large amplitude.

    formula: W(A) = 4 f_c A (1 - tanh(u)/u)
    """
    scaled = ENERGY.subs(SCALED) * sigma / f_c**2  # in units of f_c lambda
    form = 4 * f_c * A * (1 - f_c / (sigma * A) * sp.tanh(sigma * A / f_c))
    return proof(
        Equal("integral of the force over the loop", ENERGY, form),
        Limit("small u: (4/3) sigma^2 A^3/f_c", scaled / u**3, u, sp.S(0), sp.Rational(4, 3)),
        Limit("large u: 4 f_c (A - lambda)", scaled - 4 * (u - 1), u, sp.oo, sp.S(0)),
        POSITIVE_SHARE,
    )


@shows(35, DERIVED, "from eq (2) of Mahvash 2006")
def power() -> ProofSteps:
    """Dahl friction is passive: storage f^2/(2 sigma), dissipation abs(v) f^2/f_c.

    formula: f v = d/dt (f^2/(2 sigma)) + (abs(v)/f_c) f^2
    """
    velocity = sp.Symbol("v", real=True)
    stored = sp.diff(f**2 / (2 * sigma), f) * dahl_rate(f, velocity, f_c, sigma)
    lost = sp.Abs(velocity) * f**2 / f_c
    return proof(
        Equal("power, by the law", f * velocity, stored + lost),
        NotNegative("the dissipation", lost, lost),
        NotNegative("the storage", f**2 / (2 * sigma), f**2 / (2 * sigma)),
    )


@shows(36, MAHVASH, "eq (2); LuGre and Hayward-Armstrong models")
def relatives() -> ProofSteps:
    """Hayward-Armstrong friction with constant alpha, and LuGre with constant level and no damping,
    are Dahl friction. alpha = 0 near rest removes the drift.

    formula: z' = v - alpha abs(v) z, f = sigma z is Dahl for alpha = 1/lambda; LuGre with constant
        level, sigma_1 = sigma_2 = 0 too
    """
    alpha, damping, extra, scale = sp.symbols("alpha sigma_1 F_SC v_S", positive=True)
    velocity = sp.Symbol("v", real=True)
    hayward_armstrong_rate = velocity - alpha * sp.Abs(velocity) * z
    level = stribeck_level(velocity, f_c, extra, scale)
    rate = bristle_rate(z, velocity, level, sigma)
    force = bristle_force(z, velocity, level, sigma, damping)
    return proof(
        Equal(
            "Hayward-Armstrong, alpha = sigma/f_c",
            sigma * hayward_armstrong_rate.subs(alpha, sigma / f_c),
            dahl_rate(sigma * z, velocity, f_c, sigma),
        ),
        Equal("LuGre's force", force, sigma * z + damping * rate),
        Equal(
            "LuGre without extra level: Dahl's rate",
            sigma * rate.subs(extra, 0),
            dahl_rate(sigma * z, velocity, f_c, sigma),
        ),
        Equal("and without damping Dahl's force", force.subs(damping, 0), sigma * z),
        Equal(
            "alpha = 0: the bristle moves with the body, nothing drifts",
            hayward_armstrong_rate.subs(alpha, 0),
            velocity,
        ),
    )
