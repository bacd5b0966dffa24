"""Position-position teleoperator: P59 and P61 to P65."""

from __future__ import annotations

import numpy as np
import sympy as sp

from ..simulate import Loop, Simulation, loop_of
from ._closed_paths import closed_paths
from ._laws import coulomb
from ._proof import Equal, Grows, Limit, NotNegative, ProofStep, ProofSteps, proof
from ._statement import MAHVASH, Numbers, Paper, claim, figure_near, shows
from ._two_sides import AMPLITUDE, FREQUENCY, FRICTION, SLAVE_DAMPING, STIFFNESS, slow_cycle

LLEWELLYN = Paper(
    "Llewellyn 1952",
    "F. B. Llewellyn, Some fundamental properties of transmission systems, Proc. IRE 40 (1952) 271",
)
CANCELLED = (0.0, 0.5, 0.9)  # of the slave's friction
ENVIRONMENT = 0.15 * STIFFNESS  # k_e, N/m

P, T, omega, r, w = sp.symbols("P T_d omega r w", positive=True)
x_m, x_s = sp.symbols("x_m x_s", real=True)
k_11, k_22 = sp.symbols("k_11 k_22", positive=True)
crossed = sp.Symbol("k_12_k_21", nonnegative=True)


@shows(
    59,
    paper=MAHVASH,
    place="eq (10)",
    formula="storage e^T P e/2 iff P is symmetric and positive semidefinite; a skew part gives out "
    "pi r^2 (p_21 - p_12) a turn; tau = J^T P e needs e' = J q'",
    printed="F_m = -F_s = P (X_m - X_s) repels as a force ON the master: there it is -P (X_m - "
    "X_s)",
    numbers=closed_paths,
)
def coupling_stiffness() -> ProofSteps:
    """When a multi-axis coupling is an ideal spring, and which coordinates of orientation may be
    used.
    """
    p = sp.Matrix(2, 2, sp.symbols("p_11 p_12 p_21 p_22", real=True))
    angle = sp.Symbol("angle", real=True)
    e = r * sp.Matrix([sp.cos(angle), sp.sin(angle)])
    turn = sp.integrate(sp.expand(-(p * e).dot(sp.diff(e, angle))), (angle, 0, 2 * sp.pi))
    e1, e2, v1, v2, a, b, c = sp.symbols("e_1 e_2 v_1 v_2 a b c", real=True)
    off, rate = sp.Matrix([e1, e2]), sp.Matrix([v1, v2])
    symmetric = p.subs(p[1, 0], p[0, 1])
    stored = (off.T * symmetric * off)[0] / 2
    change = sp.diff(stored, e1) * v1 + sp.diff(stored, e2) * v2
    root = sp.Matrix([[a, b], [0, c]])  # every positive semidefinite P is root^T root
    mu, far = sp.symbols("mu far", positive=True)
    jacobian = sp.Matrix(2, 2, sp.symbols("j_11 j_12 j_21 j_22", real=True))
    torque = jacobian.T * symmetric * off
    return proof(
        Equal("given out on a circle, one turn", turn, -sp.pi * r**2 * (p[1, 0] - p[0, 1])),
        Equal(
            "the other turn gives the opposite: none only if symmetric",
            turn.subs(p[1, 0], p[0, 1]),
            0,
        ),
        Equal(
            "symmetric: power taken is the rate of e^T P e/2", (symmetric * off).dot(rate), change
        ),
        NotNegative(
            "positive semidefinite: bounded below",
            (off.T * root.T * root * off)[0],
            (a * e1 + b * e2) ** 2 + (c * e2) ** 2,
        ),
        Limit(
            "an eigenvalue -mu: energy without bound", -mu * far**2 / 2 / far, far, sp.oo, -sp.oo
        ),
        Equal(
            "torques J^T P e do the power of the spring if e' = J q'",
            torque.dot(rate),
            (symmetric * off).dot(jacobian * rate),
        ),
    )


