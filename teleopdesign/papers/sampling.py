"""Sampled forces on damped masses: P50 to P52 and P60.

A force that is held over a sample of length T does the work force * travel; a damper b takes at
least b travel^2/T. No theorem of others is used.
"""

from __future__ import annotations

import numpy as np
import sympy as sp

from ..passivity import passivity_controlled
from ._laws import dahl_rate
from ._proof import Equal, Limit, NotNegative, ProofStep, ProofSteps, proof
from ._statement import DERIVED, Figure, Numbers, Paper, figure_near, shows

COLGATE = Paper(
    "Colgate 1997",
    "J. E. Colgate, G. Schenkel, Passivity of a class of sampled-data systems, J. Robotic "
    "Systems 14 (1997) 37",
)
ABBOTT = Paper(
    "Abbott 2005",
    "J. J. Abbott, A. M. Okamura, Effects of position quantization and sampling rate on "
    "virtual-wall passivity, "
    "IEEE Trans. Robotics 21 (2005) 952",
)
HANNAFORD = Paper(
    "Hannaford 2002",
    "B. Hannaford, J.-H. Ryu, Time-domain passivity control of haptic interfaces, IEEE Trans. "
    "Robotics "
    "Autom. 18 (2002) 1",
)

T, K, B, b, sigma, r = sp.symbols("T K B b sigma_D r", positive=True)
theta, D, x = sp.symbols("theta D x", real=True)
c = sp.cos(theta)
UNIT = c + sp.I * sp.sin(theta)  # e^(j theta), theta = omega T
BACK = c - sp.I * sp.sin(theta)


def damper_takes_most() -> list[ProofStep]:
    """A damper takes at least b D^2/T over a sample: b times the integral of v^2 is not less."""
    squares = sp.Symbol("squares", positive=True)  # integral of v^2
    return [
        Equal(
            "integral of (v - D/T)^2 over a sample: that of v^2 less D^2/T, 0 at constant speed",
            squares - 2 * D / T * D + (D / T) ** 2 * T,
            squares - D**2 / T,
        )
    ]


def least_damping(block: sp.Expr) -> sp.Expr:
    """Damping that a held force -H x needs at the angle theta: T/2/(1 - cos) Re[(1 - 1/z) H]."""
    return T / 2 / (1 - c) * sp.re(sp.expand((1 - BACK) * block))


def late_springs(inside: sp.Symbol) -> list[ProofStep]:
    """Damping for a Dahl compensator near rest, prompt and late;  inside: 1 + cos(theta)."""
    v = sp.Symbol("v", positive=True)
    one, two = -sigma * BACK, -sigma * BACK**2
    return [
        Equal("Dahl near rest is a spring", dahl_rate(sp.S(0), v, r, sigma), sigma * v),
        Equal("cancelled: no damping needed", least_damping(-sigma), -sigma * T / 2),
        Equal("one sample late", least_damping(one), -sigma * T / 2 * (1 + 2 * c)),
        NotNegative(
            "at most sigma_D T/2, at theta = pi",
            sigma * T / 2 - least_damping(one),
            sigma * T * inside,
            {inside: 1 + c},
        ),
        Equal("two samples late", least_damping(two), -sigma * T / 2 * (4 * c**2 + 2 * c - 1)),
        NotNegative(
            "at most (5/8) sigma_D T, at cos = -1/4",
            sp.Rational(5, 8) * sigma * T - least_damping(two),
            sigma * T / 2 * (2 * c + sp.Rational(1, 2)) ** 2,
        ),
    ]


