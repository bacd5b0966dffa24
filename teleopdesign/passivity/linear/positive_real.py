"""The exact positive-real test of an impedance, with its excess of damping as margin."""

from __future__ import annotations

from typing import Any

import sympy as sp

from ...derive.polynomials import element
from ..claims.claim import Claim, Unknown
from ..search.growing_wave import GrowingWave
from .excess import Excess, damping_excess, is_positive_real, mobility_excess
from .family import family_of_impedance
from .gaussian import value
from .impedance import Impedance, MotionKind, impedance
from .judge import NO_WAVE, passive_claim
from .unseen import explain_unseen, unseen_modes

__all__ = [
    "NEARBY",
    "NO_WAVE",
    "Excess",
    "damping_excess",
    "is_positive_real",
    "mobility_excess",
    "positive_real",
]

#: relative change of a coefficient that may be rounding: some operations on floats, 2^-53 each
NEARBY = 2.0**-50


def positive_real(system: Any, *, motion: MotionKind = "velocity") -> Claim:
    """Is this impedance passive: does it never release more energy than it took in?

    system, motion: see `impedance`
    returns: proved, with the excess of damping as margin (N s/m: the damping that could be taken
        away); exact evidence where a certificate would ask for more work than its checker does
        (from degree 25 on); or refuted by a growing wave. Unknown where a mode of a python-control
        system that its port does not show does not decay, where the sign of the wave rests on the
        last digits of floats, or where the wave releases so little energy that a replay in double
        precision does not show it
    raises ModelError: not a rational function of s with known coefficients
    """
    z = impedance(system, motion=motion)
    claim = passive_claim(family_of_impedance(z))
    if claim.status == "refuted" and is_rounded(system) and _rests_on_rounding(z, claim.record):
        why = f"it fails, but a relative change of coefficients by {NEARBY:.1g} decides: rounding"
        return Claim(claim.statement, Unknown(why))
    if claim.holds and (modes := unseen_modes(system)):
        return Claim(claim.statement, Unknown(explain_unseen(modes)))
    return claim


def is_rounded(system: Any) -> bool:
    """Whether a system contains floats, which earlier operations may have rounded."""
    if isinstance(system, Impedance):
        return False
    return hasattr(system, "isdtime") or bool(sp.sympify(system).atoms(sp.Float))


def _rests_on_rounding(z: Impedance, wave: Any) -> bool:
    """Whether Re Z at the wave may change its sign if each coefficient changes by NEARBY.

    To first order abs(dZ) <= NEARBY (sum abs(p_k s^k) + abs(Z) sum abs(q_k s^k))/abs(q).
    """
    assert isinstance(wave, GrowingWave)
    s, at = wave.s, complex(wave.value[0, 0])
    above, below = (
        sum(abs(float(c)) * abs(s) ** k for (k,), c in part.terms()) for part in (z.p, z.q)
    )
    size = abs(complex(*map(float, value(element(z.q), (wave.rate, wave.frequency)))))
    return bool(abs(at.real) * size <= NEARBY * (above + abs(at) * below))
