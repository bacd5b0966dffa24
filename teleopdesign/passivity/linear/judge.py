"""Claims about a family at a point: passive at its ports, or absolutely stable between any two.

Without dead times the answer is exact: a certificate that the checker accepts, or a motion. With
dead times a margin over frequency is evidence, if every mode decays with dampers at the ports: then
(Z - 1)/(Z + 1) is analytic where Re s >= 0, and the axis decides.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any

import numpy as np
import sympy as sp

from ...base.errors import ModelError
from ...derive.effort import TooMuchEffort, bounded_effort
from ...derive.polynomials import X, as_poly, element, where_negative
from ...realise.lti import S
from ..claims.certificate import matrix_certificate
from ..claims.claim import Claim, Evidence, Proof, Refutation, Unknown, Verdict
from ..growing_mode import far_termination, growing_mode
from ..search.growing_wave import GrowingWave, wave_of
from ..search.points import candidates, near_axis, near_poles, waves_out_of
from .conditions import KINDS, axis_conditions, is_shown, stability_certificate
from .excess import damping_excess, describe_equality
from .family import Family, family_of_impedance
from .impedance import Impedance, MotionKind, impedance, readable
from .matrices import parts_of, round_point, value
from .signs import Signs
from .sweep import fails_in_a_limit, holds_at, least_over, margin_of, resonances, zeros_and_poles

_METHODS = {
    "passive": "the positive-real test of the matrix",
    "absolutely stable": "Llewellyn's criterion, its inequalities for all frequencies, and the "
    "residues at poles on the axis, compared exactly",
}
#: Hz: least range of a sweep, and its frequencies in a decade; those across resonances are added
_SWEEP, _IN_A_DECADE = (1e-4, 1e4), 500
#: times the fastest mode, or the rate of the shortest dead time, up to which a sweep goes
_BEYOND = 30.0
_SWEPT = (
    "margin over {} frequencies from {:g} to {:g} Hz and across resonances, refined at the "
    "lowest; every mode with dampers at the ports, the ends of the axis and its poles"
)
#: relative change of a coefficient that may be rounding: some operations on floats, 2^-53 each
NEARBY = 2.0**-50
#: the reason of an unknown claim, where the test fails and no wave is resolved in double precision
NO_WAVE = "the positive-real test fails, but no wave that takes energy out was found"


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

        >>> import control as ct
        >>> td.positive_real(ct.tf([1, 2], [1, 3]))
        proved: Z(s) = (s + 2)/(s + 3) is passive at its port (force, velocity)
            by the positive-real test; 1 certificate; margin 0.6667 N s/m
    """
    z = impedance(system, motion=motion)
    claim = passive_claim(family_of_impedance(z))
    if (
        claim.status == "refuted"
        and not isinstance(system, Impedance)
        # floats may be rounded by earlier operations
        and (hasattr(system, "isdtime") or sp.sympify(system).atoms(sp.Float))
        and _rests_on_rounding(z, claim.record)
    ):
        why = f"it fails, but a relative change of coefficients by {NEARBY:.1g} decides: rounding"
        return Claim(claim.statement, Unknown(why))
    return claim


def _rests_on_rounding(z: Impedance, wave: Any) -> bool:
    """Whether Re Z at the wave may change its sign if each coefficient changes by NEARBY.

    To first order abs(dZ) <= NEARBY (sum abs(p_k s^k) + abs(Z) sum abs(q_k s^k))/abs(q).
    """
    assert isinstance(wave, GrowingWave)
    s, at = wave.s, complex(wave.value[0, 0])
    above, below = (
        sum(abs(float(c)) * abs(s) ** k for (k,), c in part.terms()) for part in (z.p, z.q)
    )
    size = abs(complex(*map(float, parts_of(value(element(z.q), (wave.rate, wave.frequency))))))
    return bool(abs(at.real) * size <= NEARBY * (above + abs(at) * below))


def passive_claim(family: Family) -> Claim:
    """Is a device passive: does no motion of all its ports at once take energy out?

    returns: proved, refuted by a growing wave, unknown, or evidence over frequency (dead times)
    """
    shown = _write_out(family)
    statement = {
        1: f"Z(s) = {shown} is passive at its port (force, velocity)",
        2: f"the two-port [{shown}] is passive",
    }.get(family.size, f"the {family.size} ports of [{shown}] are passive together")
    return _judge(family, "passive", statement)


