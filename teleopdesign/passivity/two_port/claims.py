"""Passivity and absolute stability of a two-port, as claims: exact where it is rational.

With dead times the margins are computed over frequency, and poles, residues and both ends of the
axis are looked at: what fails is refuted or left unknown, else there is evidence and no more.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from functools import reduce
from itertools import chain
from typing import Any

import numpy as np
import sympy as sp

from ...errors import ModelError
from ...realise.lti import S
from ..checker.absolute_stability import conditions
from ..claims.certificate import absolute_stability_certificate, positive_real_certificate
from ..claims.claim import (
    Claim,
    Evidence,
    Proof,
    Refutation,
    Unknown,
    Verdict,
    prove_by_certificate,
)
from ..linear.impedance import impedance, readable
from ..linear.polynomials import halves, where_negative
from ..linear.positive_real import is_positive_real
from ..search.growing_wave import GrowingWave, growing_wave, halvings, wave_of
from .delayed_two_port import late_terms, obstacles
from .exact_complex import Gaussian, round_point, value_at
from .growing_mode import entries_of, growing_mode
from .growth_points import candidates, points_near_poles, points_of_growth
from .resonances import resonances
from .termination import far_termination
from .two_port import TwoPort, passive_margin, stable_margin

_METHOD = (
    "Llewellyn's criterion, its inequalities for all frequencies, and the residues at poles on the "
    "axis, compared exactly"
)


def passive(system: TwoPort) -> Claim:
    """Is the two-port passive: does no motion of its two ports take energy out (Raisbeck)?

    Proved by the positive-real test of the matrix, which looks at poles on the axis as well
    """
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
    hidden = obstacles(system, "passive") if system.has_delay else ()
    if margin < 0 or hidden or not system.has_delay:
        rates: list[float] = []
        if not system.has_delay:
            further, rates = _active_points(system)
            frequencies += further
        wave = _wave_between(system, frequencies, rates)
        wave = wave or _best(_wave_at(system.z, f) for f in frequencies)
        if wave is not None:
            f = float(wave.frequency) / (2 * np.pi)
            return Claim(statement, Refutation(f"a growing wave at {f:.6g} Hz", wave))
        why = "; ".join(hidden) or "no certificate is accepted"
        return Claim(statement, Unknown(f"{why}; no wave that takes energy out was found"))
    return Claim(statement, Evidence(True, _describe_sweep(), margin, "N s/m"))


def absolutely_stable(system: TwoPort) -> Claim:
    """Is the two-port stable between any passive terminations (Llewellyn, residues on the axis)?

    What is claimed, and why it follows, stands in `checker/absolute_stability.py`. A refutation is
    a motion that grows by itself between the two passive terminations that the method names; with
    dead times it is a wave with which port 1 releases energy, port 2 held as the method says.
    """
    statement = f"the two-port {_text(system)} is absolutely stable"
    return Claim(
        statement, _late_verdict(system) if system.has_delay else _verdict(system, statement)
    )


def _verdict(system: TwoPort, statement: str) -> Verdict:
    z = _rational(system)
    failed = [c for c in conditions(entries_of(z)) if not c.holds]
    if not failed:
        return prove_by_certificate(
            _METHOD, lambda: absolute_stability_certificate(statement, z.tolist())
        )
    mode = growing_mode(z)
    if mode is None:
        return Unknown(f"{failed[0]}; no termination that makes it grow was found")
    first, second = mode.terminations
    method = f"{failed[0]}; port 1 {first}, port 2 {second}, it grows at {float(mode.rate):.6g} 1/s"
    if mode.frequency:
        method += f" and swings at {float(mode.frequency):.6g} rad/s"
    return Refutation(method, mode)


def _late_verdict(system: TwoPort) -> Verdict:
    frequencies, margin = _lowest(system, stable_margin)
    hidden = obstacles(system, "absolutely stable")
    if margin >= 0 and not hidden:
        return Evidence(True, _describe_sweep(), margin, "(relative)")
    waves = {}
    for f in frequencies if margin < 0 else ():
        for held, wave in _terminate(system, f):
            waves[wave] = held
    for held, wave in () if waves else _terminated_elsewhere(system):
        waves[wave] = held
    best = _best(waves)
    if best is not None:
        return Refutation(f"port 2 {waves[best]}, a growing wave", best)
    why = "; ".join(hidden) or "the criterion fails"
    return Unknown(f"{why}; no termination that makes it grow was found")


def is_shown_unstable(system: TwoPort) -> bool:
    """Whether `absolutely_stable` refutes it; with dead times at the first wave, not the best."""
    if not system.has_delay:
        return isinstance(absolutely_stable(system).verdict, Refutation)
    frequencies, margin = _lowest(system, stable_margin)
    lowest = frequencies if margin < 0 else []
    waves = (pair for f in lowest for pair in _terminate(system, f))
    return any(w.replay() > 0 < w.energy for _, w in chain(waves, _terminated_elsewhere(system)))


def _rational(system: TwoPort) -> sp.ImmutableMatrix:
    """Z with rational coefficients, each entry coprime."""
    rows = [[system.entry(i, j).expression for j in (1, 2)] for i in (1, 2)]
    return sp.ImmutableMatrix(rows)


def _text(system: TwoPort) -> str:
    rows = (", ".join(readable(e) for e in row) for row in system.z.tolist())
    return "; ".join(rows).join("[]")


def _describe_sweep() -> str:
    return (
        "margin over 4001 frequencies from 1e-4 to 1e4 Hz and across resonances, refined at the "
        "lowest; poles, residues and the ends of the axis"
    )


def _lowest(system: TwoPort, margin: Any) -> tuple[list[float], float]:
    """Frequencies (Hz) at which to look for a wave, and the smallest margin, refined around it.

    The lowest one, and some of those with a negative margin: where energy comes out at a rate worth
    the name need not be where the margin is smallest.
    """
    f = np.unique(np.concatenate([np.geomspace(1e-4, 1e4, 4001), resonances(system)]))
    values = margin(system.over(f))
    negative = f[np.flatnonzero(values < 0)]
    chosen = [float(x) for x in negative[:: max(1, len(negative) // 12)]]
    for _ in range(4):
        k = int(np.nanargmin(values))
        lowest = float(f[k]), float(values[k])
        f = np.geomspace(f[max(k - 1, 0)], f[min(k + 1, len(f) - 1)], 401)
        values = margin(system.over(f))
    return [lowest[0], *chosen], lowest[1]


def _active_points(system: TwoPort) -> tuple[list[float], list[float]]:
    """Where Z + Z* is not positive: frequencies (Hz) of the axis, and rates (1/s), wherever.

    From exact polynomials in w^2 and in s: a residue that is not Hermitian, or not positive, leads
    to out energy only next to its pole, below or above every frequency of a grid.
    """
    entries = [[system.entry(i, j) for j in (1, 2)] for i in (1, 2)]
    below = reduce(sp.lcm, [e.q for row in entries for e in row])
    above = [[e.p * below.quo(e.q) for e in row] for row in entries]
    mirror = sp.Poly(-S, S, domain="QQ")

    def turned(p: sp.Poly) -> sp.Poly:
        return p.compose(mirror)

    # abs(below)^2 > 0 on the axis and below^2 > 0 at a rate: numerators have the signs
    pairs = [(0, 0), (1, 1), (0, 1), (1, 0)]
    on_axis = [above[i][j] * turned(below) + turned(above[j][i]) * below for i, j in pairs]
    plain = [above[i][j] + above[j][i] for i, j in pairs]
    axis = [x for p in _minors(*on_axis) for x in where_negative(halves(p)[0])]
    first, second, det = _minors(*plain)
    rates = [x for p in (first * below, second * below, det) for x in where_negative(p)]
    return [float(x) ** 0.5 / (2 * np.pi) for x in axis], [float(x) for x in rates]


def _minors(
    first: sp.Poly, second: sp.Poly, upper: sp.Poly, lower: sp.Poly
) -> tuple[sp.Poly, sp.Poly, sp.Poly]:
    """Both diagonal entries and the determinant."""
    return first, second, first * second - upper * lower


def _best(waves: Iterable[GrowingWave | None]) -> GrowingWave | None:
    """The wave that grows fastest against its frequency."""
    growing = [w for w in waves if w is not None]
    return max(growing, key=lambda w: w.rate / (w.frequency or w.rate), default=None)


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


def _points(system: TwoPort) -> np.ndarray:
    """Points of the right half plane, (n,), beside poles and far from them."""
    if not system.has_delay:
        return points_of_growth(entries_of(_rational(system)))
    ratios = [t.ratio for e in system.z for t in late_terms(e) or ()]
    return np.array([*points_near_poles(ratios)])


def _wave_between(
    system: TwoPort, frequencies: Sequence[float], rates: Sequence[float]
) -> GrowingWave | None:
    """A growing wave beside those (Hz; 1/s), beside a pole or anywhere, the plainest of them."""
    beside = [2 * np.pi * f * (2.0**-k + 1j) for f in frequencies for k in range(33)]
    points = np.concatenate([_points(system), beside, rates])
    z = system.at(points)
    finite = np.isfinite(z).all(axis=(1, 2))
    points, z = points[finite], z[finite]
    share = passive_margin(z) / np.abs(z).max(axis=(1, 2)) * points.real / np.abs(points)
    size = np.abs(np.log(np.abs(points) / np.median(np.abs(points))))
    plainest = np.lexsort((size, np.round(share, 2)))[:20]  # of equals, neither slow nor fast ones
    strongest = np.argsort(share)[:20]  # where all are weak, the rounded shares are all alike
    for k in dict.fromkeys([*plainest, *strongest]):
        at = Fraction(points[k].real), Fraction(points[k].imag)
        wave = wave_of(system.z, *at)
        if wave is not None and wave.energy > 0 and (system.has_delay or _takes_out(system, at)):
            return wave
    return None


def _takes_out(system: TwoPort, at: Gaussian) -> bool:
    """Whether the Hermitian part of Z is not positive semidefinite there, exactly."""
    z11, z12, z21, z22 = (value_at(one, at) for one in entries_of(_rational(system)))
    if z11 is None or z12 is None or z21 is None or z22 is None:
        return False
    size = (z12[0] + z21[0]) ** 2 + (z12[1] - z21[1]) ** 2
    return z11[0] < 0 or z22[0] < 0 or 4 * z11[0] * z22[0] < size


def _terminated_elsewhere(system: TwoPort) -> Iterator[tuple[str, GrowingWave]]:
    """As `_terminate`, beside poles and in the open right half plane."""
    points = _points(system)
    values = list(system.at(points).reshape(-1, 4).T)
    for s, second, turned in candidates(values, points)[:40]:
        far = far_termination(s, second)
        z11, z12, z21, z22 = reversed(list(system.z)) if turned else system.z
        at_port = z11 if far.clamped else z11 - z12 * z21 / (z22 + far.expression)
        wave = wave_of(sp.ImmutableMatrix([[at_port]]), *round_point(s))
        if wave is not None and wave.energy > 0:
            yield (f"{far}" if not turned else f"moved, port 1 {far}"), wave
            return


def _terminate(system: TwoPort, frequency: float) -> Iterator[tuple[str, GrowingWave]]:
    """Passive terminations of port 2 with which port 1 releases energy, and the wave."""
    z = system.z
    value = system.over(np.array([frequency]))[0]
    choices: list[tuple[str, sp.Expr]] = [("clamped", z[0, 0])]
    r2, loop = value[1, 1].real, value[0, 1] * value[1, 0]
    if r2 < 0:
        choices.append(("moved, port 1 clamped", z[1, 1]))
    if r2 > 0 and loop != 0:
        reactance = (2 * r2 / (1 + np.exp(-1j * np.angle(loop))) - value[1, 1]).imag
        held = _reactive(reactance, 2 * np.pi * frequency)
        at_port = z[0, 0] - z[0, 1] * z[1, 0] / (z[1, 1] + held)
        choices.append((f"held by {readable(held)} N s/m", at_port))
    for text, at_port in choices:
        if at_port.has(sp.exp):
            wave = _wave_at(sp.ImmutableMatrix([[at_port]]), frequency)
        else:
            one = impedance(at_port)
            wave = None if is_positive_real(one) else growing_wave(one)
        if wave is not None:
            yield text, wave


def _reactive(reactance: float, w: float) -> sp.Expr:
    """A mass m s or a spring k/s of that reactance (N s/m) at w rad/s."""
    size = sp.Rational(Fraction(abs(reactance) * w ** (-1 if reactance > 0 else 1)))
    rounded = sp.Rational(str(Fraction(str(size)).limit_denominator(10**9)))
    return rounded * S if reactance > 0 else rounded / S
