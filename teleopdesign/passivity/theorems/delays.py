"""How late a force may arrive: a cancellation of friction or of inertia, and a spring between arms.

A late compensator of friction. Along x = A sin(w t) a Dahl compensator of describing function N,
whose position input is late by tau, releases

    W = pi A^2 Im(N e^(-j w tau))

per cycle. For w tau < pi this is less than without delay.

A delayed and low-passed cancellation of inertia:

    Z = m s + B - mhat s F(s) e^(-s tau),   F = 1/(T s + 1)^r

Along x = A sin(w t) the cancellation releases pi mhat A^2 w g(w) per cycle, and the damping takes
pi B A^2 w:

    g = Re[j w F(j w) e^(-j w tau)] = w abs(F) sin(lag),   lag = w tau + r atan(w T)

Without a low-pass g = w sin(w tau) (P48) has no bound, so no damping is sufficient. With a
low-pass, abs(g) < 1/T for r = 1, approached at high frequency for any delay; and
abs(g) <= 1/(2 T) for r = 2, reached at w T = 1 without delay.

A teleoperator whose master and slave are coupled by a late spring. With dampings b_m, b_s of master
and slave, stiffness P and one-way delay T, Llewellyn's criterion reads b_m b_s >= (P T)^2 q(w),
q = (sin(w T)/(w T))^2 <= 1, with equality for w -> 0. The other conditions
(`checker/matrices.py`) hold for every such coupling. The entries have no pole but s = 0, where
e^(-s T) = 1. The residues there are P, P and -P, so that k11 k22 = k12 k21. At infinity the masses
grow like s, and the coupling between the ports does not. The product z12 z21 is bounded at high
frequency.
"""

from __future__ import annotations

from collections.abc import Iterator
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
from ..two_port import absolutely_stable, teleoperator_two_port
from ._hypotheses import NonNegative, Real, certificate, one_of, require_hypotheses
from ._theorem import refute_by_wave

#: just above 0.2172336, which is minus the least value of sin(y)/y (at tan y = y, y = 4.4934)
SINC_LEAST = sp.Rational(21724, 100000)


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


@require_hypotheses
def delayed_spring(
    *,
    master_inertia: NonNegative,
    master_damping: Real,
    slave_inertia: NonNegative,
    slave_damping: Real,
    stiffness: NonNegative,
    delay: NonNegative,
) -> Claim:
    """Is the teleoperator absolutely stable: if and only if b_m, b_s >= 0 and b_m b_s >= (P T)^2?

    master_inertia, slave_inertia: kg;  master_damping, slave_damping: b_m, b_s, N s/m
    stiffness: P, N/m;  delay: T, one way, s
    returns: proved (equality allowed); else the verdict of `absolutely_stable`, which refutes by a
        wave with a passive termination at one port
    """
    b_m, b_s, k, late = master_damping, slave_damping, stiffness, delay
    statement = (
        f"the teleoperator with dampings {decimal(b_m)}, {decimal(b_s)} N s/m, spring "
        f"{decimal(k)} N/m and delay {decimal(late)} s each way is absolutely stable"
    )
    margin = b_m * b_s - (k * late) ** 2
    if min(b_m, b_s) < 0 or margin < 0:
        master, slave = master_inertia * S + b_m, slave_inertia * S + b_s
        coupled = teleoperator_two_port(
            master=master, slave=slave, stiffness=k, damping=0, delay=late
        )
        return Claim(statement, absolutely_stable(coupled).verdict)
    method = (
        "Llewellyn's criterion with the exact delay, b_m b_s >= (P T)^2, and residues at s = 0 "
        "that meet it with equality"
    )
    made = certificate("late_coupling", b_m=b_m, b_s=b_s, P=k, T=late)
    equality = "for w -> 0" if margin == 0 else ""
    return Claim(statement, Proof(method, (made,), float(margin), "(N s/m)^2", equality))
