"""Claims of passivity and of absolute stability of a two-port; exact where Z is rational.

With dead times the margins are computed over frequency, and poles, residues and both ends of the
axis are checked. If a check fails, the claim is refuted or unknown. If all checks pass, the claim
has evidence and no proof.
"""

from __future__ import annotations

from functools import reduce
from itertools import chain
from typing import Any

import numpy as np
import sympy as sp

from ...base.errors import ModelError
from ...derive.polynomials import halves, where_negative
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
from ..linear.family import explain_unseen
from ..linear.impedance import readable
from .delayed_two_port import obstacles
from .growing_mode import entries_of, growing_mode
from .resonances import resonances
from .two_port import TwoPort, passive_margin, stable_margin
from .waves import (
    as_rational,
    find_wave_at,
    find_wave_between,
    select_fastest,
    terminate,
    terminate_elsewhere,
)

_METHOD = (
    "Llewellyn's criterion, its inequalities for all frequencies, and the residues at poles on the "
    "axis, compared exactly"
)


def _beside_unseen(system: TwoPort, claim: Claim) -> Claim:
    """The claim; unknown if it holds while modes that no port shows do not decay."""
    if claim.holds and system.unseen:
        return Claim(claim.statement, Unknown(explain_unseen(system.unseen)))
    return claim


def passive(system: TwoPort) -> Claim:
    """Is the two-port passive: does no motion of its two ports take energy out (Raisbeck)?

    The positive-real test of the matrix decides, poles on the axis included.

    returns: proved; or refuted by a growing wave; or, with dead times, evidence over frequency;
        unknown where no proof and no wave is available, or where a mode of a system of
        python-control that no port shows does not decay
    """
    return _beside_unseen(system, _judge_passivity(system))


def _judge_passivity(system: TwoPort) -> Claim:
    statement = f"the two-port {_write_matrix(system)} is passive"
    if not system.has_delay:
        certificate = positive_real_certificate(statement, system.z.tolist())
        try:
            certificate.check()
        except ModelError:
            pass
        else:
            method = "the positive-real test of the matrix"
            return Claim(statement, Proof(method, (certificate,)))
    frequencies, margin = _find_lowest(system, passive_margin)
    hidden = obstacles(system, "passive") if system.has_delay else ()
    if margin < 0 or hidden or not system.has_delay:
        rates: list[float] = []
        if not system.has_delay:
            further, rates = _find_active_points(system)
            frequencies += further
        wave = find_wave_between(system, frequencies, rates)
        wave = wave or select_fastest(find_wave_at(system.z, f) for f in frequencies)
        if wave is not None:
            f = float(wave.frequency) / (2 * np.pi)
            return Claim(statement, Refutation(f"a growing wave at {f:.4g} Hz", wave))
        why = "; ".join(hidden) or "no certificate is accepted"
        return Claim(statement, Unknown(f"{why}; no wave that takes energy out was found"))
    return Claim(statement, Evidence(True, _describe_sweep(), margin, "N s/m"))


def absolutely_stable(system: TwoPort) -> Claim:
    """Is the two-port stable between any passive terminations (Llewellyn, residues on the axis)?

    `checker/absolute_stability.py` contains the statement and its proof.

    returns: proved; or refuted by a motion that grows by itself between the two passive
        terminations that the verdict names. With dead times: evidence over frequency, or refuted by
        a wave with which port 1 releases energy while port 2 has the termination that the verdict
        names; else unknown
    """
    statement = f"the two-port {_write_matrix(system)} is absolutely stable"
    judge = _judge_late_stability if system.has_delay else _judge_stability
    return _beside_unseen(system, Claim(statement, judge(system, statement)))


def _judge_stability(system: TwoPort, statement: str) -> Verdict:
    z = as_rational(system)
    failed = [c for c in conditions(entries_of(z)) if not c.holds]
    if not failed:
        return prove_by_certificate(
            _METHOD, lambda: absolute_stability_certificate(statement, z.tolist())
        )
    mode = growing_mode(z)
    if mode is None:
        return Unknown(f"{failed[0]}; no termination that makes it grow was found")
    first, second = mode.terminations
    method = f"{failed[0]}; port 1 {first}, port 2 {second}, it grows at {float(mode.rate):.4g} 1/s"
    if mode.frequency:
        method += f" and swings at {float(mode.frequency):.4g} rad/s"
    return Refutation(method, mode)


def _judge_late_stability(system: TwoPort, statement: str) -> Verdict:
    frequencies, margin = _find_lowest(system, stable_margin)
    hidden = obstacles(system, "absolutely stable")
    if margin >= 0 and not hidden:
        return Evidence(True, _describe_sweep(), margin, "(relative)")
    waves = {}
    for f in frequencies if margin < 0 else ():
        for held, wave in terminate(system, f):
            waves[wave] = held
    for held, wave in () if waves else terminate_elsewhere(system):
        waves[wave] = held
    best = select_fastest(waves)
    if best is not None:
        return Refutation(f"port 2 {waves[best]}, a growing wave", best)
    why = "; ".join(hidden) or "the criterion fails"
    return Unknown(f"{why}; no termination that makes it grow was found")


def is_shown_unstable(system: TwoPort) -> bool:
    """Whether `absolutely_stable` refutes the two-port.

    With dead times the search stops at the first wave, so it is faster.
    """
    if not system.has_delay:
        return isinstance(absolutely_stable(system).verdict, Refutation)
    frequencies, margin = _find_lowest(system, stable_margin)
    lowest = frequencies if margin < 0 else []
    waves = (pair for f in lowest for pair in terminate(system, f))
    return any(w.replay() > 0 < w.energy for _, w in chain(waves, terminate_elsewhere(system)))


def _write_matrix(system: TwoPort) -> str:
    rows = (", ".join(readable(e) for e in row) for row in system.z.tolist())
    return "; ".join(rows).join("[]")


def _describe_sweep() -> str:
    return (
        "margin over 4001 frequencies from 1e-4 to 1e4 Hz and across resonances, refined at the "
        "lowest; poles, residues and the ends of the axis"
    )


def _find_lowest(system: TwoPort, margin: Any) -> tuple[list[float], float]:
    """Frequencies (Hz) at which a search should look for a wave, and the smallest margin.

    The first frequency is that of the smallest margin, refined. The others are some of those with a
    negative margin, because the fastest release of energy need not be where the margin is smallest.
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


def _find_active_points(system: TwoPort) -> tuple[list[float], list[float]]:
    """Frequencies (Hz) on the axis and real rates s (1/s) at which Z + Z^H is not positive.

    They come from exact polynomials in w^2 and in s. A residue that is not Hermitian, or not
    positive, lets energy out only close to its pole, and a grid of frequencies may miss this place.
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
    axis = [x for p in _list_minors(*on_axis) for x in where_negative(halves(p)[0])]
    first, second, det = _list_minors(*plain)
    rates = [x for p in (first * below, second * below, det) for x in where_negative(p)]
    return [float(x) ** 0.5 / (2 * np.pi) for x in axis], [float(x) for x in rates]


def _list_minors(
    first: sp.Poly, second: sp.Poly, upper: sp.Poly, lower: sp.Poly
) -> tuple[sp.Poly, sp.Poly, sp.Poly]:
    """Principal minors of a 2x2 matrix of polynomials: diagonal entries and determinant."""
    return first, second, first * second - upper * lower
