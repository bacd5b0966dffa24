"""How much inertia may be cancelled with an acceleration that is delayed and low-passed.

    Z = m s + B - mhat s F(s) e^(-s tau),   F = 1/(T s + 1)^r

Along x = A sin(w t) the cancellation releases pi mhat A^2 w g(w) per cycle, and the damping takes
pi B A^2 w:

    g = Re[j w F(j w) e^(-j w tau)] = w abs(F) sin(lag),   lag = w tau + r atan(w T)

Without a low-pass g = w sin(w tau) (P48) has no bound, so no damping is sufficient. With a
low-pass, abs(g) < 1/T for r = 1, approached at high frequency for any delay; and
abs(g) <= 1/(2 T) for r = 2, reached at w T = 1 without delay.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated, Any, Literal

import numpy as np
import sympy as sp

from ...base.errors import ModelError
from ...realise.lti import S
from ..claims.claim import Claim, Evidence, Proof, Unknown
from ..linear.impedance import decimal
from ..linear.judge import positive_real
from ..search.growing_wave import rates_at
from ._hypotheses import NonNegative, certificate, one_of, require_hypotheses
from ._theorem import Theorem, refute_by_wave

Order = Literal[1, 2]
#: longest delay, in time constants, for which the maximum of g is searched: 2.5 million samples
_LATEST = 10_000
_PER_TURN = 200  # samples of g per turn of its phase: maxima within 1e-4, then refined


def damping_given_out(
    frequency: np.ndarray, *, delay: float, time_constant: float = 0.0, order: Order = 2
) -> np.ndarray:
    """Negative damping for each kg of cancelled inertia, g, N s/m/kg, at each frequency.

    frequency: Hz, (n,);  delay: tau, s
    time_constant: T of the low-pass, s; 0: no low-pass;  order: r of the low-pass
    """
    s = 2j * np.pi * np.asarray(frequency, dtype=float)
    return np.asarray((s * np.exp(-s * delay) / (1 + s * time_constant) ** order).real)


def largest_passive_inertia(
    *, damping: float, delay: float, time_constant: float = 0.0, order: Order = 2
) -> float:
    """Largest inertia (kg) that may be cancelled so that damping covers it at every frequency.

    It is B T for r = 1, and B over the maximum of g, at least 2 B T, for r = 2. Without a low-pass
    it is 0 with any delay, and inf without delay (the inertia of the device is then the limit).

    damping: B, N s/m;  delay: tau, s;  time_constant: T of the low-pass, s; 0: no low-pass
    order: r of the low-pass;  raises ModelError: a negative argument, or another order
    """
    if min(damping, delay, time_constant) < 0:
        raise ModelError("largest_passive_inertia: no value may be negative")
    if order not in (1, 2):
        raise ModelError(f"largest_passive_inertia: order of the low-pass is 1 or 2, found {order}")
    if time_constant == 0:
        return 0.0 if delay else float("inf")
    if order == 1:
        return damping * time_constant
    if delay == 0:
        return 2 * damping * time_constant
    return damping / _maximum(delay, time_constant)[1]


@require_hypotheses
def cancelled_inertia(
    *,
    inertia: NonNegative,
    damping: NonNegative,
    cancelled: NonNegative,
    delay: NonNegative,
    time_constant: NonNegative = 0,
    order: Annotated[int, one_of(1, 2)] = 2,
) -> Claim:
    """Is a device passive if a part of its inertia is cancelled, delayed and low-passed?

    inertia: m, kg;  damping: B, N s/m;  cancelled: mhat, kg;  delay: tau, s
    time_constant: T of the low-pass, s; 0: no low-pass;  order: r, 1 or 2
    returns: proved where mhat <= r B T, for any delay (the certificate assumes g <= 1/(r T));
        without delay decided exactly; else refuted by a growing wave, or, for r = 2 with delay
        between 2 B T and the limit, evidence; unknown where no wave is available, or for a delay of
        more than 10000 time constants
    """
    m, b, c, tau, t = inertia, damping, cancelled, delay, time_constant
    filtered = f", low-passed of order {order} with {decimal(t)} s" if t else ""
    statement = (
        f"a device of {decimal(m)} kg and {decimal(b)} N s/m with {decimal(c)} kg cancelled "
        f"{decimal(tau)} s late{filtered} is passive"
    )
    late = sp.exp(-S * tau) if tau else sp.S(1)
    z = m * S + b - c * S * late / (t * S + 1) ** order
    if t and c <= order * b * t:
        method = "Re Z >= B - mhat/(r T) >= 0 at every frequency, for any delay"
        made = certificate("cancelled_inertia", B=b, T=t, m=c, r=sp.S(order))
        return Claim(statement, Proof(method, (made,), float(b - c / (order * t)), "N s/m"))
    if not tau or not c:
        return Claim(statement, positive_real(z if c else m * S + b).verdict)
    if t and order == 2 and tau > _LATEST * t:
        why = (
            f"a delay of more than {_LATEST} time constants: its turns are too many to be searched"
        )
        return Claim(statement, Unknown(why))
    if t and order == 2:
        w, most = _maximum(float(tau), float(t))
        margin = float(b) - float(c) * most
        if margin >= 0:
            searched = f"least Re Z over frequency, at {w / (2 * np.pi):.4g} Hz"
            return Claim(statement, Evidence(True, searched, margin, "N s/m"))
        where = [w]
    else:  # the phase of jw at the peaks; far enough up for a margin of 1e-3
        where = [(2 * np.pi * n + np.pi / 2 * (not t)) / float(tau) for n in 2 ** np.arange(0, 14)]
    points = (point for w in where for point in rates_at(Fraction(w), 30))
    return refute_by_wave(statement, z, points)


def _maximum(delay: float, time_constant: float) -> tuple[float, float]:
    """(w, g) at the maximum of g of order 2, rad/s and N s/m/kg.

    Beyond the searched range the bound w/(1 + (w T)^2) of g is below the maximum.
    """
    from scipy.optimize import minimize_scalar

    def g(w: Any) -> np.ndarray:
        f = np.atleast_1d(w) / (2 * np.pi)
        return damping_given_out(f, delay=delay, time_constant=time_constant)

    # up to w T = 8 the bound falls to a quarter of its peak; g reaches that within the first turns
    turns = 2 + 8 * delay / time_constant / (2 * np.pi)
    grid = np.linspace(0, 8 / time_constant, int(_PER_TURN * turns) + 1)
    values = g(grid)
    k = int(np.argmax(values))
    if values[k] < grid[-1] / (1 + (grid[-1] * time_constant) ** 2):
        raise AssertionError(f"g is larger beyond {grid[-1]} rad/s")
    near = grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]
    maximum = minimize_scalar(
        lambda w: -float(g(w)[0]), bounds=near, method="bounded", options={"xatol": 1e-9 * near[1]}
    )
    return float(maximum.x), -float(maximum.fun)


THEOREM = Theorem(mathematics=(cancelled_inertia,), order=74)
