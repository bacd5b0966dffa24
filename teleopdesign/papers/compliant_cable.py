"""Motor and link with a friction contact each, joined by a compliant cable: P53 to P58 less P56.

m_1 a_1 = u + f_dahl - f_1 sgn v_1 - coupling        motor: measured and compensated
m_2 a_2 = coupling - f_2 sgn v_2 + f_env             link
"""

from __future__ import annotations

from types import SimpleNamespace

import sympy as sp

from ..effects import EFFECTS
from ._laws import coulomb
from ._proof import Equal, Grows, Limit, NotNegative, ProofStep, ProofSteps, proof
from ._statement import DERIVED, MAHVASH, claim, shows
from .dahl_loop import POSITIVE_SHARE, SHARE, loop_energy, rising_share

f_D, sigma, f_1, f_2, k, c, A, u = sp.symbols("f_D sigma_D f_1 f_2 k c A u", positive=True)
U = sigma * A / f_D
W = 4 * f_D * (A - f_D / sigma * sp.tanh(U))  # of a cycle; shown to be the loop's in `rising_gain`
CLAMPED = W - 4 * f_1 * A  # released a cycle, link stuck: the cable returns what it takes
FREE = CLAMPED - 4 * f_2 * (A - f_2 / k)  # link sliding, A > f_2/k


def coupling(x: tuple[sp.Expr, sp.Expr], v: tuple[sp.Expr, sp.Expr]) -> sp.Expr:
    """Force of the effect `transmission_compliance` between motor and tip."""
    between = EFFECTS["transmission_compliance"].coupling
    assert between is not None
    stretch = SimpleNamespace(stretch=x[0] - x[1], stretch_rate=v[0] - v[1])
    return sp.sympify(between(stretch, SimpleNamespace(stiffness=k, damping=c)))


@shows(53, DERIVED, "extension announced in Mahvash 2006")
def motor_side() -> ProofSteps:
    """Compensation of at most the friction of the measured contact keeps the two-body joint passive
    for any environment.

    formula: f_D <= f_1 is enough, whatever k, f_2, masses and environment
    """
    x1, x2, force = sp.symbols("x_1 x_2 f_dahl", real=True)
    push, env, w1, w2 = sp.symbols("u f_env w_1 w_2", positive=True)
    size, spare, inside = sp.symbols("size spare inside", nonnegative=True)
    steps: list[ProofStep] = []
    for one in (1, -1):
        for two in (1, -1):
            v = (one * w1, two * w2)
            joint = coupling((x1, x2), v)
            pushed = push + force - coulomb(v[0], f_1) - joint  # m_1 a_1
            pulled = joint - coulomb(v[1], f_2) + env  # m_2 a_2
            stored = pushed * v[0] + pulled * v[1] + k * (x1 - x2) * (v[0] - v[1])
            lost = f_1 * w1 + f_2 * w2 + c * (v[0] - v[1]) ** 2 - force * v[0]
            steps.append(
                Equal(
                    f"supply less rate of kinetic and cable energy, v_1 {one:+d}, v_2 {two:+d}",
                    push * v[0] + env * v[1] - stored,
                    lost,
                )
            )
    for way in (1, -1):
        steps.append(
            NotNegative(
                f"f_1 abs(v_1) covers the compensator, direction {way:+d}",
                f_1 * w1 - way * size * w1,
                w1 * (spare + inside + size * (1 - way)),
                {spare: f_1 - f_D, inside: f_D - size},
            )
        )
    return proof(steps, assuming=[f_1 - f_D, f_D - size])


def rising_gain() -> list[ProofStep]:
    """The compensator's energy per travel, f_D (1 - tanh(u)/u), rises with u and tends to f_D."""
    return [
        Equal("energy of a cycle, from the loop", loop_energy(f_D, sigma, A), W),
        Equal("per travel", W.subs(A, u * f_D / sigma) / (u * f_D / sigma), 4 * f_D * SHARE),
        *rising_share(),
    ]


@shows(54, DERIVED, "extends P53")
def clamped_link() -> ProofSteps:
    """Necessary condition where the environment may clamp the link. For a limited stroke the
    condition is that of plain cycles, see P56.

    formula: clamped link: unlimited stroke needs f_D <= f_1; a stroke between -A and A at least f_D
        (1 - tanh(u)/u) <= f_1, u = sigma_D A/f_D
    """
    released = CLAMPED.subs(A, u * f_D / sigma)
    return proof(
        rising_gain(),
        Equal(
            "given out a cycle of stroke A, cable energy returns",
            released,
            4 * (u * f_D / sigma) * (f_D * SHARE - f_1),
        ),
    )