@shows(50, COLGATE, "passivity condition")
def held_blocks() -> ProofSteps:
    """Damping with which no steady oscillation at any frequency takes energy out of a sampled block
    with zero-order hold. A Dahl compensator near rest, a negative spring beside a stiffer spring,
    needs no damping; a delay of its computer needs damping.

    formula: b >= T/(2 (1 - cos wT)) Re[(1 - e^(-jwT)) H] and b >= 0;  enough at every w: K: b >= K
        T/2;  K + B: b >= K T/2 + abs(B);  -sigma_D: any b >= 0, one sample late b >= sigma_D T/2,
        two: b >= (5/8) sigma_D T;  -B: b >= B
    assumes: that steady oscillations are the worst motions (the theorem of Colgate and Schenkel),
        for blocks whose pole at z = 1, if any, a spring of the body covers
    """
    jump = UNIT - 1
    h, g = sp.symbols("h_re h_im", real=True)
    block = h + sp.I * g
    spring, damper = K, B * (1 - BACK) / T
    inside = sp.Symbol("inside", nonnegative=True)  # 1 + cos
    short = sp.Symbol("short", nonnegative=True)  # 1 - cos
    return proof(
        damper_takes_most(),
        Equal(
            "motion e^(j k theta): work given out a sample by the force -H x",
            sp.re(sp.expand(-block * sp.conjugate(jump))),
            sp.re(sp.expand((1 - BACK) * block)),
        ),
        Equal(
            "taken by the damper: 2 (1 - cos) b/T; angles do not mix (Parseval)",
            sp.expand(jump * sp.conjugate(jump)),
            2 * (1 - c),
        ),
        Equal("spring", least_damping(spring), K * T / 2),
        Equal(
            "spring with damper from differences", least_damping(spring + damper), K * T / 2 - B * c
        ),
        NotNegative(
            "at most K T/2 + abs(B), reached at theta = pi",
            B - (least_damping(damper)),
            B * inside,
            {inside: 1 + c},
        ),
        NotNegative(
            "negative damper: at most B, reached at theta -> 0",
            B - least_damping(-damper),
            B * short,
            {short: 1 - c},
        ),
        late_springs(inside),
        assuming=[1 + c, 1 - c],
    )


@shows(51, ABBOTT, "main result")
def encoder_steps() -> ProofSteps:
    """A sampled spring on an encoder of step Delta, with Coulomb friction and damping: full
    friction compensation leaves no margin for quantisation.

    formula: passive iff K <= min(2 b/T, 2 f_c/Delta); with friction compensation K <= 2 (f_C -
        f_D)/Delta
    """
    f_c, step, a = sp.symbols("f_c Delta a", positive=True)
    q = sp.Symbol("q", real=True)
    off = sp.Symbol("off", nonnegative=True)
    slow, dry, inside = sp.symbols("slow dry inside", nonnegative=True)
    signs = {slow: b / T - K / 2, dry: f_c - K * step / 2, inside: step / 2 - off}
    steps: list[ProofStep] = []
    for way in (1, -1):
        for side in (1, -1):
            travel, error = way * r, side * off
            stored = K * ((x + travel) ** 2 - x**2) / 2
            force = -K * (x - error)
            left = b * travel**2 / T + f_c * r - force * travel - stored
            spare = inside if way * side > 0 else step / 2 + off
            steps.append(
                NotNegative(
                    f"losses cover work and storage: travel {way:+d}, reading error {side:+d}",
                    left,
                    slow * r**2 + r * (dry + K * spare),
                    signs,
                )
            )
    # to and fro over an edge between the readings q and q + Delta, two samples
    edge = -K * q * r + K * (q + step) * r - 2 * f_c * r - 2 * b * r**2 / T
    # between -a and a, multiples of Delta
    wide = -K * -a * 2 * a - K * a * -2 * a - 2 * (b * (2 * a) ** 2 / T + f_c * 2 * a)
    return proof(
        damper_takes_most(),
        steps,
        Limit(
            "necessary: small swings over an edge give out",
            edge / r,
            r,
            sp.S(0),
            K * step - 2 * f_c,
        ),
        Limit("necessary: wide swings give out", wide / a**2, a, sp.oo, 4 * K - 8 * b / T),
        assuming=list(signs.values()),
    )


