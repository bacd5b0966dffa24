"""Passivity and absolute stability of a two-port, as claims: exact where it is rational.

With dead times the margins are computed over frequency: a negative one gives a refutation, else
there is numerical evidence and no more.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp

from ..errors import ModelError
from ..realise.lti import S
from .certificate import Certificate, positive_real_certificate
from .claim import Claim, Evidence, Proof, Refutation, Unknown
from .growing_wave import GrowingWave, growing_wave, halvings, wave_of
from .impedance import Impedance, impedance, readable
from .inequality import inequality_certificate
from .polynomials import even_part, is_hurwitz, is_non_negative
from .positive_real import is_positive_real
from .two_port import TwoPort, passive_margin, stable_margin

_EXACT = "no certificate of moderate size was found, but the exact root count (Sturm) speaks"


def passive(system: TwoPort) -> Claim:
    """Is the two-port passive: does no motion of its two ports take energy out (Raisbeck)?"""
    statement = f"the two-port {_text(system)} is passive"
    if not system.has_delay:
        certificate = positive_real_certificate(statement, system.z.tolist())
        try:
            certificate.check()
        except ModelError:
            pass
        else:
            method = "the positive-real test of the matrix"
            return Claim(statement, Proof(method, (certificate,)))
    frequencies, margin = _lowest(system, passive_margin)
    if margin < 0 or not system.has_delay:
        wave = _best(_wave_at(system.z, f) for f in frequencies) or _fast_wave(system.z)
        if wave is not None:
            f = float(wave.frequency) / (2 * np.pi)
            return Claim(statement, Refutation(f"a growing wave at {f:.6g} Hz", wave))
        return Claim(statement, Unknown("no certificate is accepted, no wave takes energy out"))
    return Claim(statement, Evidence(True, _swept(), margin, "N s/m"))


def absolutely_stable(system: TwoPort) -> Claim:
    """Do no two passive terminations make it unstable (Llewellyn)?

    A refutation is the wave that port 1 gives out energy with, port 2 held by a passive
    termination that the method names.
    """
    statement = f"the two-port {_text(system)} is absolutely stable"
    if not system.has_delay:
        lemmas = _llewellyn(system)
        if lemmas is not None:
            method = "Llewellyn's criterion, its inequalities for all frequencies"
            found = [c for c in lemmas if c is not None]
            if len(found) == len(lemmas):
                return Claim(statement, Proof(method, tuple(found)))
            return Claim(statement, Evidence(True, f"{method}: {_EXACT}", float("nan")))
    frequencies, margin = _lowest(system, stable_margin)
    if margin >= 0 and system.has_delay:
        return Claim(statement, Evidence(True, _swept(), margin, "(relative)"))
    waves = {}
    for f in frequencies:
        for held, wave in _terminated(system, f):
            waves[wave] = held
    best = _best(waves)
    if best is not None:
        return Claim(statement, Refutation(f"port 2 {waves[best]}, a growing wave", best))
    return Claim(statement, Unknown("the criterion fails, but no termination was found"))


def _text(system: TwoPort) -> str:
    rows = (", ".join(readable(e) for e in row) for row in system.z.tolist())
    return "; ".join(rows).join("[]")


def _swept() -> str:
    return "margin over 4001 frequencies from 1e-4 to 1e4 Hz, refined at the lowest"


def _lowest(system: TwoPort, margin: Any) -> tuple[list[float], float]:
    """Frequencies (Hz) at which to look for a wave, and the smallest margin, refined around it.

    The lowest one, and some of those with a negative margin: where energy comes out at a rate worth
    the name need not be where the margin is smallest.
    """
    f = np.geomspace(1e-4, 1e4, 4001)
    values = margin(system.over(f))
    negative = f[np.flatnonzero(values < 0)]
    chosen = [float(x) for x in negative[:: max(1, len(negative) // 12)]]
    for _ in range(4):
        k = int(np.nanargmin(values))
        lowest = float(f[k]), float(values[k])
        f = np.geomspace(f[max(k - 1, 0)], f[min(k + 1, len(f) - 1)], 401)
        values = margin(system.over(f))
    return [lowest[0], *chosen], lowest[1]


def _best(waves: Iterable[GrowingWave | None]) -> GrowingWave | None:
    """The wave that grows fastest against its frequency."""
    found = [w for w in waves if w is not None]
    return max(found, key=lambda w: w.rate / (w.frequency or w.rate), default=None)


def _wave_at(z: sp.ImmutableMatrix, frequency: float) -> GrowingWave | None:
    """A growing wave at about that frequency (Hz), with the fastest growth of a halving sequence.

    Down to 2^-30 of the frequency: a margin below that share is near rounding.
    """
    w = Fraction(2 * np.pi * frequency)
    for rate in halvings(8 * w, 33):
        wave = wave_of(z, rate, w)
        if wave is not None and wave.energy > 0:
            return wave
    return None


def _fast_wave(z: sp.ImmutableMatrix) -> GrowingWave | None:
    """A growing wave anywhere on a grid of the right half plane (a mode that grows by itself)."""
    for k in range(-12, 13):
        for ratio in (0, Fraction(1, 4), 1, 4, 16, 64):
            rate = Fraction(4) ** k
            wave = wave_of(z, rate, rate * ratio)
            if wave is not None and wave.energy > 0:
                return wave
    return None


def _llewellyn(system: TwoPort) -> list[Certificate | None] | None:
    """Certificates of the criterion's parts; None where it fails. None in the list: too large."""
    z11, z12, z21, z22 = (system.entry(i, j) for i in (1, 2) for j in (1, 2))
    lemmas: list[Certificate | None] = []
    for name, one in (("z11", z11), ("z22", z22), *_decaying(z12, z21)):
        if not is_positive_real(one):
            return None
        text = f"{name} = {one} is positive real"
        lemmas.append(positive_real_certificate(text, [[one.expression]]))
    if not all(is_hurwitz(sp.gcd(z.q, z.q.diff(S))) for z in (z12, z21)):
        return None  # a double pole on the axis: what passes through it grows, whatever is attached
    difference, twice = _criterion(z11, z12, z21, z22)
    for name, polynomial in (
        ("A = 2 Re z11 Re z22 - Re z12 z21 >= 0", difference),
        ("A^2 >= abs(z12 z21)^2", twice),
    ):
        if not is_non_negative(polynomial):
            return None
        claim = f"{name} at every frequency, x = w^2, denominators taken off"
        lemmas.append(inequality_certificate(claim, polynomial))
    return lemmas


