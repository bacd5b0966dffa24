"""The linear form of a device at its ports, with all its states.

    force = Z velocity,   Z = N/(s d)

N and d are polynomials in s, in values that stay symbols, and in one symbol for e^(-s T) of each
dead time. d has a root for each mode of the device with its ports clamped, also where N cancels it.
`held` has a root for each mode of the device with its ports held by dampers and springs. Where Z is
passive, those of its roots that are not in the open left half plane are modes that no port shows:
what the ports show decays there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from ...base.errors import ModelError
from ...controllers import resolvent
from ...derive.all_states import Row, all_states, is_well_posed
from ...derive.polynomials import fraction, is_hurwitz
from ...diagrams import Diagram
from ...frequency.late_loop import count_growing, terms_of
from ...realise.lti import S
from .impedance import exact

if TYPE_CHECKING:
    from ..ports import Port


@dataclass(frozen=True)
class Family:
    """The linear form of a device at its ports; N, d and `held` are polynomials in `ring`.

    values: symbols of values;  times: symbol of e^(-s T) -> dead time T
    """

    ring: Any
    numerators: tuple[tuple[Any, ...], ...]
    denominator: Any
    held: Any
    times: Mapping[sp.Symbol, sp.Expr]
    values: Mapping[str, sp.Symbol]

    @property
    def impedance(self) -> sp.Matrix:
        """Z in N s/m, in `S`, the symbols and exp(-S T), each entry coprime."""
        late = {mark: sp.exp(-S * time) for mark, time in self.times.items()}

        def entry(above: Any) -> sp.Expr:
            p, q = above.cancel(self.denominator * self.ring.gens[0])
            return (p.as_expr() / q.as_expr()).xreplace(late)

        return sp.Matrix([[entry(e) for e in row] for row in self.numerators])

    def undecayed(self) -> tuple[complex, ...]:
        """Modes that do not decay with the ports held, 1/s; without values as symbols.

        With dead times one mode stands for all: NaN.
        """
        if self.times:
            return (complex(np.nan),) * bool(count_growing(terms_of(self.held, self.times)))
        return _not_decaying(sp.Poly(self.held.as_expr(), S, domain="QQ"))


def _not_decaying(p: sp.Poly) -> tuple[complex, ...]:
    """Roots that are not in the open left half plane, one of each pair; none, decided exactly."""
    if is_hurwitz(p):
        return ()
    roots = np.array([complex(r) for r in p.sqf_part().nroots(n=20, maxsteps=200)])
    limit = 1e-12 * np.abs(roots)
    return tuple(complex(r) for r in roots[(roots.real >= -limit) & (roots.imag >= 0)])


def unseen_modes(system: Any) -> tuple[complex, ...]:
    """Modes of a system of python-control that its ports do not show and that do not decay, 1/s.

    From rest such a mode stays at rest, so the impedance does not contain it. What ports of a state
    space do not show is the same whatever holds them. Empty for any other kind of system.
    """
    if hasattr(system, "num"):
        above, below = ([side for row in m for side in row] for m in (system.num, system.den))
        sides = ([_polynomial(p), _polynomial(q)] for p, q in zip(above, below, strict=True))
        shared = (sp.gcd(*pair) for pair in sides)
        return tuple(mode for p in shared for mode in _not_decaying(p))
    if not hasattr(system, "A") or not len(system.A):
        return ()
    ring, s = sp.ring("s", sp.QQ)
    matrices = [[[fraction(exact(x)) for x in row] for row in m]
                for m in (system.A, system.B, system.C, system.D)]  # fmt: skip
    a, b, c, straight = matrices
    places = range(len(c))
    made = [[resolvent(a, [row[j] for row in b], c[i]) for j in places] for i in places]
    d = _in_ring(ring, made[0][0][0])
    n = [[s * (_in_ring(ring, made[i][j][1]) + straight[i][j] * d) for j in places] for i in places]
    loose, tight = (_hold(n, d, ring, factor) for factor in (1, 3))
    return _not_decaying(sp.Poly(loose.gcd(tight).as_expr(), S, domain="QQ"))


def _polynomial(falling: Sequence[float]) -> sp.Poly:
    return sp.Poly([exact(c) for c in falling], S, domain="QQ")


def _in_ring(ring: Any, falling: Sequence[Fraction]) -> Any:
    top = len(falling) - 1
    return ring({(top - k,): sp.QQ(c.numerator, c.denominator) for k, c in enumerate(falling) if c})


def explain_unseen(modes: Sequence[complex]) -> str:
    """The reason of an unknown claim beside modes that no port shows and that do not decay."""
    return f"from rest its impedance is that of a passive port, but {describe_modes(modes)}"


def describe_modes(modes: Sequence[complex]) -> str:
    """Words for modes that no port shows, from `Family.undecayed`."""
    if any(np.isnan(m) for m in modes):
        return "with its dead times a mode that no port shows is not shown to decay"
    shown = ", ".join(
        f"{m.real:.4g}" if not m.imag else f"{m.real:.4g} +- {m.imag:.4g}j" for m in modes
    )
    number = "a mode that no port shows does" if len(modes) == 1 else "modes that no port shows do"
    return f"{number} not decay, at s = {shown} 1/s"


def family_at(
    diagram: Diagram, at: Sequence[Port], values: Mapping[str, sp.Symbol] | None = None
) -> Family:
    """The linear form of a diagram at ports; all other outside signals are zero.

    raises ModelError: a loop determines nothing, or its gain is -1 at high frequency, or the ports
        do not move apart; as `all_states`
    """
    states = all_states(diagram, values=values)
    names = [f"port {k}" for k in range(len(at))]
    rows: list[Row] = []
    for name, port in zip(names, at, strict=True):
        weights = ((m, states.ring(-_rational(exact(w)))) for m, w in port.weights.items())
        rows.append({name: states.ring.one, **dict(weights)})
    d, n = states.solve([port.force for port in at], names, rows)
    if not d:
        raise ModelError(f"{diagram.name}: its ports do not move apart: they have no impedance")
    if not values and not is_well_posed(diagram, states):
        raise ModelError(f"{diagram.name}: a loop has the gain -1 at high frequency")
    return _family(states.ring, n, d, states.times, values or {})


def _family(
    ring: Any,
    n: Sequence[Sequence[Any]],
    d: Any,
    times: Mapping[sp.Symbol, sp.Expr],
    values: Mapping[str, sp.Symbol],
) -> Family:
    return Family(ring, tuple(map(tuple, n)), d, _hold(n, d, ring), times, values)


def _hold(n: Sequence[Sequence[Any]], d: Any, ring: Any, factor: int = 1) -> Any:
    """Determinant of the device with a damper and a spring at each port, `factor` times each."""
    rows, s = [list(row) for row in n], ring.gens[0]
    for k, row in enumerate(rows):
        damper, spring = _termination(row[k], d)
        row[k] = row[k] + d * factor * (damper * s + spring)
    held = determinant(rows, ring)
    for _ in rows[1:]:
        held = held.exquo(d)
    return held


def determinant(rows: list[list[Any]], ring: Any) -> Any:
    """Determinant of a small matrix of polynomials, along its first row."""
    if not rows:
        return ring.one
    total = ring.zero
    for k, entry in enumerate(rows[0]):
        if entry:
            rest = [row[:k] + row[k + 1 :] for row in rows[1:]]
            total += (-1) ** k * entry * determinant(rest, ring)
    return total


def _termination(n: Any, d: Any) -> tuple[Any, Any]:
    """A damper and a spring about as strong as a port: any numbers > 0 would be correct."""
    unit = max(abs(c) for p in (n, d) for c in p.values())

    def sizes(p: Any) -> dict[int, float]:
        total: dict[int, float] = {}
        for powers, c in p.items():
            share = abs(c) / unit
            size = float(Fraction(share.numerator, share.denominator))
            total[powers[0]] = total.get(powers[0], 0.0) + size
        return total

    above, below = sizes(n), sizes(d)
    if not above:
        return sp.QQ(1), sp.QQ(1)
    both = {k: above.get(k, 0.0) + below.get(k, 0.0) for k in {*above, *below}}
    low, high = min(both), max(both)
    rate = (both[low] / both[high]) ** (1 / (high - low)) if high > low else 1.0
    stiffness = sum(c * rate**k for k, c in above.items()) / sum(
        c * rate**k for k, c in below.items()
    )
    damper, spring = (Fraction(2.0 ** round(np.log2(x))) for x in (stiffness / rate, stiffness))
    return sp.QQ(damper.numerator, damper.denominator), sp.QQ(spring.numerator, spring.denominator)


def _rational(number: sp.Rational) -> Any:
    return sp.QQ(int(number.p), int(number.q))
