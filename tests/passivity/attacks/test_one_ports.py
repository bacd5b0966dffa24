"""Claims on one port: no point of the right half plane has a negative real part where it is proved.

Z is passive if and only if it is analytic in the open right half plane with Re Z >= 0 there; beside
a pole the real part takes both signs, so that one search finds all that is wrong.
"""

from collections import Counter
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from passivity.attacks.budget import attacked
from passivity.attacks.rational import (
    KINDS,
    at,
    expression,
    plus,
    random_ratio,
    suspects,
    times,
    values,
)

from teleopdesign.passivity import damping_excess, positive_real

DIGITS = 60


def active_point(rng, ratio, certain=()):
    """s with Re s > 0 and Re Z(s) < 0, seen again to sixty digits; None where none was found."""
    s = np.concatenate([suspects(ratio, rng), np.array(certain, dtype=complex)])
    z = values(ratio, s)
    z = np.where(np.isfinite(z) & (z != 0), z, 1.0)
    share = z.real / np.abs(z)
    for k in np.argsort(share)[:12]:
        if share[k] < 1e-3 and _is_active(ratio, mpmath.mpc(s[k].real, s[k].imag)):
            return s[k]
    for point in (*_dips(ratio), *_beside_poles(ratio)):
        if _is_active(ratio, point):
            return complex(point)
    return None


def _is_active(ratio, s):
    with mpmath.workdps(DIGITS):
        try:
            return s.real > 0 > at(ratio, s).real
        except ZeroDivisionError:
            return False


def _dips(ratio):
    """Beside the frequencies at which the real part on the axis is smallest."""
    p, q = ratio
    turned = [c * (-1) ** (len(q) - 1 - k) for k, c in enumerate(q)]
    even = times(p, turned)
    even = [c if (len(even) - 1 - k) % 2 == 0 else Fraction(0) for k, c in enumerate(even)]
    slope = [c * (len(even) - 1 - k) for k, c in enumerate(even[:-1])]
    for r in np.concatenate([_float_roots(slope), _float_roots(even)]):
        w = abs(r.imag)
        if w > 0:
            for share in (1e-3, 1e-6, 1e-9, 1e-13):
                yield mpmath.mpc(w * share, w)


def _beside_poles(ratio):
    """Beside poles that no double tells from one on the axis, to sixty digits: where a residue is
    tilted by a hair, the real part is negative only nearly straight above or below the pole.
    """
    q = [mpmath.mpf(c.numerator) / c.denominator for c in ratio[1]]
    slope = [c * (len(q) - 1 - k) for k, c in enumerate(q[:-1])]
    for r in _float_roots(ratio[1]):
        if abs(r.real) > 1e-6 * abs(r):
            continue
        with mpmath.workdps(DIGITS):
            pole = mpmath.mpc(r.real, r.imag)
            for _ in range(8):  # Newton's steps; where they fail the point is just another one
                below = mpmath.polyval(slope, pole)
                pole -= mpmath.polyval(q, pole) / below if below else 0
            size = abs(pole)
            for far in range(2, 25, 3):
                for flat in range(0, 13, 2):
                    along = size * mpmath.mpf(10) ** -far
                    for turn in (1, -1):
                        yield pole + along * mpmath.mpc(mpmath.mpf(10) ** -flat, turn)


def _float_roots(p):
    p = np.trim_zeros(np.array([float(c) for c in p]))
    return np.roots(p) if len(p) > 1 and np.all(np.isfinite(p)) else np.zeros(0)


def interval_claim(rng, kind):
    ratio = random_ratio(rng, kind)
    claim = positive_real(expression(*ratio))
    point = active_point(rng, ratio)
    if claim.status == "proved":
        assert point is None, (kind, ratio, point)
        # what may be taken away by its margin leaves it passive
        margin = claim.verdict.margin
        if np.isfinite(margin):
            lower = damping_excess(expression(*ratio)).lower
            less = plus(ratio[0], [lower * c for c in ratio[1]], -1), ratio[1]
            assert active_point(rng, less) is None, (kind, ratio, margin)
    elif claim.status == "unknown":
        # the wave gives out so little that double precision does not show it: nothing is claimed
        assert "it shows nothing" in str(claim.verdict), (kind, ratio, claim)
    else:
        assert claim.status == "refuted", (kind, ratio, claim)
        wave = claim.record
        with mpmath.workdps(DIGITS):
            s = mpmath.mpc(
                *(mpmath.mpf(x.numerator) / x.denominator for x in (wave.rate, wave.frequency))
            )
            assert s.real > 0 > at(ratio, s).real, (kind, ratio)
        assert gives_out(wave) > 0, (kind, ratio)
    return claim.status, point is not None


def gives_out(wave):
    """Energy given out, J, of v = Re V e^(s t) up to t = 0, by an own quadrature of its power."""
    s, z = wave.s, wave.value
    v = np.array(wave.velocity)
    turns = min(12 / s.real * s.imag / (2 * np.pi), 200)
    span = 12 / s.real if s.imag == 0 else turns * 2 * np.pi / s.imag
    t, weight = np.polynomial.legendre.leggauss(16)
    edges = np.linspace(-span, 0, max(int(8 * turns), 40) + 1)
    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
    time = (middle[:, None] + half[:, None] * t).ravel()
    moved = np.exp(s * time)[:, None] * v
    power = (moved.real * (moved @ z.T).real).sum(axis=1).reshape(len(half), -1)
    return float(-(power @ weight) @ half)


@attacked(6, 50)
def test_no_growing_wave_gives_out_energy_where_a_port_is_proved_passive(seed, number):
    rng = np.random.default_rng(seed)
    counts = Counter(interval_claim(rng, KINDS[k % len(KINDS)]) for k in range(number))
    print(dict(counts))
    assert counts["proved", False] > number / 5
    # the attacker sees what there is to see, or its silence would say nothing
    assert counts["refuted", True] > 20 * counts["refuted", False]
    unknown = sum(n for (status, _), n in counts.items() if status == "unknown")
    assert unknown <= number / 100


@pytest.mark.parametrize("tilt", [1e-2, 1e-5, 1e-8, -1e-8])
@pytest.mark.parametrize("square", [1, Fraction(3, 7)])
def test_the_attacker_sees_a_residue_that_is_tilted_by_a_hair(tilt, square):
    """It is blind to no pole on the axis, or it would say nothing of a proof."""
    rng = np.random.default_rng(1)
    below = [Fraction(1), Fraction(0), Fraction(square)]
    tilted = [Fraction(5, 3), Fraction(tilt)], below
    ratio = plus(times(tilted[0], [1, 1]), below), times(below, [1, 1])  # + 1/(s + 1)
    assert active_point(rng, ratio) is not None
    level = plus(times([Fraction(5, 3), 0], [1, 1]), below), times(below, [1, 1])
    assert active_point(rng, level) is None