def _decaying(*entries: Impedance) -> list[tuple[str, Impedance]]:
    """q'/q of the denominators: positive real iff no zero of q lies in the right half plane."""
    found = []
    for name, entry in zip(("z12", "z21"), entries, strict=True):
        q = entry.q
        if q.degree() > 0:
            text = f"q'/q of the denominator of {name}"
            found.append((text, impedance(q.diff(S).as_expr() / q.as_expr())))
    return found


def _criterion(
    z11: Impedance, z12: Impedance, z21: Impedance, z22: Impedance
) -> tuple[sp.Poly, sp.Poly]:
    """A and A^2 - abs(z12 z21)^2 in x = w^2, times squares that are never negative."""
    loop = impedance(z12.expression * z21.expression)
    r1, r2, re = (even_part(z.p, z.q) for z in (z11, z22, loop))
    d1, d2, d = (even_part(z.q, z.q) for z in (z11, z22, loop))
    product = even_part(loop.p, loop.p)
    a = 2 * r1 * r2 * d - re * d1 * d2
    square = a**2 - product * d * (d1 * d2) ** 2
    return a, square


def _terminated(system: TwoPort, frequency: float) -> Iterator[tuple[str, GrowingWave]]:
    """Passive terminations of port 2 with which port 1 gives out energy, and the wave."""
    z = system.z
    value = system.over(np.array([frequency]))[0]
    choices: list[tuple[str, sp.Expr]] = [("clamped", z[0, 0])]
    r2, loop = value[1, 1].real, value[0, 1] * value[1, 0]
    if r2 < 0:
        choices.append(("moved, port 1 clamped", z[1, 1]))
    if r2 > 0 and loop != 0:
        reactance = (2 * r2 / (1 + np.exp(-1j * np.angle(loop))) - value[1, 1]).imag
        held = _reactive(reactance, 2 * np.pi * frequency)
        seen = z[0, 0] - z[0, 1] * z[1, 0] / (z[1, 1] + held)
        choices.append((f"held by {readable(held)} N s/m", seen))
    for text, seen in choices:
        if seen.has(sp.exp):
            wave = _wave_at(sp.ImmutableMatrix([[seen]]), frequency)
        else:
            one = impedance(seen)
            wave = None if is_positive_real(one) else growing_wave(one)
        if wave is not None:
            yield text, wave


def _reactive(reactance: float, w: float) -> sp.Expr:
    """A mass m s or a spring k/s of that reactance (N s/m) at w rad/s."""
    size = sp.Rational(Fraction(abs(reactance) * w ** (-1 if reactance > 0 else 1)))
    rounded = sp.Rational(str(Fraction(str(size)).limit_denominator(10**9)))
    return rounded * S if reactance > 0 else rounded / S
