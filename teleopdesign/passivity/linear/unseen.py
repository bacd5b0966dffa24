"""Modes that ports do not show: from rest they stay at rest, so no impedance contains them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np
import sympy as sp

from ...derive.all_states import all_states
from ...derive.polynomials import as_poly, element, is_hurwitz, roots_of
from ...diagrams import Block, Diagram
from ...realise.lti import S

#: share of its size by which a root may lie on the left by rounding alone
_NEAR = 1e-9


def not_decaying(p: sp.Poly) -> tuple[complex, ...]:
    """Roots that are not in the open left half plane, one of each pair; none, decided exactly."""
    if is_hurwitz(p):
        return ()
    s = roots_of(element(p.sqf_part()))
    near = s[(s.real >= -_NEAR * np.abs(s)) & (s.imag >= 0)]
    return tuple(map(complex, near if len(near) else s[[s.real.argmax()]]))


def unseen_within(part: Block) -> tuple[complex, ...]:
    """Modes of a block with values that it does not show and that do not decay, 1/s."""
    driver = getattr(part, "driver", "")
    outside = dict.fromkeys((*part.inputs, *([driver] if driver else ())), "force")
    states = all_states(Diagram(part.name, (part,), (), outside, ()))
    d, n = states.solve(part.outputs, tuple(dict.fromkeys(part.inputs)))
    shared = reduce(lambda a, b: a.gcd(b), (e for row in n for e in row), d)
    is_late = any(any(k[1:]) for k in shared)
    return not_decaying(as_poly(shared, S)) if d and not is_late else ()


def explain_unseen(modes: Sequence[complex]) -> str:
    """The reason of an unknown claim beside modes that no port shows and that do not decay, 1/s."""
    start = "from rest its impedance is that of a passive port, but"
    if any(np.isnan(m) for m in modes):
        return f"{start} with its dead times a mode that no port shows is not shown to decay"
    shown = ", ".join(f"{m.real:.4g}{f' +- {m.imag:.4g}j' * bool(m.imag)}" for m in modes)
    number = "a mode that no port shows does" if len(modes) == 1 else "modes that no port shows do"
    return f"{start} {number} not decay, at s = {shown} 1/s"