def stable_claim(family: Family) -> Claim:
    """Is a two-port stable between any passive terminations?

    returns: proved; refuted by a motion that grows between two terminations that the verdict names,
        or, with dead times, by a wave with which one port releases energy while the other has the
        termination that the verdict names; evidence over frequency (with dead times); or unknown
    """
    statement = f"the two-port [{_write_out(family)}] is absolutely stable"
    return _judge(family, "absolutely stable", statement)


def _write_out(family: Family) -> str:
    rows = (family.z if family.written is None else family.written).tolist()
    return "; ".join(", ".join(map(readable, row)) for row in rows)


def _judge(family: Family, claim: str, statement: str) -> Claim:
    try:
        with bounded_effort():
            if family.times:
                verdict = _judge_late(family, claim)
            else:
                verdict = prove(family, claim, statement) or _refute(family, claim)
    except TooMuchEffort as problem:
        return Claim(statement, Unknown(str(problem)))
    if verdict.holds and (modes := family.unseen or (family.hides and family.undecayed)):
        return Claim(statement, Unknown(_explain_unseen(modes)))
    return Claim(statement, verdict)


def prove(family: Family, claim: str, title: str) -> Proof | Evidence | None:
    """The proof of a claim without dead times and values, exactly; None where it does not hold.

    title: of the certificate
    returns: exact evidence where a certificate would ask for more work than its checker does
    """
    rows = family.z.tolist()
    if claim == "passive" and family.written is not None:
        rows = family.written.tolist()
    method, margin, unit, equality = _METHODS[claim], float("nan"), "", ""
    try:
        certificate = matrix_certificate(title, rows, KINDS[claim])
        certificate.check()
    except (ModelError, ValueError):  # Python writes no integers of more than 4300 digits
        certificate = None
        if not is_shown(Signs(()), family, claim):
            return None
    if family.size == 1:
        excess = damping_excess(family.impedance)
        method, margin, unit = "the positive-real test", float(excess.lower), "N s/m"
        equality = describe_equality(family.impedance, excess)
    if certificate is None:
        why = "a certificate would ask for more work than its checker does"
        return Evidence(True, f"{method}: decided in exact arithmetic; {why}", margin, unit)
    certificates = [certificate]
    if family.hides and not family.undecayed:
        more = "every mode decays with dampers at the ports"
        certificates.append(stability_certificate(more, family.held))
    return Proof(method, tuple(certificates), margin, unit, equality)


def _refute(family: Family, claim: str) -> Verdict:
    if claim == "passive":
        return _refute_by_wave(family, (), NO_WAVE)
    why = _describe_failure(family)
    mode = growing_mode(family)
    if mode is None:
        return Unknown(f"{why}; no termination that makes it grow was found")
    first, second = mode.terminations
    method = f"{why}; port 1 {first}, port 2 {second}, it grows at {float(mode.rate):.4g} 1/s"
    if mode.frequency:
        method += f" and swings at {float(mode.frequency):.4g} rad/s"
    return Refutation(method, mode)


def _refute_by_wave(family: Family, frequencies: Sequence[float], why: str) -> Verdict:
    """The first wave that takes energy out; why: what an unknown claim says."""
    wave = next(waves_out_of(family, frequencies), None)
    return Refutation(_describe_wave(wave), wave) if wave else Unknown(why)


def _describe_wave(wave: GrowingWave) -> str:
    a, w = float(wave.rate), float(wave.frequency)
    if len(wave.velocity) > 1 or wave.impedance.has(sp.exp):
        return f"a growing wave at {w / (2 * np.pi):.4g} Hz"
    value = wave.value[0, 0].real
    return f"Re Z = {value:.4g} N s/m at s = {a:.4g} + {w:.4g} j, a growing wave"