@shows(55, DERIVED, "extends P53")
def free_link() -> ProofSteps:
    """Free link held by its own friction only, with plain quasi-static cycles of the motor of any
    amplitude: the stiffness of the cable limits the stiffness of the compensator. For other motions
    see P56.

    formula: no plain slow cycle between -A and A gives energy out, whatever A, iff f_D <= f_1 + f_2
        and f_D (1 - tanh(u_2)/u_2) <= f_1, u_2 = sigma_D f_2/(k f_D); for these enough: sigma_D <=
        k sqrt(3 f_1 f_D)/f_2
    """
    spare, more, soft, over = sp.symbols("spare more soft over", nonnegative=True)
    bound = k * sp.sqrt(3 * f_1 * f_D) / f_2
    u_2 = sigma * f_2 / (k * f_D)
    return proof(
        rising_gain(),
        Equal(
            "a stroke of 2 A stretches the cable by 2 f_2/k, then drags the link: two a cycle",
            CLAMPED - 2 * f_2 * (2 * A - 2 * f_2 / k),
            FREE,
        ),
        Equal("sliding joins stuck at A = f_2/k", FREE.subs(A, f_2 / k), CLAMPED.subs(A, f_2 / k)),
        Equal("there u is u_2", U.subs(A, f_2 / k), u_2),
        NotNegative(
            "beyond it the energy given out falls: its slope is 4 (f_D tanh^2 u - f_1 - f_2)",
            -sp.diff(FREE, A) / 4,
            spare + f_D / sp.cosh(U) ** 2,
            {spare: f_1 + f_2 - f_D},
        ),
        Limit(
            "necessary: large cycles give out 4 A (f_D - f_1 - f_2), units with f_D = sigma_D = 2",
            FREE.subs({f_D: 2, sigma: 2}) / A,
            A,
            sp.oo,
            4 * (2 - f_1 - f_2),
        ),
        POSITIVE_SHARE,
        Grows(
            "1 - tanh(u)/u <= u^2/3, times u",
            u**3 / 3 - u + sp.tanh(u),
            u,
            more * (u + sp.tanh(u)),
            {more: u - sp.tanh(u)},
        ),
        Equal("at the bound f_D u_2^2/3 = f_1", f_D * u_2.subs(sigma, bound) ** 2 / 3, f_1),
        NotNegative(
            "and below it less",
            f_1 - f_D * u_2**2 / 3,
            f_2**2 / (3 * f_D * k**2) * soft * (bound + sigma),
            {soft: bound - sigma},
        ),
        assuming=[f_1 + f_2 - f_D, bound - sigma],
    )


@shows(57, DERIVED, "consequence of P54, P55")
def relieving_the_far_contact() -> ProofSteps:
    """Over-compensation of the motor's contact relieves the far contact. Plain slow cycles then
    release no energy only if the compensator is soft and the environment does not clamp the link.
    Other motions may still release energy, see P56.

    formula: f_1 < f_D <= f_1 + f_2: P55 holds with sigma_D = k sqrt(3 f_1 f_D)/f_2 and fails for
        sigma_D large enough; a clamped link breaks it at any sigma_D
    """
    excess = sp.Symbol("excess", positive=True)
    soft = k * sp.sqrt(3 * f_1 * f_D) / f_2
    per_travel = (CLAMPED / A).subs({sigma: 1, f_D: 1, f_1: 1 - excess})
    return proof(
        NotNegative("a compensator that P55 allows exists", soft, soft, strictly=True),
        Equal("its u_2", f_D * (soft * f_2 / (k * f_D)) ** 2 / 3, f_1),
        Limit(
            "stiffer without end, f_D (1 - tanh(u_2)/u_2) tends to f_D, which is above f_1",
            SHARE,
            u,
            sp.oo,
            sp.S(1),
        ),
        Limit(
            "clamped, f_D = f_1 + excess: long strokes give out 4 A excess",
            per_travel,
            A,
            sp.oo,
            4 * excess,
        ),
    )


journal_version = claim(
    58,
    MAHVASH,
    "later version: IEEE Trans. Robotics 23 (2007) 1240",
    "Passivity conditions for a feedforward Dahl compensator with a compliant "
    "transmission. The exact inequalities of that paper could not be read, and P53 to P57 are not "
    "those of that paper.",
    (53, 54, 55),
)
