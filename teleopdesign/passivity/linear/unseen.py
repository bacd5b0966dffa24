"""Modes that ports do not show: from rest they stay at rest, so no impedance contains them."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import reduce
from typing import Any

import numpy as np
import sympy as sp

from ...controllers import resolvent
from ...derive.all_states import all_states
from ...derive.polynomials import as_poly, element, fraction, is_hurwitz, roots_of
from ...diagrams import Block, Diagram
from ...realise.lti import S
from .impedance import exact
from .matrices import determinant, hold

#: share of its size by which a root may lie on the left by rounding alone
_NEAR = 1e-9


def not_decaying(p: sp.Poly) -> tuple[complex, ...]:
    """Roots that are not in the open left half plane, one of each pair; none, decided exactly."""
    if is_hurwitz(p):
        return ()
    s = roots_of(element(p.sqf_part()))
    near = s[(s.real >= -_NEAR * np.abs(s)) & (s.imag >= 0)]
    return tuple(map(complex, near if len(near) else s[[s.real.argmax()]]))


def unseen_modes(system: Any) -> tuple[complex, ...]:
    """Modes of a system of python-control that its ports do not show and that do not decay, 1/s.

    From rest such a mode stays at rest, so the impedance does not contain it. What ports of a state
    space do not show is the same whatever holds them. Empty for any other kind of system.
    """
    if hasattr(system, "num"):
        above, below = ([side for row in m for side in row] for m in (system.num, system.den))
        pairs = (map(_polynomial, pair) for pair in zip(above, below, strict=True))
        return tuple(mode for pair in pairs for mode in not_decaying(sp.gcd(*pair)))
    if not hasattr(system, "A") or not len(system.A):
        return ()
    matrices = (system.A, system.B, system.C, system.D)
    a, b, c, straight = ([[fraction(exact(x)) for x in row] for row in m] for m in matrices)
    places = range(len(c))

    def in_ring(falling: Sequence[Fraction]) -> Any:
        return element(_polynomial(falling))

    made = [[resolvent(a, [row[j] for row in b], c[i]) for j in places] for i in places]
    d = in_ring(made[0][0][0])
    n = [
        [in_ring(one) + in_ring([x]) * d for (_, one), x in zip(*row, strict=True)]
        for row in zip(made, straight, strict=True)
    ]
    loose, tight = (determinant(hold(n, d, [sp.QQ(c)] * len(n))) for c in (1, 3))
    shared = loose.gcd(tight)
    for _ in places[1:]:
        shared = shared.exquo(d)
    return not_decaying(as_poly(shared, S))


def unseen_within(part: Block) -> tuple[complex, ...]:
    """Modes of a block with values that it does not show and that do not decay, 1/s."""
    driver = getattr(part, "driver", "")
    outside = dict.fromkeys((*part.inputs, *([driver] if driver else ())), "force")
    states = all_states(Diagram(part.name, (part,), (), outside, ()))
    d, n = states.solve(part.outputs, tuple(dict.fromkeys(part.inputs)))
    shared = reduce(lambda a, b: a.gcd(b), (e for row in n for e in row), d)
    is_late = any(any(k[1:]) for k in shared)
    return not_decaying(as_poly(shared, S)) if d and not is_late else ()


def _polynomial(falling: Sequence[float | Fraction]) -> sp.Poly:
    return sp.Poly([exact(c) for c in falling] or [0], S, domain="QQ")


def explain_unseen(modes: Sequence[complex]) -> str:
    """The reason of an unknown claim beside modes that no port shows and that do not decay, 1/s."""
    start = "from rest its impedance is that of a passive port, but"
    if any(np.isnan(m) for m in modes):
        return f"{start} with its dead times a mode that no port shows is not shown to decay"
    shown = ", ".join(f"{m.real:.4g}{f' +- {m.imag:.4g}j' * bool(m.imag)}" for m in modes)
    number = "a mode that no port shows does" if len(modes) == 1 else "modes that no port shows do"
    return f"{start} {number} not decay, at s = {shown} 1/s"