def _describe_failure(family: Family) -> str:
    """Words for the condition of absolute stability that fails."""
    names = ("Re z11 < 0", "Re z22 < 0", *["Llewellyn's inequality fails"] * 2)
    tests = axis_conditions(family.n, family.d, "absolutely stable")
    for name, p in zip(names, tests, strict=True):
        if places := where_negative(as_poly(p, X)):
            return f"{name} beside {float(min(places)) ** 0.5:.4g} rad/s"
    return "a mode does not decay between dampers"


def _judge_late(family: Family, claim: str) -> Verdict:
    """With dead times: evidence, a motion, or unknown."""
    margin = margin_of(claim)
    swept = _sweep(family)
    grid = np.unique(np.concatenate([swept, resonances(family)]))
    lowest, least, values = least_over(
        lambda f: margin(family.at(2j * np.pi * f)), grid, rounds=3, points=401
    )
    negative = grid[np.flatnonzero(values < 0)]
    frequencies = [lowest, *map(float, negative[:: max(1, len(negative) // 12)])]
    unit = "N s/m" if claim == "passive" else "(relative)"
    if least < 0 and all(holds_at(family, f, claim) for f in frequencies):
        least = 0.0  # what is below zero there is rounding
    why = "the inequality fails" if least < 0 else ""
    try:
        if not why and family.undecayed:
            why = "with its dead times a mode does not decay between dampers"
    except ModelError as problem:
        why = str(problem)
    if not why and (ends := fails_in_a_limit(family, claim)):
        why, frequencies = f"the inequality fails {ends[0]}", [*frequencies, ends[1]]
    if not why:
        return Evidence(True, _SWEPT.format(len(swept), swept[0], swept[-1]), least, unit)
    if claim == "passive":
        why = f"{why}; no wave that takes energy out was found"
        return _refute_by_wave(family, frequencies, why)
    held = dict(islice(_terminated_waves(family, frequencies), 3))
    if held:
        wave = max(held, key=lambda w: w.rate / (w.frequency or w.rate))  # the plainest
        return Refutation(f"port 2 {held[wave]}, a growing wave", wave)
    return Unknown(f"{why}; no termination that makes it grow was found")


def _sweep(family: Family) -> np.ndarray:
    """Frequencies (Hz) of a sweep: over the usual range, and that of modes and dead times."""
    times = [float(t) for t in family.times.values() if not t.free_symbols]
    _, poles = zeros_and_poles(family)
    rates = np.concatenate([np.abs(poles), [1.0 / t for t in times if t > 0]]) / (2 * np.pi)
    rates = rates[(rates > 0) & np.isfinite(rates)]
    low = min(_SWEEP[0], *(rates / _BEYOND)) if len(rates) else _SWEEP[0]
    high = max(_SWEEP[1], *(rates * _BEYOND)) if len(rates) else _SWEEP[1]
    return np.geomspace(low, high, round(_IN_A_DECADE * np.log10(high / low)) + 1)


def _terminated_waves(
    family: Family, frequencies: Sequence[float]
) -> Iterator[tuple[GrowingWave, str]]:
    """Waves that take energy out of one port while the other has a passive termination, in words.

    Port 2 "moved": port 1 has the termination.
    """
    points = np.concatenate([near_poles(family), near_axis(frequencies, range(1, 34))])
    for s, second, turned in candidates(family, points):
        far = far_termination(s, second)
        z11, z12, z21, z22 = reversed(list(family.z)) if turned else family.z
        at_port = z11 if far.clamped else z11 - z12 * z21 / (z22 + far.at(S, sp.Rational))
        wave = wave_of(sp.ImmutableMatrix([[at_port]]), *round_point(s))
        if wave is not None and wave.energy > 0:
            yield wave, f"moved, port 1 {far}" if turned else f"{far}"


def _explain_unseen(modes: Sequence[complex]) -> str:
    """The reason of an unknown claim beside modes that no port shows and that do not decay, 1/s."""
    start = "from rest its impedance is that of a passive port, but"
    if any(np.isnan(m) for m in modes):
        return f"{start} with its dead times a mode that no port shows is not shown to decay"
    shown = ", ".join(f"{m.real:.4g}{f' +- {m.imag:.4g}j' * bool(m.imag)}" for m in modes)
    number = "a mode that no port shows does" if len(modes) == 1 else "modes that no port shows do"
    return f"{start} {number} not decay, at s = {shown} 1/s"