def why_the_criterion_suffices() -> tuple[ProofStep, ...]:
    """z_in = z_11 - L/n, L = z_12 z_21, n = z_22 + Z_2: its real part and its residues.

    L = size e^(2 j half), n = rho (1 + j tau) on the axis, rho >= Re z_22 > 0
    """
    size, more, enough = sp.symbols("size more enough", nonnegative=True)
    half, tau = sp.symbols("half tau", real=True)
    rho, x = sp.symbols("rho x", positive=True)
    real_part = size * (sp.cos(2 * half) + tau * sp.sin(2 * half)) / (rho * (1 + tau**2))
    largest = size * (1 + sp.cos(2 * half)) / (2 * rho)
    form = size * (tau * sp.cos(half) - sp.sin(half)) ** 2 / (rho * (1 + tau**2))
    grown = sp.Matrix([[1, 1 / x], [1 / x, 1]]).det()
    return (
        NotNegative(
            "Re(L/n) <= (abs L + Re L)/(2 rho), whatever holds port 2", largest - real_part, form
        ),
        NotNegative(
            "at a pole where n has the residue k_22 + more, z_in has one >= 0",
            k_11 - crossed / (k_22 + more),
            (enough + k_11 * more) / (k_22 + more),
            {enough: k_11 * k_22 - crossed},
        ),
        Equal("z_11 = z_22 = 1, z_12 = z_21 = 1/s: singular at s = 1", grown.subs(x, 1), 0),
    )


def residues_of_the_coupling(z_11: sp.Expr, z_12: sp.Expr) -> tuple[ProofStep, ...]:
    """At s = 0 those of a spring, equality; at infinity the masses, and nothing between the ports.

    z_11, z_12: on the axis, s = j omega;  z_22 is z_11 with the slave's mass and damping
    """
    s = sp.I * omega
    return (
        Limit("residue of z_11 at 0, that of z_22 alike", s * z_11, omega, sp.S(0), P),
        Limit("residue of z_12 = z_21 at 0", s * z_12, omega, sp.S(0), -P),
        Equal("so k_11 k_22 = k_12 k_21 there", P * P - (-P) ** 2, 0),
        Equal("abs(z_12/s)^2", z_12 * sp.conjugate(z_12) / omega**2, P**2 / omega**4),
        Limit("nothing grows like s between the ports", P**2 / omega**4, omega, sp.oo, sp.S(0)),
    )


@shows(
    61,
    paper=LLEWELLYN,
    place="applied to the coupling of Mahvash 2006",
    formula="spring coupling: always; one-way delay T_d: iff b_m b_s >= (P T_d)^2",
    assumes="absolutely stable iff z_11, z_22 are positive real; z_12, z_21 have no pole in the "
    "open right half plane, and simple ones on the axis; on it 2 Re z_11 Re z_22 >= abs(z_12 z_21) "
    "+ Re(z_12 z_21); and at its poles, infinity included, the residues have 2 k_11 k_22 >= "
    "abs(k_12 k_21) + Re(k_12 k_21). Of that theorem the two inequalities are proved here, the "
    "minimum principle for positive-real functions is quoted. The axis alone, as Llewellyn's "
    "criterion is often cited, does not do: z_11 = z_22 = 1, z_12 = z_21 = 1/s",
)
def delayed_coupling() -> ProofSteps:
    """Absolute stability of the linear two-port of masses, dampers and a coupling spring; not a
    statement about friction.
    """
    b_m, b_s, m_m = sp.symbols("b_m b_s m_m", positive=True)
    late = sp.exp(-sp.I * omega * T)
    s = sp.I * omega
    z_11 = m_m * s + b_m + P / s
    z_12 = z_21 = -P * late / s  # the other side's position arrives late
    product = sp.expand(z_12 * z_21)
    size = sp.sqrt(sp.simplify(product * sp.conjugate(product)))
    right = size + (product + sp.conjugate(product)) / 2
    angle = omega * T
    gap = P**2 * T**2 - P**2 * sp.sin(angle) ** 2 / omega**2
    y = sp.Symbol("y", positive=True)
    return proof(
        *why_the_criterion_suffices(),
        *residues_of_the_coupling(z_11, z_12),
        Equal("real part of z_11", (z_11 + sp.conjugate(z_11)) / 2, b_m),
        Equal("abs(z_12 z_21) + Re", right, 2 * P**2 * sp.sin(angle) ** 2 / omega**2),
        Limit("without delay it is 0: always", right, T, sp.S(0), sp.S(0)),
        Grows("y - sin y >= 0", y - sp.sin(y), y, 2 * sp.sin(y / 2) ** 2),
        Grows("y + sin y >= 0", y + sp.sin(y), y, 2 * sp.cos(y / 2) ** 2),
        Equal(
            "2 (P T_d)^2 less it is (P/omega)^2 (y - sin y)(y + sin y), y = omega T_d",
            gap,
            P**2 / omega**2 * (angle - sp.sin(angle)) * (angle + sp.sin(angle)),
        ),
        Limit("the bound is reached in slow motion", sp.sin(y) / y, y, sp.S(0), sp.S(1)),
        assuming=(k_11 * k_22 - crossed,),
    )


