"""Delay and gain margins against a count of the modes of the late loop that grow."""

from collections import Counter

import control as ct
import numpy as np
import pytest
import scipy.linalg
import scipy.special
import sympy as sp
from passivity.attacks.budget import attacked
from passivity.attacks.late_modes import count_growing

from teleopdesign.base.errors import ModelError, UnstableLoop
from teleopdesign.frequency import LoopGain, delay_margin, gain_margin, phase_margin
from teleopdesign.realise.lti import S


def plain_response(rng):
    """(numerator, denominator) of degree 1 to 3, strictly proper; poles that hardly decay.

    One in four is up to 300 times as fast as the others, so that it ripples with a dead time.
    """
    n, poles = int(rng.integers(1, 4)), []
    while len(poles) < n:
        if n - len(poles) > 1 and rng.random() < 0.5:
            w, z = 10 ** rng.uniform(-1, 1), 10 ** rng.uniform(-3, 0)
            poles += [complex(-z * w, w), complex(-z * w, -w)]
        else:
            poles.append(-(10 ** rng.uniform(-1.5, 1.5)) * (1 if rng.random() < 0.9 else -0.1))
    speed = 10 ** rng.uniform(0, 2.5) if rng.random() < 0.25 else 1.0
    below = np.real(np.poly(np.multiply(speed, poles)))
    m = int(rng.integers(0, n))
    zeros = -speed * (10 ** rng.uniform(-1, 1, m)) * rng.choice([1, 1, 1, -1], m)
    gain = 10 ** rng.uniform(-1, 1.5) * abs(below[-1]) * rng.choice([1, 1, 1, -1])
    above = np.atleast_1d(np.real(np.poly(zeros)) * gain / speed**m)
    return tuple([float(f"{c:.4g}") for c in p] for p in (above, below))


class LateLoop:
    """One or two responses, each late: their sum, or the second fed back round the first."""

    def __init__(self, rng):
        self.parts = [plain_response(rng) for _ in range(int(rng.integers(1, 3)))]
        self.times = [
            float(f"{10 ** rng.uniform(-2, 0.7):.3g}") * (rng.random() < 0.6) for _ in self.parts
        ]
        self.inner = bool(rng.random() < 0.35 and len(self.parts) == 2)
        self.plain = bool(len(self.parts) == 1 and not self.times[0] and rng.random() < 0.5)

    def gain(self):
        if self.plain:
            return ct.tf(*self.parts[0])
        terms = []
        for sides, t in zip(self.parts, self.times, strict=True):
            p, q = (sp.Poly([sp.Rational(repr(c)) for c in side], S).as_expr() for side in sides)
            terms.append(p / q * sp.exp(-S * sp.Rational(repr(t))))
        whole = terms[0] / (1 + terms[1]) if self.inner else sp.Add(*terms)
        return LoopGain(whole, "H", (), (), np.inf)

    def growing(self, further=0.0, factor=1.0):
        """How many modes grow with so much more dead time, and its gain by a factor; None: one is
        about on the axis.
        """
        (p, q), late = self.parts[0], self.times[0] + further
        p = np.multiply(factor, p)
        if len(self.parts) == 1:
            return count_growing([(q, 0.0), (p, late)])
        (b, c), more = self.parts[1], self.times[1] + (0.0 if self.inner else further)
        b = np.multiply(1.0 if self.inner else factor, b)
        return count_growing(
            [(np.polymul(q, c), 0.0), (np.polymul(p, c), late), (np.polymul(q, b), more)]
        )

    @classmethod
    def of(cls, parts, times):
        """One that is not drawn."""
        loop = object.__new__(cls)
        loop.parts, loop.times, loop.inner, loop.plain = parts, times, False, False
        return loop


FAST = LateLoop.of(  # 220 rad/s over 0.57 s: 30 points of a history make it grow where it decays
    [
        ([0.1131, 0.8512], [1.0, 1.771, 0.7818]),
        ([218.6, 12.13, -8.588], [1.0, 0.4877, 51.82, 23.11]),
    ],
    [0.574, 0.0],
)
#: 1500 rad/s over 2.5 s is on no grid of a history
FASTER = LateLoop.of([([0.1, 0.8], [1.0, 1.8, 0.8]), ([1500.0], [1.0, 0.5])], [2.5, 0.0])


@pytest.mark.parametrize("loop", [FAST, FASTER])
def test_the_attacker_sees_a_fast_mode_of_a_long_history(loop):
    margin = delay_margin(loop.gain())
    assert loop.growing((1 - 1e-6) * margin) == 0
    assert loop.growing((1 + 1e-6) * margin) == 2


def test_the_attacker_counts_what_grows():
    assert count_growing([([1.0, 0.0], 0.0), ([1.5], 1.0)]) == 0  # pi/2 is the limit
    assert count_growing([([1.0, 0.0], 0.0), ([1.6], 1.0)]) == 2
    assert count_growing([([1.0, -1.0], 0.0)]) == 1
    assert count_growing([([1.0, 0.0], 0.0)]) is None
    assert count_growing([([1.0, 1.0], 0.0), ([1.1, 1.0], 1.0)]) == np.inf


