"""Describing functions relative to position x = A sin(omega t): P16 to P19.

N = (phasor of the first harmonic of the force that opposes motion)/A; a spring is real, a damper
has the phase of +j. Forces are odd in the motion, so that half a cycle with velocity upwards is
enough: phase -pi/2 to pi/2.
"""

from __future__ import annotations

import sympy as sp

from ..effects import EFFECTS
from ..frequency import closed_forms
from ._laws import coulomb, dahl_loop, smoothed_coulomb
from ._proof import Correction, Equal, Holds, Limit, NotNegative, ProofSteps, proof
from ._statement import BERNSTEIN, DERIVED, shows

phi, theta = sp.symbols("phi theta", real=True)
v, A, V, a, F_C, f, sigma, u, r = sp.symbols("v A V a F_C f_D sigma_D u r", positive=True)
QUARTER = sp.pi / 2
#: first harmonic of Dahl friction of level f at u = sigma A/f: with position, with velocity
DAHL_SPRING = closed_forms.dahl_spring(f, u)
DAHL_FRICTION = closed_forms.dahl_friction(f, u)


def first_harmonic(force: sp.Expr) -> sp.Expr:
    """Part of a force, odd in the motion, that is in phase with velocity.

    force: an expression in the symbol `phi` of this file
    """
    return 2 / sp.pi * sp.integrate(force * sp.cos(phi), (phi, -QUARTER, QUARTER))


@shows(16, BERNSTEIN, "eq (9)", how="refuted")
def coulomb_friction() -> Correction:
    """Coulomb friction acts on a sinusoid as j 4 F_C/(pi A), at any frequency.

    formula: N = j 4 F_C/(pi A)
    printed: 4 j F_C/A: pi is missing
    """
    force = coulomb(v, F_C)
    spring = sp.integrate(force * sp.sin(phi), (phi, -QUARTER, QUARTER))
    return Correction(
        proof(Holds("the first harmonic of sgn is 4/pi, not 4", first_harmonic(1), "!=", 4)),
        proof(
            Equal(
                "in phase with velocity",
                sp.I * first_harmonic(force) / A,
                closed_forms.coulomb(F_C, A),
            ),
            Equal("no spring part", spring, 0),
        ),
    )


@shows(17, DERIVED, "from eq (6) of Bernstein 2005")
def smoothed_friction() -> ProofSteps:
    """Describing function of smoothed Coulomb friction.

    formula: N = j F_1/A,  F_1 = (4 F_C/pi)(1 - pi r/2 + r^2 J),  r = a/V;  J = arcosh(1/r)/sqrt(1 -
        r^2) for r < 1, 1 for r = 1, arccos(1/r)/sqrt(r^2 - 1) for r > 1
    """
    c, t = sp.symbols("c t", positive=True)
    force = smoothed_coulomb(v, F_C, a).subs({v: V * sp.cos(phi), a: r * V})
    parts = F_C * (sp.cos(phi) - r + r**2 / (r + sp.cos(phi)))
    # J: integral of 1/(r + cos phi) over 0 .. pi/2, with t = tan(phi/2) from 0 to 1
    cosine = (1 - t**2) / (1 + t**2)
    slope = 2 / (1 + t**2) / (r + cosine)
    below, above = (1 - c**2) / (1 + c**2), (1 + c**2) / (1 - c**2)  # r < 1 and r > 1, 0 < c < 1
    root = 2 * c / (1 + c**2), 2 * c / (1 - c**2)
    j_below, j_at, j_above = closed_forms.reciprocals(r)
    x = sp.Symbol("x", positive=True)  # 1/r = V/a
    inner = 4 / sp.pi * closed_forms.smoothed_share(r, j_above)
    series = sp.series(inner.subs(r, 1 / x), x, 0, 3).removeO()
    return proof(
        Equal("the force times cos phi, taken apart", force * sp.cos(phi), parts),
        Equal(
            "the first two parts give (4 F_C/pi)(1 - pi r/2)",
            2 / sp.pi * sp.integrate(F_C * (sp.cos(phi) - r), (phi, -QUARTER, QUARTER)),
            4 * F_C / sp.pi * closed_forms.smoothed_share(r, 0),
        ),
        Equal("r < 1: r^2 J, root of 1 - r^2", root[0] ** 2, 1 - below**2),
        Equal(
            "antiderivative of J, r < 1",
            sp.diff(2 / root[0] * sp.atanh(c * t), t),
            slope.subs(r, below),
        ),
        Equal(
            "its end 2 artanh c is arcosh(1/r)", sp.expand_trig(sp.cosh(2 * sp.atanh(c))), 1 / below
        ),
        Equal("r = 1: J = 1", sp.integrate(sp.simplify(slope.subs(r, 1)), (t, 0, 1)), j_at),
        Equal("r > 1: root of r^2 - 1", root[1] ** 2, above**2 - 1),
        Equal(
            "antiderivative of J, r > 1",
            sp.diff(2 / root[1] * sp.atan(c * t), t),
            slope.subs(r, above),
        ),
        Equal(
            "its end 2 arctan c is arccos(1/r)", sp.expand_trig(sp.cos(2 * sp.atan(c))), 1 / above
        ),
        Limit("r -> 0: Coulomb, since r^2 J -> 0", r**2 * j_below, r, sp.S(0), sp.S(0)),
        Equal("large r: (F_C V/a)(1 - 8 V/(3 pi a))", series, x - 8 * x**2 / (3 * sp.pi)),
    )