def mid_stroke(simulation: Simulation, name: str) -> Loop:
    """A signal over the master's position, both ways, at mid-stroke."""
    middle = (-0.2 * AMPLITUDE, 0.2 * AMPLITUDE)
    return loop_of(simulation["X_m"].values, simulation[name].values, within=middle)


def free_space_force() -> Numbers:
    """User force at mid-stroke and position error, simulated in free space."""
    viscous = SLAVE_DAMPING * 2 * np.pi * FREQUENCY * AMPLITUDE
    figures = []
    for share in CANCELLED:
        simulation = slow_cycle(cancelled=share * FRICTION)
        felt, left = mid_stroke(simulation, "F_u").width / 2, (1 - share) * FRICTION
        # the damper, and a hundredth of the friction: inertia, settling of the bristles
        within = viscous + 0.01 * FRICTION
        figures.append(figure_near(f"user force, f_D = {share} f_C", felt, left, within, "N"))
        slack = 1e3 * mid_stroke(simulation, "X_e").width / 2
        expected = 1e3 * left / STIFFNESS
        figures.append(
            figure_near("  position error", slack, expected, 1e3 * within / STIFFNESS, "mm")
        )
    return Numbers(tuple(figures))


@shows(
    62,
    paper=MAHVASH,
    place="figure 6",
    formula="user force (f_Cm + f_Cs - f_Dm - f_Ds) sgn v; position error (f_Cs - f_Ds)/P",
    numbers=free_space_force,
)
def free_space() -> ProofSteps:
    """What the user feels in slow free motion, both sides sliding, and how far the slave lags."""
    f_Cm, f_Cs, f_Dm, f_Ds = sp.symbols("f_Cm f_Cs f_Dm f_Ds", positive=True)
    user = sp.Symbol("F_u", real=True)
    steps: list[ProofStep] = []
    for way in (1, -1):
        slave = P * (x_m - x_s) + way * f_Ds - coulomb(way * w, f_Cs)
        (lag,) = sp.solve(slave, x_m)
        master = user - P * (x_m - x_s) + way * f_Dm - coulomb(way * w, f_Cm)
        (felt,) = sp.solve(master.subs(x_m, lag), user)
        steps += [
            Equal(f"position error, direction {way:+d}", lag - x_s, way * (f_Cs - f_Ds) / P),
            Equal("user force", felt, way * (f_Cm + f_Cs - f_Dm - f_Ds)),
        ]
    return proof(steps)


def contact(share: float) -> tuple[float, float, float]:
    """Stiffness felt (N/m), hysteresis width (N), rms difference from the environment (N)."""
    simulation = slow_cycle(cancelled=share * FRICTION, environment=ENVIRONMENT)
    loop = mid_stroke(simulation, "F_u")
    whole = simulation["F_u"].values - ENVIRONMENT * simulation["X_m"].values
    return loop.stiffness, loop.width, float(np.sqrt(np.mean(whole**2)))