@pytest.mark.parametrize(("rate", "time"), [(1500.0, 2.5), (3e4, 0.01), (-0.3, 40.0)])
def test_the_attacker_counts_the_roots_that_lambert_knows(rate, time):
    """s + k e^(-s T) = 0 where s T e^(s T) = -k T: one root on each branch of the logarithm."""
    roots = scipy.special.lambertw(-rate * time, np.arange(-2000, 2001)) / time
    assert count_growing([([1.0, 0.0], 0.0), ([rate], time)]) == (roots.real > 0).sum() > 0


RIPPLES = [  # where its gain is 1, or its phase -180 degrees, for less than a step of a grid
    ([([22940.0], [1.0, 1363.0]), ([65.18], [1.0, 6.91])], [0.0, 3.79]),
    ([([-184.6, -2487.0, -3300.0], [1.0, 31.72, 260.4, 274.4]), ([2674.0], [1.0, 107.4])],
     [0.78, 0.0]),
    ([([72.44], [1.0, 5.177]), ([0.7421, -4.128], [1.0, 4.538, 5.108])], [0.0159, 4.55]),
    ([([0.003689], [1.0, 0.03548]), ([947.2], [1.0, 25.05, 146.7])], [3.98, 0.0]),
]  # fmt: skip


@pytest.mark.parametrize(("parts", "times"), RIPPLES)
def test_a_margin_lies_at_the_first_ripple_of_a_long_dead_time(parts, times):
    """A ripple is narrower than a grid of frequencies is fine."""
    loop = LateLoop.of(parts, times)
    time, factor = delay_margin(loop.gain()), min(gain_margin(loop.gain()), 100.0)
    assert not loop.growing((1 - 1e-6) * time) and loop.growing((1 + 1e-6) * time)
    for share in (1 - 1e-3, 1 - 1e-6):
        assert not loop.growing(factor=factor**share) and not loop.growing(factor=factor**-share)
    assert factor == 100.0 or loop.growing(factor=(1 + 1e-6) * factor) != 0


def margin_of(margin, loop, counts):
    """The margin; None where the loop grows as it is, or turns too often."""
    try:
        return margin(loop.gain())
    except UnstableLoop:
        assert loop.growing() != 0, vars(loop)
        counts["unstable"] += 1
    except ModelError as problem:
        assert "dead times are too long" in str(problem) or "more often than" in str(problem)
        counts["refused"] += 1
    return None


@attacked(5, 60)
def test_a_late_loop_grows_from_its_delay_margin_on_and_not_before(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for _ in range(number):
        loop = LateLoop(rng)
        margin = margin_of(delay_margin, loop, counts)
        if margin is None:
            continue
        shares = (0.0, 0.1, 0.5, 0.9, 0.99, 1 - 1e-6)
        times = [share * margin for share in shares]
        if np.isinf(margin):
            times = [0.0, *10 ** rng.uniform(-2, 1, 4)]
        for time in times:
            assert not loop.growing(time), (vars(loop), margin, time)
        if np.isfinite(margin):
            assert loop.growing((1 + 1e-6) * margin) != 0, (vars(loop), margin)
        counts["no limit" if np.isinf(margin) else "limit"] += 1
    print(dict(counts))
    assert counts["limit"] >= number / 10


@attacked(3, 25)
def test_a_late_loop_grows_at_its_gain_margin_and_not_before(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    while sum(counts.values()) < number:
        loop = LateLoop(rng)
        if loop.plain:
            continue
        margin = margin_of(gain_margin, loop, counts)
        if margin is None:
            continue
        most = margin if np.isfinite(margin) else 1e4
        for share in (0.5, 0.9, 0.99, 1 - 1e-6):
            for factor in (most**share, most**-share):
                assert not loop.growing(factor=factor), (vars(loop), margin, factor)
        beyond = [loop.growing(factor=f) != 0 for f in (most * (1 + 1e-6), (1 - 1e-6) / most)]
        assert np.isinf(margin) or any(beyond), (vars(loop), margin)
        counts["no limit" if np.isinf(margin) else "limit"] += 1
    print(dict(counts))
    assert counts["limit"] >= number / 10


@attacked(3, 25)
def test_a_late_loop_grows_at_its_phase_margin_and_not_before(seed, number):
    """Its gain is turned by an angle at all frequencies, which makes its numbers complex."""
    rng, counts = np.random.default_rng(seed), Counter()
    while sum(counts.values()) < number:
        loop = LateLoop(rng)
        if loop.plain:
            continue
        margin = margin_of(phase_margin, loop, counts)
        if margin is None:
            continue

        most = np.radians(min(margin, 180.0))

        def growing(share, most=most, loop=loop):
            return loop.growing(factor=np.exp(1j * share * most))

        for share in (0.5, 0.9, 1 - 1e-6):
            assert not growing(share) and not growing(-share), (vars(loop), margin, share)
        beyond = [growing(share) != 0 for share in (1 + 1e-6, -1 - 1e-6)]
        assert np.isinf(margin) or any(beyond), (vars(loop), margin)
        counts["no limit" if np.isinf(margin) else "limit"] += 1
    print(dict(counts))
    assert counts["limit"] >= number / 10