@shows(18, DERIVED, "from eq (9) of Mahvash 2006")
def dahl_friction() -> ProofSteps:
    """Describing function of Dahl friction: a spring in small motion, Coulomb friction in large
    motion, with a spring part that decays only as 1/sqrt(u).

    formula: N = [2 f I_1(u)/cosh u + j (4 f/pi)(1 - tanh(u)/u)]/A,  u = sigma A/f
    assumes: pi I_1(u) = integral of e^(u cos t) cos t over 0..pi (DLMF 10.32.3)
    """
    s = sp.Symbol("s", real=True)
    rising = dahl_loop(s * A, A, f, sigma).subs(sigma, u * f / A)  # at x = A sin phi, s = sin phi
    shape = f * (1 - sp.exp(-u * s) / sp.cosh(u))
    real, imaginary = DAHL_SPRING, DAHL_FRICTION
    bessel = sp.exp(u * sp.cos(theta)) * sp.cos(theta)  # its integral is pi I_1(u)
    turned = (shape * s).subs(s, -sp.cos(theta))  # phi = theta - pi/2
    return proof(
        Equal("rising branch, from the law", rising, shape),
        Equal(
            "part in phase with velocity, ds = cos phi dphi",
            2 / sp.pi * sp.integrate(shape, (s, -1, 1)),
            imaginary,
        ),
        Equal(
            "spring part: integrand over theta is I_1's, and a cosine that integrates to 0",
            turned,
            f * bessel / sp.cosh(u) - f * sp.cos(theta),
        ),
        Equal("that cosine", sp.integrate(sp.cos(theta), (theta, 0, sp.pi)), 0),
        Limit("small u: spring sigma = u f/A", real / (u * f), u, sp.S(0), sp.S(1)),
        Limit("small u: no damping beside it", imaginary / (u * f), u, sp.S(0), sp.S(0)),
        Limit("large u: Coulomb", imaginary / f, u, sp.oo, 4 / sp.pi),
        Limit(
            "large u: spring part times sqrt(u)",
            sp.sqrt(u) * real / f,
            u,
            sp.oo,
            2 * sp.sqrt(2) / sp.sqrt(sp.pi),
        ),
    )


@shows(19, BERNSTEIN, "figure 7")
def slope_over_frequency() -> ProofSteps:
    """Coulomb friction on a sweep of falling amplitude. At constant velocity amplitude it is
    indistinguishable from a damper.

    formula: A ~ f^-p: abs(N) rises by 20 p dB/decade, 16 for p = 0.8; p = 1: N = j omega B, B = 4
        F_C/(pi V)
    printed: 16 dB/decade and f^-0.8, with digits lost
    """
    freq, p, c, omega, B = sp.symbols("freq p c omega B", positive=True)
    size = first_harmonic(coulomb(v, F_C)) / (c * freq**-p)
    slope = freq * sp.diff(sp.log(size), freq)  # d log N/d log f: 20 dB a decade each
    damper = sp.sympify(EFFECTS["viscous"].linear_form(sp.I * omega, {"damping": B}))
    same = sp.I * first_harmonic(coulomb(v, F_C)) / (V / omega)
    return proof(
        Equal("slope on the profile A = c f^-p", 20 * slope, 20 * p),
        Equal("p = 4/5", (20 * slope).subs(p, sp.Rational(4, 5)), 16),
        Equal(
            "p = 1, velocity amplitude V: the impedance of a damper",
            same,
            damper.subs(B, 4 * F_C / (sp.pi * V)),
        ),
        NotNegative("a real damping", 4 * F_C / (sp.pi * V), 4 * F_C / (sp.pi * V), strictly=True),
    )
