"""A delayed compensator: the energy that it releases, and when small motion stays passive.

Along x = A sin(w t) a Dahl compensator of describing function N, whose position input is late by
tau, releases

    W = pi A^2 Im(N e^(-j w tau))

per cycle. For w tau < pi this is less than without delay. A delayed cancellation of inertia
releases energy for any delay with w tau < pi.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

import numpy as np
import sympy as sp

from ...realise.lti import S
from ..claims.claim import Claim, Proof
from ..linear.impedance import decimal
from ..search.growing_wave import rates_at
from ._hypotheses import NonNegative, certificate, require_hypotheses
from ._theorem import Theorem, refute_by_wave

#: just above 0.2172336, which is minus the least value of sin(y)/y (at tan y = y, y = 4.4934)
SINC_LEAST = sp.Rational(21724, 100000)


def inertia_given_out(*, inertia: float, amplitude: float, frequency: float, delay: float) -> float:
    """Energy that a delayed cancellation of inertia releases per cycle, J.

    pi m A^2 w^2 sin(w tau)

    inertia: m, cancelled, kg;  amplitude: A, m;  frequency: Hz;  delay: tau, s
    """
    w = 2 * np.pi * frequency
    return float(np.pi * inertia * amplitude**2 * w**2 * np.sin(w * delay))


@require_hypotheses
def delayed_small_motion(
    *,
    damping: NonNegative,
    compensator_stiffness: NonNegative,
    delay: NonNegative,
    presliding_stiffness: NonNegative,
) -> Claim:
    """Is small motion passive: friction is then a spring, the compensator a late negative spring.

        Z = B + (sigma_p - sigma_D e^(-s tau))/s

    It is passive if and only if sigma_D <= sigma_p and B >= 0.21723.. sigma_D tau. This factor is
    minus the least value of sin(y)/y.

    damping: B, N s/m;  compensator_stiffness: sigma_D, N/m;  delay: tau, s
    presliding_stiffness: sigma_p, N/m
    returns: proved, or refuted by a growing wave; unknown where the search has no wave
    """
    b, tau, sigma_d, sigma_p = damping, delay, compensator_stiffness, presliding_stiffness
    margin = b - SINC_LEAST * sigma_d * tau
    late = sp.exp(-S * tau) if tau else sp.S(1)
    statement = (
        f"small motion with damping {decimal(b)} N s/m, presliding {decimal(sigma_p)} N/m and a "
        f"compensator {decimal(sigma_d)} N/m that is {decimal(tau)} s late is passive"
    )
    if sigma_d > sigma_p or margin < 0:
        z = b + (sigma_p - sigma_d * late) / S
        return refute_by_wave(statement, z, _where(float(tau)))
    method = "Re Z >= 0 at every frequency, pole at 0 with residue sigma_p - sigma_D >= 0"
    made = certificate("late_negative_spring", B=b, sigma_D=sigma_d, tau=tau)
    return Claim(statement, Proof(method, (made,), float(margin), "N s/m"))


def _where(tau: float) -> Iterator[tuple[Fraction, Fraction]]:
    """Rates and frequencies about the first minimum of sin(w tau)/(w tau), then exponentials."""
    for y in (4.4934, 4.0, 5.0, 3.5, 5.5) if tau else ():
        yield from rates_at(Fraction(y / tau), 24)
    for k in range(40, -41, -1):
        yield Fraction(2) ** k, Fraction(0)


THEOREM = Theorem(mathematics=(delayed_small_motion,), order=72)
