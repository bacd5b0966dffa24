"""A plant with all its states as masses, dampers, springs and the states beside them, exactly.

    x' = A x + B u,   y = C x        M y'' + D y' + K y + F z = u,   z' = G z + H y

The states x are y, y' and others, on which u does not act at once. Less a share of y, these are z:
no state is lost, also none that no force reaches or that no position shows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
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
    parts = _split(a, b, c)
    made = [np.array(m.to_Matrix().tolist(), dtype=float).reshape(m.shape) for m in parts]
    if not all(
        exact_decimal(x) == e
        for m, exact in zip(made, parts, strict=True)
        for x, e in zip(m.ravel(), exact.to_Matrix(), strict=True)
    ):
        whole, rest = (sp.Poly(m.charpoly(), _S, domain="QQ") for m in (a, shown[0]))
        modes = _roots(whole.quo(rest))
        on_axis = modes[modes.real <= _ROUNDING * np.abs(modes)]  # where rounding would decide
        _refuse(name, on_axis, "in numbers that no state space of decimals has")
    mass, damping, stiffness, rates, driven, forces = made
    return PlantStates(mass, damping, stiffness, (rates, driven, forces))


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
