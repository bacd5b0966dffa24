"""Coupling of master and slave with several axes or with a delay: P59 and P61.

Couplings of several axes along closed paths, by quadrature: numbers for statement P59.
"""

from __future__ import annotations

import numpy as np
import sympy as sp

from ._proof import Equal, Grows, Limit, NotNegative, ProofStep, ProofSteps, proof
from ._statement import MAHVASH, Figure, Numbers, Paper, figure_near, numbers_of, shows


def turned_about(coordinates: np.ndarray) -> np.ndarray:
    """Matrix E (3, 3) of angular velocity = E rates, for body angles about x, then y, then z."""
    a, b, _ = coordinates
    x, y, z = np.eye(3)
    about_x = np.array([x, [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    about_y = np.array([[np.cos(b), 0, np.sin(b)], y, [-np.sin(b), 0, np.cos(b)]])
    return np.column_stack([x, about_x @ y, about_x @ about_y @ z])


def closed_paths() -> Numbers:
    """Energy (J) that couplings give out along closed paths, in six axes and for orientations."""
    rng, n = np.random.default_rng(59), 2000
    root = rng.normal(size=(6, 6))
    spring, skew = root @ root.T, 0.3 * (root - root.T)
    plane = np.linalg.qr(rng.normal(size=(6, 2)))[0]
    angle = 2 * np.pi * np.arange(n) / n
    circle = 0.7 * plane @ np.array([np.cos(angle), np.sin(angle)])
    rate = 0.7 * plane @ np.array([-np.sin(angle), np.cos(angle)]) * 2 * np.pi

    def released(matrix: np.ndarray) -> float:
        return float(-np.einsum("it,it->", matrix @ circle, rate) / n)

    inner = plane.T @ skew @ plane
    expected = -np.pi * 0.7**2 * (inner[1, 0] - inner[0, 1])
    size = float(np.abs(spring).max())
    # a circle in two of three angles, half a radian wide: the coupling 2 N m/rad about each
    turning = np.array([0.5 * np.cos(angle), 0.5 * np.sin(angle), 0.5 * np.cos(2 * angle)])
    rates = np.array([-np.sin(angle), np.cos(angle), -2 * np.sin(2 * angle)]) * np.pi
    plain, mapped = 0.0, 0.0
    for e, change in zip(turning.T, rates.T, strict=True):
        to_velocity = turned_about(e)
        velocity = to_velocity @ change
        plain -= float(2.0 * e @ velocity) / n
        mapped -= float(np.linalg.solve(to_velocity.T, 2.0 * e) @ velocity) / n
    return numbers_of(
        figure_near("symmetric 6 x 6 over its size, one turn", released(spring) / size, 0, 1e-12),
        figure_near("its skew part, against the formula", released(skew), expected, 1e-9, "J"),
        figure_near("angles, torques by J^T", mapped, 0.0, 1e-12, "J"),
        Figure("angles, torques as they are: size", abs(plain), low=0.01, unit="J"),
    )


LLEWELLYN = Paper(
    "Llewellyn 1952",
    "F. B. Llewellyn, Some fundamental properties of transmission systems, Proc. IRE 40 (1952) 271",
)

P, T, omega, r = sp.symbols("P T_d omega r", positive=True)
k_11, k_22 = sp.symbols("k_11 k_22", positive=True)
crossed = sp.Symbol("k_12_k_21", nonnegative=True)


@shows(59, MAHVASH, "eq (10)", numbers=closed_paths)
def coupling_stiffness() -> ProofSteps:
    """Condition for a multi-axis coupling to be an ideal spring, and the permitted coordinates of
    orientation.

    formula: storage e^T P e/2 iff P is symmetric and positive semidefinite; a skew part gives out
        pi r^2 (p_21 - p_12) a turn; tau = J^T P e needs e' = J q'
    printed: F_m = -F_s = P (X_m - X_s) repels as a force ON the master: there it is -P (X_m - X_s)
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
    """Real part and residues of z_in = z_11 - L/n, with L = z_12 z_21 and n = z_22 + Z_2.

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
    """Residues at s = 0, which are those of a spring, and the behaviour of z_12 at infinity.

    At s = 0 the condition on residues holds with equality; at infinity nothing grows like s between
    the ports.

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


@shows(61, LLEWELLYN, "applied to the coupling of Mahvash 2006")
def delayed_coupling() -> ProofSteps:
    """Absolute stability of the linear two-port of masses, dampers and a coupling spring; not a
    statement about friction.

    formula: spring coupling: always; one-way delay T_d: iff b_m b_s >= (P T_d)^2
    assumes: absolutely stable iff z_11, z_22 are positive real; z_12, z_21 have no pole in the open
        right half plane, and simple ones on the axis; on it 2 Re z_11 Re z_22 >= abs(z_12 z_21) +
        Re(z_12 z_21); and at its poles, infinity included, the residues have 2 k_11 k_22 >=
        abs(k_12 k_21) + Re(k_12 k_21). Of that theorem the two inequalities are proved here, the
        minimum principle for positive-real functions is quoted. The axis alone, as Llewellyn's
        criterion is often cited, does not do: z_11 = z_22 = 1, z_12 = z_21 = 1/s
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
