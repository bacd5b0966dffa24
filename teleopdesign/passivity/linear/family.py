"""The linear form of a device at its ports, with all its states.

    force = Z velocity,   Z = N/d

N and d are polynomials in s, in values that vary over a box, and in one symbol for e^(-s T) of each
dead time. A point is a box without values, an impedance of one port is 1 x 1.

`held` has a root for each mode of the device with a damper at each port, but for free motions of
the ports themselves. Where Z is passive, what the ports show decays there. So if Z is passive,
roots of `held` that are not in the open left half plane are modes that no port shows.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache, reduce
from math import prod
from typing import TYPE_CHECKING, Any

import mpmath
import numpy as np
import sympy as sp
from sympy.polys.matrices import DomainMatrix

from ...base.errors import ModelError
from ...derive.all_states import AllStates, all_states, is_well_posed
from ...derive.linear_rows import Row, read_late_ratios
from ...derive.polynomials import as_poly, element
from ...diagrams import Diagram
from ...frequency.late_zeros import count_growing, terms_of, zeros_at_origin
from ...realise.lti import S
from .impedance import Impedance, exact, impedance_of, not_decaying
from .matrices import Matrix, close, cofactors, damper, dampers, determinant, divide_out, hold
from .signs import Ends, degree

if TYPE_CHECKING:
    from ..ports import Port

#: values of Z, (m, n, n), from points s, (m,), and a point of the box, (values,)
Evaluation = Callable[..., np.ndarray]


@dataclass(frozen=True, eq=False)
class Family:
    """The linear form of a device at its ports.

    n: numerators of Z (N s/m);  d: their common denominator, coprime as a whole
    held: determinant of all states, with a damper at each port
    names, ends: values of the box, generators of the ring after s, and their intervals
    times: symbol of e^(-s T) -> T: a number, or the symbol of a value
    written: Z as it was written, for texts; default: `z`
    resting: zeros of `held` at s = 0 that are free motions of the ports, with dead times
    unseen: modes of its python-control systems that no port shows and that do not decay, 1/s
    """

    n: Matrix
    d: Any
    held: Any
    names: tuple[str, ...] = ()
    ends: Ends = ()
    times: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)
    written: sp.ImmutableMatrix | None = None
    resting: int = 0
    unseen: tuple[complex, ...] = ()

    @property
    def size(self) -> int:
        """Number of ports."""
        return len(self.n)

    @property
    def values(self) -> tuple[sp.Symbol, ...]:
        """Symbols of the values."""
        symbols: tuple[sp.Symbol, ...] = self.d.ring.symbols
        return symbols[1 : 1 + len(self.names)]

    @cached_property
    def z(self) -> sp.ImmutableMatrix:
        """Z in `S`, the symbols of values and exp(-S T), each entry coprime."""
        late = {mark: sp.exp(-S * time) for mark, time in self.times.items()}

        def entry(above: Any) -> sp.Expr:
            p, q = above.cancel(self.d)
            p, q = (side.mul_ground(1 / q.LC) for side in (p, q))
            return (p.as_expr() / q.as_expr()).xreplace(late)

        return sp.ImmutableMatrix([[entry(e) for e in row] for row in self.n])

    @cached_property
    def at(self) -> Evaluation:
        """Values of Z in floats, compiled once."""

        def in_floats(e: sp.Expr) -> sp.Expr:
            long = (x for x in e.atoms(sp.Rational) if not x.is_Integer or abs(x) >= 2**31)
            return e.xreplace({x: sp.Float(x, 17) for x in long})

        entries = [in_floats(e) for e in self.z]
        call, size = sp.lambdify([S, *self.values], entries, "numpy"), self.size

        def values(s: np.ndarray, point: Sequence[float] = ()) -> np.ndarray:
            with np.errstate(all="ignore"):  # a pole is infinite, a late term far out is 0
                made = call(np.asarray(s, dtype=complex), *point)
            flat = [np.broadcast_to(np.asarray(e, dtype=complex), np.shape(s)) for e in made]
            return np.stack(flat, axis=-1).reshape(-1, size, size)

        return values

    def precisely(self, s: mpmath.mpc, late: Sequence[mpmath.mpc] = ()) -> list[list[mpmath.mpc]]:
        """Z at one s, N s/m, in the digits of mpmath; without values.

        late: values of e^(-s T), other than those of s
        raises ZeroDivisionError: s is a pole
        """
        times = (mpmath.mpf(int(t.p)) / int(t.q) for t in self.times.values())
        late = late or [mpmath.exp(-s * t) for t in times]

        def value(p: Any) -> mpmath.mpc:
            total = mpmath.mpc(0)
            for powers, c in p.items():
                term = mpmath.mpf(int(c.numerator)) / int(c.denominator) * s ** powers[0]
                for factor, power in zip(late, powers[1:], strict=True):
                    term *= factor**power
                total += term
            return total

        below = value(self.d)
        return [[value(e) / below for e in row] for row in self.n]

    @property
    def impedance(self) -> Impedance:
        """The impedance of one port, without dead times and values."""
        return impedance_of(self.n[0][0], self.d)

    @cached_property
    def undecayed(self) -> tuple[complex, ...]:
        """Modes that do not decay with the ports held, 1/s; without values.

        With dead times one NaN stands for all of them.
        raises ModelError: dead times are too long against the fastest mode
        """
        if self.times:
            at_rest = zeros_at_origin(self.held, self.times) if self.held else 0
            stays = at_rest > self.resting
            grows = stays or count_growing(terms_of(self.held, self.times), at_rest)
            return (complex(np.nan),) * bool(grows)
        return not_decaying(as_poly(self.held, S))

    @property
    def hides(self) -> bool:
        """Whether the device has modes that no port shows; without values."""
        shown = close(self.n, self.d, dampers(self.n, self.d))
        return degree(shown) < degree(self.held)


def family_at(diagram: Diagram, at: Sequence[Port]) -> Family:
    """The linear form of a diagram at ports, at its values; other outside signals are zero.

    raises ModelError: a loop determines nothing, or its gain is -1 at high frequency, or the ports
        do not move apart; as `all_states`
    """
    states = all_states(diagram)
    if not is_well_posed(diagram, states):
        raise ModelError(f"{diagram.name}: a loop has the gain -1 at high frequency")
    return family_of_states(states, at)


def family_of_states(
    states: AllStates, at: Sequence[Port], names: Sequence[str] = (), ends: Ends = ()
) -> Family:
    """The linear form at ports from the equations of all states.

    names, ends: values that the equations hold as symbols, and their intervals
    raises ModelError: the ports do not move apart, or the equations do not determine them
    """
    ports = [f"port {k}" for k in range(len(at))]
    d, above = states.solve([p.force for p in at], ports, port_rows(states, at, ports))
    if not d:
        raise ModelError(f"{states.name}: its ports do not move apart: they have no impedance")
    # above/d is force over position
    s, size = states.ring.gens[0], len(at)
    held = determinant(hold(above, d * s, dampers(above, d * s)))
    for _ in range(1, size):
        held = held.exquo(d)
    resting = _count_resting(states, at)
    while resting and held and not any(k[0] == 0 for k in held):
        held, resting = held.exquo(s), resting - 1
    n, below = divide_out(above, d * s)
    return Family(n, below, held, tuple(names), ends, states.times, resting=resting)


def _count_resting(states: AllStates, at: Sequence[Port]) -> int:
    """Number of independent displacements of the ports after which all stands still again.

    They are no states of Z, which has velocities. For values in general
    """
    symbols = states.ring.symbols[1:]
    point = [1 if x in states.times else sp.prime(20 + k) for k, x in enumerate(symbols)]

    def still(p: Any) -> Any:
        kept = ((k[1:], c) for k, c in p.items() if k[0] == 0)
        factors = (c * prod(x**e for x, e in zip(point, k, strict=True)) for k, c in kept)
        return sum(factors, sp.QQ(0))

    names = states.unknown
    rows = [[still(row[n]) if n in row else sp.QQ(0) for n in names] for row in states.rows]
    shapes = DomainMatrix(rows, (len(rows), len(names)), sp.QQ).nullspace()
    weights = [[sp.QQ.convert(exact(p.weights.get(n, 0))) for p in at] for n in names]
    moved = shapes * DomainMatrix(weights, (len(names), len(at)), sp.QQ)
    return len(moved.rref()[1])


def port_rows(states: AllStates, at: Sequence[Port], names: Sequence[str]) -> list[Row]:
    """The motion of each port as a sum of motions of bodies."""
    rows: list[Row] = []
    for name, port in zip(names, at, strict=True):
        weights = ((m, exact(w)) for m, w in port.weights.items())
        terms = {m: states.ring(-sp.QQ(int(w.p), int(w.q))) for m, w in weights}
        rows.append({name: states.ring.one, **terms})
    return rows


@lru_cache(maxsize=32)
def family_of_matrix(z: sp.ImmutableMatrix) -> Family:
    """The family of functions of s, with exp(-s T) for dead times; they have no further states.

    z: N s/m, square, in `S` with exact numbers
    raises ModelError: an entry is no ratio of polynomials in s and dead times
    """
    pairs, times = read_late_ratios(z, "impedance")
    d = reduce(lambda p, q: p * q.exquo(p.gcd(q)), (q for _, q in pairs))
    entries, size = [p * d.exquo(q) for p, q in pairs], z.rows
    n = [entries[k : k + size] for k in range(0, len(entries), size)]
    resting = _count_lost(n, d, times) if times else 0
    return Family(n, d, close(n, d, dampers(n, d)), times=times, written=z, resting=resting)


def _count_lost(n: Matrix, d: Any, times: Mapping[sp.Symbol, sp.Expr]) -> int:
    """Zeros at s = 0 of the denominator of (N/d + dampers)^-1 that all entries above it share.

    No polynomial divides by them, because at s = 0 the dead times make them.
    """
    whole, above = cofactors(hold(n, d, dampers(n, d)), d)
    shared = reduce(lambda a, b: a.gcd(b), above, whole)
    return min((zeros_at_origin(p.exquo(shared), times) for p in (whole, *above) if p), default=0)


def family_of_impedance(z: Impedance) -> Family:
    """The family of an impedance of one port without further states."""
    n, d = element(z.p), element(z.q)
    return Family([[n]], d, n + d * damper(n, d), unseen=z.unseen)
