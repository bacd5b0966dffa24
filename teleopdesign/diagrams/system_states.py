"""States of systems of python-control, exactly: of plants, and of matrices of transfer functions.

A plant with all its states is masses, dampers, springs and the states beside them:

    x' = A x + B u,   y = C x        M y'' + D y' + K y + F z = u,   z' = G z + H y

The states x are y, y' and others, on which u does not act at once. Less a share of y, these are z:
no state is lost, also none that no force reaches or that no position shows.

If each entry of a matrix had separate states, each would have a copy of a mode that several entries
share. A second copy of a mode that decays or stays constant does no harm. Of a mode that grows, no
loop can stabilise more than one copy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp
from sympy.polys.matrices import DomainMatrix as _Matrix

from ..base.errors import ModelError
from ..controllers import exact_decimal

if TYPE_CHECKING:
    import control

_S = sp.Symbol("s")
#: share of its size by which a pole may lie on the right of the axis by rounding alone
_ROUNDING = 1e-9


@dataclass(frozen=True)
class PlantStates:
    """Matrices of a plant with n axes and its further states; floats, rounded from exact numbers.

    mass, damping, stiffness: M, D, K (n, n);  rest: G, H and F, of the m further states
    """

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    rest: tuple[np.ndarray, np.ndarray, np.ndarray]


def states_of_plant(system: control.LTI, name: str) -> PlantStates | None:
    """The plant with its states, if it has more of them than its transfer functions show.

    returns: None where they show all of them
    raises ModelError: a mode that they do not show is on the axis, in numbers that are no decimals,
        or does not decay in a matrix of transfer functions, which does not say what drives it
    """
    from ..base.python_control import TransferFunction

    if isinstance(system, TransferFunction) and system.ninputs > 1:
        _refuse_cancelled(system, name)
        return None
    a, b, c = _exact_matrices(system)
    shown = _drop_unreached(*_drop_unreached(a, b, c))
    if shown[0].shape == a.shape:
        return None
    (mass, damping, stiffness, *rest), are_exact = _as_floats(*_split(a, b, c))
    if not are_exact:
        whole, part = (sp.Poly(m.charpoly(), _S, domain="QQ") for m in (a, shown[0]))
        modes = _roots(whole.quo(part))
        on_axis = modes[modes.real <= _ROUNDING * np.abs(modes)]  # where rounding would decide
        _refuse(name, on_axis, "in numbers that no state space of decimals has")
    return PlantStates(mass, damping, stiffness, (rest[0], rest[1], rest[2]))


def _as_floats(*matrices: _Matrix) -> tuple[list[np.ndarray], bool]:
    """The matrices in floats, and whether these, read as decimals, are the same numbers."""
    made = [np.array(m.to_Matrix().tolist(), dtype=float).reshape(m.shape) for m in matrices]
    pairs = zip(made, matrices, strict=True)
    return made, all(
        exact_decimal(x) == e
        for m, exact in pairs
        for x, e in zip(m.ravel(), exact.to_Matrix(), strict=True)
    )


def _drop_unreached(a: _Matrix, b: _Matrix, c: _Matrix) -> tuple[_Matrix, _Matrix, _Matrix]:
    """The dual of the system without the states that no input reaches: A', C' and B' of the rest.

    Applied twice, the system without states that no input reaches or that no output shows.
    """
    reached = b.columnspace()
    while (further := reached.hstack(a * reached).columnspace()).shape != reached.shape:
        reached = further
    projected = (reached.transpose() * reached).inv() * reached.transpose()
    inner = projected * a * reached
    return inner.transpose(), (c * reached).transpose(), (projected * b).transpose()


def _exact_matrices(system: control.LTI) -> tuple[_Matrix, _Matrix, _Matrix]:
    """A, B, C in exact numbers; of a transfer function in its controllable form."""
    from ..base.python_control import StateSpace

    if isinstance(system, StateSpace):
        plain = (system.A, system.B, system.C)
        matrices = ([[exact_decimal(x) for x in row] for row in m] for m in plain)
        a, b, c = (_exact(rows, (len(rows), len(rows[0]))) for rows in matrices)
        return a, b, c
    above, below = (
        [exact_decimal(x) for x in np.trim_zeros(side[0][0], "f")]
        for side in (system.num, system.den)
    )
    n = len(below) - 1
    a = [[sp.S(int(j == i + 1)) for j in range(n)] for i in range(n - 1)]
    a.append([-x / below[0] for x in below[:0:-1]])
    b = [[sp.S(int(i == n - 1))] for i in range(n)]
    c = [*(x / below[0] for x in reversed(above)), *[sp.S(0)] * (n - len(above))]
    return _exact(a, (n, n)), _exact(b, (n, 1)), _exact([c], (1, n))


def _exact(rows: Sequence[Sequence[sp.Rational]], shape: tuple[int, int]) -> _Matrix:
    return _Matrix([[sp.QQ(int(x.p), int(x.q)) for x in row] for row in rows], shape, sp.QQ)


def _split(a: _Matrix, b: _Matrix, c: _Matrix) -> tuple[_Matrix, ...]:
    """M, D, K, G, H and F of the plant."""
    n, size = a.shape[0], c.shape[0]
    moved = c * a
    mass = (moved * b).inv()
    others = _complete(c, b)
    back = c.vstack(moved, others).inv()
    x, v, z = (
        back.extract(list(range(n)), list(columns))
        for columns in (range(size), range(size, 2 * size), range(2 * size, n))
    )
    share = others * a * v
    rates = others * a * z
    forces = -(mass * moved * a)
    return (
        mass,
        forces * v,
        forces * (x + z * share),
        rates,
        rates * share + others * a * x,
        forces * z,
    )


def _complete(c: _Matrix, b: _Matrix) -> _Matrix:
    """Rows on which B does not act and that complete those of C, with as many zeros as possible."""
    free = b.transpose().nullspace().to_field()
    rows, known = _Matrix([], (0, c.shape[1]), sp.QQ), c
    for i in range(free.shape[0]):
        row = free.extract([i], list(range(free.shape[1])))
        more = known.vstack(row)
        if more.rank() > known.shape[0]:
            rows, known = rows.vstack(row), more
    return rows


def _refuse_cancelled(system: control.TransferFunction, name: str) -> None:
    for above, below in zip(np.ravel(_rows(system.num)), np.ravel(_rows(system.den)), strict=True):
        p, q = (
            sp.Poly([exact_decimal(x) for x in side], _S, domain="QQ") for side in (above, below)
        )
        where = "in an entry that does not say what drives it: pass a state space"
        _refuse(name, _roots(sp.gcd(p, q)), where)


def _rows(sides: Sequence[Sequence[np.ndarray]]) -> np.ndarray:
    flat = np.empty((len(sides), len(sides[0])), dtype=object)
    for i, row in enumerate(sides):
        for j, side in enumerate(row):
            flat[i, j] = side
    return flat


def _roots(hidden: sp.Poly) -> np.ndarray:
    roots = np.roots([float(Fraction(int(c.p), int(c.q))) for c in hidden.all_coeffs()])
    return np.asarray(roots[roots.real >= -_ROUNDING * np.abs(roots)])


def _refuse(name: str, modes: np.ndarray, where: str) -> None:
    """Raise ModelError for the first of these modes, if there is one."""
    if len(modes):
        raise ModelError(
            f"{name}: the plant has a mode at {complex(modes[0]):.4g} 1/s that does not decay and "
            f"is not in its transfer functions, {where}"
        )


def with_common_modes(
    system: control.TransferFunction, *, name: str
) -> control.TransferFunction | control.StateSpace:
    """The system as a state space if entries share a mode that does not decay; else unchanged.

    raises ModelError: a mode that grows is shared, and the matrices are no decimal numbers
    """
    from ..base import python_control as control

    ratios = [
        [_ratio(p, q) for p, q in zip(*row, strict=True)]
        for row in zip(system.num, system.den, strict=True)
    ]
    discrete = system.isdtime(strict=True)
    shared = _shared_poles([q for row in ratios for _, q in row])
    growth = np.abs(shared) - 1 if discrete else shared.real / np.maximum(np.abs(shared), 1.0)
    if not (growth >= -_ROUNDING).any():
        return system
    if any(p.degree() > q.degree() for row in ratios for p, q in row):
        return system  # improper: refused entry by entry
    a, b, c, d = _realise_columns(ratios)
    matrices = (*_drop_hidden(a, b, c), d)
    if matrices[0].shape[0] == sum(q.degree() for row in ratios for _, q in row):
        return system  # no state would be less
    made, are_exact = _as_floats(*matrices)
    if are_exact:
        return control.ss(*made, system.dt)
    if (growth > _ROUNDING).any():
        pole = shared[int(np.argmax(growth))]
        raise ModelError(
            f"{name}: entries share a mode that grows, at {pole:.4g}, and each would have a copy "
            "of it, which no loop stabilises: pass the system as a state space (control.ss)"
        )
    return system


def _ratio(above: Sequence[float], below: Sequence[float]) -> tuple[sp.Poly, sp.Poly]:
    """Coprime numerator and denominator; the denominator is monic."""
    p, q = (sp.Poly([exact_decimal(x) for x in side], _S, domain="QQ") for side in (above, below))
    p, q = p.cancel(q, include=True)
    return p.quo_ground(q.LC()), q.monic()


def _shared_poles(denominators: Sequence[sp.Poly]) -> np.ndarray:
    """Roots that at least two of the denominators share."""
    every = [
        sp.gcd(p, q) for k, p in enumerate(denominators) for q in denominators[k + 1 :]
    ]  # fmt: skip
    roots = [np.roots([float(c) for c in p.all_coeffs()]) for p in every if p.degree() > 0]
    return np.concatenate([np.empty(0, dtype=complex), *roots])


def _realise_columns(
    ratios: Sequence[Sequence[tuple[sp.Poly, sp.Poly]]],
) -> tuple[_Matrix, _Matrix, _Matrix, _Matrix]:
    """A, B, C, D: the companion form of each column's common denominator, one for each input."""
    columns = len(ratios[0])
    below = [reduce(sp.lcm, (row[j][1] for row in ratios)).monic() for j in range(columns)]
    starts = np.cumsum([0, *(q.degree() for q in below)]).tolist()
    n, zero = starts[-1], sp.S(0)
    a, b = [[zero] * n for _ in range(n)], [[zero] * columns for _ in range(n)]
    c, d = ([[zero] * size for _ in ratios] for size in (n, columns))
    for j, q in enumerate(below):
        start, end = starts[j : j + 2]
        for k in range(start, end - 1):
            a[k][k + 1] = sp.S(1)
        if end > start:
            a[end - 1][start:end] = [-x for x in _rising(q, q.degree())]
            b[end - 1][j] = sp.S(1)
        for i, row in enumerate(ratios):
            p = row[j][0] * q.quo(row[j][1])
            d[i][j] = p.coeff_monomial(_S ** q.degree())
            c[i][start:end] = _rising(p - q * d[i][j], q.degree())
    shapes = ((n, n), (n, columns), (len(ratios), n), (len(ratios), columns))
    one, two, three, four = map(_exact, (a, b, c, d), shapes)
    return one, two, three, four


def _rising(p: sp.Poly, count: int) -> list[sp.Rational]:
    """Coefficients of the lowest powers, as many as `count`."""
    return [p.coeff_monomial(_S**k) for k in range(count)]


def _drop_hidden(a: _Matrix, b: _Matrix, c: _Matrix) -> tuple[_Matrix, _Matrix, _Matrix]:
    """A, B, C without states that no output shows (Kalman), with as many zeros as possible."""
    rows, pivots = c.rref()
    while True:
        shown = rows.extract(list(range(len(pivots))), list(range(a.shape[0])))
        known = len(pivots)
        rows, pivots = shown.vstack(shown * a).rref()
        if len(pivots) == known:
            break
    kept = list(pivots)
    moved, outputs = shown * a, list(range(c.shape[0]))
    return (
        moved.extract(list(range(known)), kept),
        shown * b,
        c.extract(outputs, kept),
    )