def contact_force() -> Numbers:
    """Stiffness and hysteresis that the user feels, simulated in contact."""
    ratio = ENVIRONMENT / STIFFNESS
    viscous = 2 * SLAVE_DAMPING * 2 * np.pi * FREQUENCY * AMPLITUDE
    figures = []
    for share in CANCELLED:
        stiffness, width, _ = contact(share)
        expected = 2 * (1 - share) * FRICTION / (1 + ratio)
        # the damper widens the loop; a hundredth of the friction for what is not yet steady
        figures.append(
            figure_near(
                f"hysteresis width, f_D = {share} f_C", width, expected, viscous + 0.02, "N"
            )
        )
        series = STIFFNESS * ENVIRONMENT / (STIFFNESS + ENVIRONMENT)
        figures.append(figure_near("  stiffness felt", stiffness, series, 0.01 * series, "N/m"))
    return Numbers(tuple(figures))


@shows(
    63,
    paper=MAHVASH,
    place="figure 7",
    formula="P k_e/(P + k_e), hysteresis width 2 (f_Cs - f_Ds)/(1 + k_e/P)",
    numbers=contact_force,
)
def soft_contact() -> ProofSteps:
    """What the user feels of a contact of stiffness k_e: the coupling spring in series is itself a
    transparency error.
    """
    k_e, f_Cs, f_Ds = sp.symbols("k_e f_Cs f_Ds", positive=True)
    felt = []
    for way in (1, -1):
        slave = P * (x_m - x_s) - k_e * x_s + way * f_Ds - coulomb(way * w, f_Cs)
        (slave_position,) = sp.solve(slave, x_s)
        felt.append(sp.expand(P * (x_m - slave_position)))
    return proof(
        Equal("stiffness, either way", sp.diff(felt[0], x_m), P * k_e / (P + k_e)),
        Equal("the same falling", sp.diff(felt[1], x_m), P * k_e / (P + k_e)),
        Equal("width of the loop", felt[0] - felt[1], 2 * (f_Cs - f_Ds) / (1 + k_e / P)),
    )


@shows(
    64,
    paper=MAHVASH,
    place="figures 6, 7",
    how="checked numerically",
    formula="stiffness ratio, hysteresis width/f_C, rms force difference/f_C over a slow cycle",
    printed='"transparency plot", without a number to it',
)
def transparency_figures() -> Numbers:
    """Force against displacement at the user's hand, laid over the environment's own: three
    numbers that say how close they are.
    """
    ratio = ENVIRONMENT / STIFFNESS
    figures = []
    for share in CANCELLED:
        stiffness, width, difference = contact(share)
        name = f"f_D = {share} f_C"
        # a twentieth of a newton of friction: damping of the slave, settling of bristles
        figures += [
            figure_near(f"{name}: stiffness ratio", stiffness / ENVIRONMENT, 1 / (1 + ratio), 0.01),
            figure_near(
                "  hysteresis width", width / FRICTION, 2 * (1 - share) / (1 + ratio), 0.05, "f_C"
            ),
            figure_near(
                "  rms difference",
                difference / FRICTION,
                quasi_static_difference(share),
                0.02,
                "f_C",
            ),
        ]
    return Numbers(tuple(figures))


def quasi_static_difference(share: float) -> float:
    """Rms of user force less environment's own over a cycle, by the balance at the slave alone.

    The slave stays where it is while abs(P x_m - (P + k_e) x_s) is below the friction left.
    """
    left = (1 - share) * FRICTION
    total = STIFFNESS + ENVIRONMENT
    position, forces = 0.0, []
    master = AMPLITUDE * np.sin(2 * np.pi * np.arange(2000) / 1000)
    for x in master:
        low, high = (STIFFNESS * x - left) / total, (STIFFNESS * x + left) / total
        position = min(max(position, low), high)
        forces.append(STIFFNESS * (x - position) - ENVIRONMENT * x)
    return float(np.sqrt(np.mean(np.square(forces[1000:]))))


bench = claim(
    65,
    paper=MAHVASH,
    place="experiment",
    words="Force sensor at the slave's tip only to check; user force from the master's motor "
    "current, so without the "
    "master's friction and inertia; all forces over f_c, which comes from the force-velocity "
    "curve of smooth motion; "
    "sigma_D is the largest that does not oscillate.",
    see=(43, 46, 62),
)