def controlled_port() -> Numbers:
    """The package's observer and controller over forces that give out energy: 4000 samples.

    A force of 1.2 N acts along the motion against 1 N of friction, to and fro at uneven speed.
    """
    rng, period, friction, helps = np.random.default_rng(52), 1e-3, 1.0, 1.2
    speed = rng.uniform(0.01, 0.2, 4000) * np.sign(np.sin(np.arange(4000) / 50 + 0.1))
    way = np.sign(speed)
    port = passivity_controlled(speed, (friction - helps) * way, period=period)
    turned = period * float(np.abs(speed).sum()) * (helps - friction)
    bounded = passivity_controlled(speed, (friction - helps) * way, period=period, largest=0.5)
    friction_power = friction * np.abs(speed)
    figures = [
        Figure("least energy over that turned over", port.energy.min() / turned, low=-1e-12),
        figure_near("and in the end, the deficit is made up", port.energy[-1] / turned, 0.0, 1e-12),
        Figure("damping that it adds at most", float(port.damping.max()), low=0.1, unit="N s/m"),
        Figure("with a damper of 0.5 N s/m it is not", bounded.energy[-1] / turned, high=-0.1),
    ]
    for counted in (0.8, 1.1):
        budget = (counted - helps) * way
        held = passivity_controlled(speed, budget, period=period)
        # what the device really takes, and the force that is left of the help
        help_left = counted * way - held.force
        true = period * float((friction_power - help_left * speed).sum()) / turned
        what = f"energy that {counted:g} N counted leaves in the port, true friction 1 N"
        figures.append(
            Figure(what, true, low=0) if counted < friction else Figure(what, true, high=0)
        )
    return Numbers(tuple(figures))


@shows(52, HANNAFORD, "passivity observer and controller", numbers=controlled_port)
def observer() -> ProofSteps:
    """At a sample with v != 0 a damper recovers a deficit of the sampled energy exactly. With
    friction counted below its level the budget is on the safe side, with friction counted above its
    level it is not.

    formula: E[n] = E[n-1] + T sum f_i v_i; where E < 0 add a damper alpha = -E/(T v^2)
    """
    energy, v = sp.symbols("E v", real=True, nonzero=True)
    deficit, w, counted = sp.symbols("deficit w f_counted", positive=True)
    f_C, spare = sp.Symbol("f_C", positive=True), sp.Symbol("spare", nonnegative=True)
    alpha = -energy / (T * v**2)
    return proof(
        Equal("the deficit is made up", energy + T * (alpha * v) * v, 0),
        NotNegative(
            "by a true damper", alpha.subs(energy, -deficit), deficit / (T * v**2), strictly=True
        ),
        NotNegative(
            "friction counted below its level: the budget is on the safe side",
            f_C * w - counted * w,
            spare * w,
            {spare: f_C - counted},
        ),
        NotNegative(
            "counted above by spare: the budget misses energy that was never taken",
            (counted * w - f_C * w).subs(counted, f_C + deficit),
            deficit * w,
            strictly=True,
        ),
        assuming=[f_C - counted],
    )


@shows(60, DERIVED, "sampled coupling of Mahvash 2006, eq (10)")
def sampled_coupling() -> ProofSteps:
    """Position-position coupling with forces held over a sample: the damping of both sides counts
    as in parallel.

    formula: passive iff b_m b_s/(b_m + b_s) >= P T/2
    """
    P, b_m, b_s, a = sp.symbols("P b_m b_s a", positive=True)
    d_m, d_s, e = sp.symbols("D_m D_s e", real=True)
    parallel = b_m * b_s / (b_m + b_s)
    spare = sp.Symbol("spare", nonnegative=True)
    losses = (b_m * d_m**2 + b_s * d_s**2) / T
    stored = P * ((e + d_m - d_s) ** 2 - e**2) / 2
    released = -P * e * d_m + P * e * d_s
    swing = d_m - d_s
    # e = -a, a, -a ..., split so that b_m D_m = -b_s D_s: the damper losses are least
    split = {d_m: 2 * a * b_s / (b_m + b_s), d_s: -2 * a * b_m / (b_m + b_s)}
    cycle = 2 * (released.subs(e, -a) - losses).subs(split)
    return proof(
        damper_takes_most(),
        Equal(
            "two dampers take the parallel one's share and a square",
            losses - parallel * swing**2 / T,
            (b_m * d_m + b_s * d_s) ** 2 / ((b_m + b_s) * T),
        ),
        NotNegative(
            "losses cover work and storage",
            losses - released - stored,
            spare * swing**2 / T + (b_m * d_m + b_s * d_s) ** 2 / ((b_m + b_s) * T),
            {spare: parallel - P * T / 2},
        ),
        Equal(
            "necessary: a swing at half the sampling rate gives out",
            cycle,
            8 * a**2 / T * (P * T / 2 - parallel),
        ),
        assuming=[parallel - P * T / 2],
    )
