"""Search for growing waves that take energy out of a two-port: such a wave refutes a claim.

The search starts near frequencies and rates with a negative margin, near poles, and in the open
right half plane. For a claim of stability, one port has a passive termination.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction

import numpy as np
import sympy as sp

from ...realise.lti import S
from ..linear.impedance import impedance, readable
from ..linear.positive_real import is_positive_real
from ..search.growing_wave import GrowingWave, growing_wave, halvings, wave_of
from .delayed_two_port import late_terms
from .exact_complex import Gaussian, round_point, value_at
from .growing_mode import entries_of
from .growth_points import candidates, points_near_poles, points_of_growth
from .termination import far_termination
from .two_port import TwoPort, passive_margin


def as_rational(system: TwoPort) -> sp.ImmutableMatrix:
    """Z as a matrix of rational functions of s with rational coefficients, each entry coprime.

    raises ModelError: an entry has a dead time
    """
    rows = [[system.entry(i, j).expression for j in (1, 2)] for i in (1, 2)]
    return sp.ImmutableMatrix(rows)


def select_fastest(waves: Iterable[GrowingWave | None]) -> GrowingWave | None:
    """The wave that grows fastest relative to its frequency; None where there is no wave."""
    growing = [w for w in waves if w is not None]
    return max(growing, key=lambda w: w.rate / (w.frequency or w.rate), default=None)


def find_wave_at(z: sp.ImmutableMatrix, frequency: float) -> GrowingWave | None:
    """A growing wave at about that frequency (Hz) that releases energy; None where there is none.

    The rate of growth is halved until a wave releases energy, down to 2^-30 of the frequency: a
    margin below this share is near rounding.
    """
    w = Fraction(2 * np.pi * frequency)
    for rate in halvings(8 * w, 33):
        wave = wave_of(z, rate, w)
        if wave is not None and wave.energy > 0:
            return wave
    return None


def _place_points(system: TwoPort) -> np.ndarray:
    """Points s of the right half plane at which the search looks, 1/s, (n,)."""
    if not system.has_delay:
        return points_of_growth(entries_of(as_rational(system)))
    ratios = [t.ratio for e in system.z for t in late_terms(e) or ()]
    return np.array([*points_near_poles(ratios)])


def find_wave_between(
    system: TwoPort, frequencies: Sequence[float], rates: Sequence[float]
) -> GrowingWave | None:
    """A growing wave that takes energy out of the two ports; None where the search has no result.

    The search looks beside the frequencies (Hz) and rates (1/s), beside poles and over the right
    half plane. Points with a large share of released power and a moderate abs(s) come first.
    """
    beside = [2 * np.pi * f * (2.0**-k + 1j) for f in frequencies for k in range(33)]
    points = np.concatenate([_place_points(system), beside, rates])
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
        if (
            wave is not None
            and wave.energy > 0
            and (system.has_delay or _takes_energy_out(system, at))
        ):
            return wave
    return None


def _takes_energy_out(system: TwoPort, at: Gaussian) -> bool:
    """Whether the Hermitian part of Z at the point is not positive semidefinite, exactly."""
    z11, z12, z21, z22 = (value_at(one, at) for one in entries_of(as_rational(system)))
    if z11 is None or z12 is None or z21 is None or z22 is None:
        return False
    size = (z12[0] + z21[0]) ** 2 + (z12[1] - z21[1]) ** 2
    return z11[0] < 0 or z22[0] < 0 or 4 * z11[0] * z22[0] < size


def terminate_elsewhere(system: TwoPort) -> Iterator[tuple[str, GrowingWave]]:
    """A passive termination and a wave as of `terminate`, at points beside poles and far from them.

    Yields one pair at most.
    """
    points = _place_points(system)
    values = list(system.at(points).reshape(-1, 4).T)
    for s, second, turned in candidates(values, points)[:40]:
        far = far_termination(s, second)
        z11, z12, z21, z22 = reversed(list(system.z)) if turned else system.z
        at_port = z11 if far.clamped else z11 - z12 * z21 / (z22 + far.expression)
        wave = wave_of(sp.ImmutableMatrix([[at_port]]), *round_point(s))
        if wave is not None and wave.energy > 0:
            yield (f"{far}" if not turned else f"moved, port 1 {far}"), wave
            return


def terminate(system: TwoPort, frequency: float) -> Iterator[tuple[str, GrowingWave]]:
    """Passive terminations with which the other port releases energy, and the wave.

    frequency: where to look, Hz
    yields: the termination of port 2 in words (port 2 "moved": port 1 has it), and the wave
    """
    z = system.z
    value = system.over(np.array([frequency]))[0]
    choices: list[tuple[str, sp.Expr]] = [("clamped", z[0, 0])]
    r2, loop = value[1, 1].real, value[0, 1] * value[1, 0]
    if r2 < 0:
        choices.append(("moved, port 1 clamped", z[1, 1]))
    if r2 > 0 and loop != 0:
        reactance = (2 * r2 / (1 + np.exp(-1j * np.angle(loop))) - value[1, 1]).imag
        held = _realise_reactance(reactance, 2 * np.pi * frequency)
        at_port = z[0, 0] - z[0, 1] * z[1, 0] / (z[1, 1] + held)
        choices.append((f"held by {readable(held)} N s/m", at_port))
    for text, at_port in choices:
        if at_port.has(sp.exp):
            wave = find_wave_at(sp.ImmutableMatrix([[at_port]]), frequency)
        else:
            one = impedance(at_port)
            wave = None if is_positive_real(one) else growing_wave(one)
        if wave is not None:
            yield text, wave


def _realise_reactance(reactance: float, w: float) -> sp.Expr:
    """A mass m s or a spring k/s whose reactance at w rad/s is the given one, N s/m."""
    size = sp.Rational(Fraction(abs(reactance) * w ** (-1 if reactance > 0 else 1)))
    rounded = sp.Rational(str(Fraction(str(size)).limit_denominator(10**9)))
    return rounded * S if reactance > 0 else rounded / S
