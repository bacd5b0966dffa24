"""Quadratic storage functions from the inequality of Kalman, Yakubovich and Popov (KYP).

    Z = m s + C (s I - A)^-1 B + D:    V = (m v^2 + x^T P x)/2,   P >= 0,   m >= 0,
    [[-A^T P - P A, C^T - P B], [C - B^T P, 2 D]] >= 0

Semidefinite programming (extra `lmi`) solves the inequality. The solution is rounded to fractions.
If the inequality still holds, exactly, the storage function is a proof. The realisation is the
controllable canonical form, and time is scaled by a power of two so that the poles lie around 1.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from fractions import Fraction
from importlib import import_module
from typing import Any

import numpy as np
import sympy as sp

from ...base.errors import ModelError
from ...base.frozen import ByValue
from ...derive.polynomials import fraction
from ..claims.certificate import Term, storage_certificate
from ..claims.claim import Claim, Proof, Unknown
from .impedance import Impedance, MotionKind, impedance
from .unseen import explain_unseen, unseen_modes

FractionRows = list[list[Fraction]]
#: a double pole on the axis makes the inequality infeasible, but by so little that the solver does
#: not say so. A shortage of damping of this many times the size of Z counts as infeasible
_LARGEST_SHORTAGE = 1e4


@dataclass(frozen=True)
class Realisation:
    """State-space realisation m, A, B, C, D of an impedance in exact numbers.

    Time is scaled by `scale` (1/s). B is not stored: it is the last unit vector.
    """

    mass: Fraction
    a: FractionRows
    c: list[Fraction]
    d: Fraction
    scale: Fraction

    @property
    def order(self) -> int:
        """Number of states."""
        return len(self.a)


@dataclass(frozen=True, eq=False)
class Kyp(ByValue):
    """Numerical solution of the KYP inequality for Z - c with the largest c.

    damping_excess: this largest c, N s/m; -inf where the inequality has a solution for no c
    p: P of the scaled realisation, (n, n); None where there is no solution
    status: of the solver, or "improper" or "infeasible"
    """

    damping_excess: float
    p: np.ndarray | None
    status: str


def realisation(z: Impedance) -> Realisation | None:
    """Controllable canonical form of an impedance; None where Z grows faster than s, or as -s."""
    quotient, rest = z.p.div(z.q)
    if quotient.degree() > 1:
        return None
    rising = [fraction(x) for x in quotient.all_coeffs()[::-1]]
    mass = rising[1] if len(rising) > 1 else Fraction(0)
    if mass < 0:
        return None
    n = z.q.degree()
    scale = _scale(z.q)
    q = [fraction(x) * scale**-k for k, x in enumerate(z.q.all_coeffs())]  # of s/scale, monic
    top = [fraction(x) for x in rest.all_coeffs()[::-1]] + [Fraction(0)] * n
    c = [top[k] * scale ** (k - n) for k in range(n)]
    shift = [[Fraction(j == i + 1) for j in range(n)] for i in range(n - 1)]
    a = [*shift, [-x for x in q[1:][::-1]]] if n else []
    return Realisation(mass, a, c, rising[0] if rising else Fraction(0), scale)


def _scale(q: sp.Poly) -> Fraction:
    """Power of two near the geometric mean of the poles that are not at 0."""
    rising = [fraction(x) for x in q.all_coeffs()[::-1]]
    first = next(k for k, x in enumerate(rising) if x)
    degree = len(rising) - 1 - first
    if degree == 0:
        return Fraction(1)
    size = float(np.log2(float(abs(rising[first] / rising[-1])))) / degree
    return Fraction(2) ** round(size)


def kyp(system: Any, *, motion: MotionKind = "velocity") -> Kyp:
    """Largest c for which Z - c has a quadratic storage function, by the KYP inequality; numerical.

    system, motion: see `impedance`
    raises ModelError: cvxpy (extra `lmi`) is not installed, or no impedance
    """
    made = realisation(impedance(system, motion=motion))
    if made is None:
        return Kyp(float("-inf"), None, "improper")
    if made.order == 0:
        return Kyp(float(made.d), np.zeros((0, 0)), "optimal")
    size = max(abs(float(x)) for x in [*made.c, made.d]) or 1.0
    solved = _solve(made, size, slack=False)
    if solved is None or solved[0] < -_LARGEST_SHORTAGE:
        return Kyp(float("-inf"), None, "infeasible")
    value, p, status = solved
    return Kyp(value * size, p * size, status)


def _solve(made: Realisation, size: float, *, slack: bool) -> tuple[float, np.ndarray, str] | None:
    """Solve the inequality: (value, P, status of the solver); None where the solver fails.

    size: of Z, by which C and D are divided
    slack: False: value is the largest c; True: value is the largest margin of the inequality at
        c = 0
    """
    try:
        cp: Any = import_module("cvxpy")
    except ModuleNotFoundError as missing:
        raise ModelError("kyp: needs cvxpy: pip install 'teleopdesign[lmi]'") from missing
    n = made.order
    a = np.array([[float(x) for x in row] for row in made.a])
    c = np.array([[float(x) for x in made.c]]) / size
    b, d = np.eye(n)[:, -1:], float(made.d) / size
    p, value = cp.Variable((n, n), symmetric=True), cp.Variable()
    off = c.T - p @ b
    corner = np.array([[2 * d]]) if slack else cp.reshape(2 * (d - value), (1, 1), order="C")
    block = cp.bmat([[-a.T @ p - p @ a, off], [off.T, corner]])
    if slack and made.d == 0:  # then P B = C^T, and what is left is the first block
        limits = [off == 0, (-a.T @ p - p @ a) >> value * np.eye(n), p >> value * np.eye(n)]
    elif slack:
        limits = [block >> value * np.eye(n + 1), p >> value * np.eye(n)]
    else:
        limits = [block >> 0, p >> 0]
    problem = cp.Problem(cp.Maximize(value), [*limits, value <= 1e3])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that a solution is inaccurate is in its status
        try:
            problem.solve(solver=cp.CLARABEL)
        except cp.error.SolverError:
            return None
    if p.value is None or not np.isfinite(value.value):
        return None
    return float(value.value), np.asarray(p.value), str(problem.status)


def storage_function(system: Any, *, motion: MotionKind = "velocity") -> Claim:
    """Is this impedance passive: a proof by a quadratic storage function in exact numbers.

    system, motion: see `impedance`
    returns: proved, with V in the certificate; or unknown, where no rounding of the numerical
        solution satisfies the inequality exactly (`positive_real` decides this case, too, without a
        storage function), or where a mode that the port does not show does not decay
    raises ModelError: cvxpy (extra `lmi`) is not installed, or no impedance
    """
    z = impedance(system, motion=motion)
    statement = f"Z(s) = {z} is passive at its port (force, velocity)"
    made = realisation(z)
    if made is None:
        return Claim(statement, Unknown("grows faster than s, or as -s: no storage function"))
    if modes := unseen_modes(system):
        return Claim(statement, Unknown(explain_unseen(modes)))
    for p in _candidates(made):
        storage, loss = _matrices(made, p)
        squares = sum_of_squares(storage), sum_of_squares(loss)
        if squares[0] is not None and squares[1] is not None:
            return Claim(statement, _proof(statement, made, storage, squares[0], squares[1]))
    return Claim(statement, Unknown("no rounding of the solution of the inequality is valid"))


def _candidates(made: Realisation) -> list[FractionRows]:
    """Matrices P rounded to fractions, the coarsest first; where D = 0 the last column is C."""
    n = made.order
    if n == 0:
        return [[]]
    size = max(abs(float(x)) for x in [*made.c, made.d]) or 1.0
    matrices = []
    for slack in (True, False):
        solved = _solve(made, size, slack=slack)
        if solved is None:
            continue
        for digits in (1, 2, 3, 4, 6, 9, 12):
            upper = np.triu(solved[1] * size)
            p = [
                [_round_fraction(upper[min(i, j), max(i, j)], digits) for j in range(n)]
                for i in range(n)
            ]
            if made.d == 0:
                for k, x in enumerate(made.c):
                    p[k][-1] = p[-1][k] = x
            matrices.append(p)
    return matrices


def _round_fraction(x: float, digits: int) -> Fraction:
    return Fraction(float(x)).limit_denominator(10**digits)


def _matrices(made: Realisation, p: FractionRows) -> tuple[FractionRows, FractionRows]:
    """P, and the matrix of the KYP inequality: a quadratic form in (x, v), twice the lost power."""
    n = made.order
    pa = [[sum((p[i][k] * made.a[k][j] for k in range(n)), Fraction(0)) for j in range(n)]
          for i in range(n)]  # fmt: skip
    loss = [[-pa[i][j] - pa[j][i] for j in range(n)] for i in range(n)]
    edge = [made.c[i] - p[i][-1] for i in range(n)]
    return p, [*([*loss[i], edge[i]] for i in range(n)), [*edge, 2 * made.d]]


def _proof(
    statement: str,
    made: Realisation,
    storage: FractionRows,
    stored: list[tuple[Fraction, list[Fraction]]],
    lost: list[tuple[Fraction, list[Fraction]]],
) -> Proof:
    """The proof with its certificate, in unscaled time: x' = scale (A x + B v).

    stored, lost: sums of squares of P and of the matrix of the inequality
    """
    n = made.order
    x = [sp.Symbol(f"x{k}", real=True) for k in range(n)]
    v, acceleration = sp.symbols("v acceleration", real=True)
    scale, mass = _rational(made.scale), _rational(made.mass)
    rates = {f"x{i}": scale * (_dot(made.a[i], x) + (v if i == n - 1 else 0)) for i in range(n)} | {
        "v": acceleration
    }
    force = _dot(made.c, x) + _rational(made.d) * v + mass * acceleration
    energy = sum((x[i] * _dot(storage[i], x) for i in range(n)), sp.S(0)) / (2 * scale)
    half = sp.Rational(1, 2)
    kept: list[Term] = [(_rational(w) / (2 * scale), {}, _dot(e, x)) for w, e in stored]
    supply: list[Term] = [(_rational(w) * half, {}, _dot(e, [*x, v])) for w, e in lost]
    certificate = storage_certificate(
        statement,
        supply=sp.expand(force * v),
        storage=sp.expand(energy + mass * v**2 / 2),
        rates=rates,
        proofs={"supply": {"": supply}, "storage": {"": [*kept, (mass * half, {}, v)]}},
        example={},
    )
    return Proof("a quadratic storage function, exact", (certificate,))


def _rational(x: Fraction) -> sp.Rational:
    return sp.Rational(x.numerator, x.denominator)


def _dot(row: list[Fraction], x: list[sp.Symbol]) -> sp.Expr:
    return sum((_rational(r) * e for r, e in zip(row, x, strict=True)), sp.S(0))


def sum_of_squares(
    matrix: list[list[Fraction]],
) -> list[tuple[Fraction, list[Fraction]]] | None:
    """A quadratic form x^T M x as a sum of weight * (form . x)^2, in exact numbers.

    matrix: M, symmetric, (n, n)
    returns: (weight > 0, coefficients of the linear form, (n,)) for each square; None where M is
        not positive semidefinite
    """
    m = [list(row) for row in matrix]
    n = len(m)
    squares = []
    for k in range(n):
        pivot = m[k][k]
        if pivot < 0 or (pivot == 0 and any(m[k][j] for j in range(n))):
            return None
        if pivot == 0:
            continue
        form = [x / pivot for x in m[k]]
        squares.append((pivot, form))
        for i in range(n):
            factor = m[i][k]
            if factor:
                m[i] = [x - factor * f for x, f in zip(m[i], form, strict=True)]
    return squares
