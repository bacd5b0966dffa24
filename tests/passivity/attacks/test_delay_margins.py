"""Delay margins against the modes of the late loop, by collocation of its history.

The attacker draws no response over frequency.
"""

from collections import Counter

import control as ct
import numpy as np
import scipy.linalg
import sympy as sp
from passivity.attacks.budget import attacked
from passivity.attacks.late_modes import NEAR, rightmost_of_two

from teleopdesign.errors import UnstableLoop
from teleopdesign.frequency import LoopGain, delay_margin, gain_margin
from teleopdesign.realise.lti import S


def plain_response(rng):
    """(numerator, denominator) of degree 1 to 3, strictly proper; poles that hardly decay."""
    n, poles = int(rng.integers(1, 4)), []
    while len(poles) < n:
        if n - len(poles) > 1 and rng.random() < 0.5:
            w, z = 10 ** rng.uniform(-1, 1), 10 ** rng.uniform(-3, 0)
            poles += [complex(-z * w, w), complex(-z * w, -w)]
        else:
            poles.append(-(10 ** rng.uniform(-1.5, 1.5)) * (1 if rng.random() < 0.9 else -0.1))
    below = np.real(np.poly(poles))
    m = int(rng.integers(0, n))
    zeros = -(10 ** rng.uniform(-1, 1, m)) * rng.choice([1, 1, 1, -1], m)
    gain = 10 ** rng.uniform(-1, 1.5) * abs(below[-1]) * rng.choice([1, 1, 1, -1])
    above = np.atleast_1d(np.real(np.poly(zeros)) * gain)
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

    def modes(self, further):
        """Largest real part with so much more dead time, by both grids, over the largest pole."""
        systems = [[np.asarray(m) for m in ct.ssdata(ct.tf2ss(ct.tf(*p)))] for p in self.parts]
        now = scipy.linalg.block_diag(*(a for a, *_ in systems))
        enters = np.vstack([b for _, b, *_ in systems])
        late, start = [], 0
        for k, (a, _, c, _) in enumerate(systems):
            leaves = np.zeros((1, len(now)))
            leaves[:, start : start + len(a)] = c
            start += len(a)
            more = 0.0 if self.inner and k == 1 else further
            late.append((-enters @ leaves, self.times[k] + more))
        size = np.abs(np.linalg.eigvals(now)).max()
        return rightmost_of_two(now, late) / size


def test_the_attacker_sees_a_fast_mode_of_a_long_history():
    """220 rad/s over 0.57 s: 30 points, and 60, make it grow where it decays."""
    loop = object.__new__(LateLoop)
    fast = [218.6, 12.13, -8.588], [1.0, 0.4877, 51.82, 23.11]
    loop.parts = [([0.1131, 0.8512], [1.0, 1.771, 0.7818]), fast]
    loop.times, loop.inner, loop.plain = [0.574, 0.0], False, False
    margin = delay_margin(loop.gain())
    assert (loop.modes(0.99 * margin) < NEAR).all()
    assert (loop.modes(1.01 * margin) > -NEAR).all()


@attacked(5, 150)
def test_a_late_loop_grows_from_its_delay_margin_on_and_not_before(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for _ in range(number):
        loop = LateLoop(rng)
        try:
            margin = delay_margin(loop.gain())
        except UnstableLoop:
            assert (loop.modes(0.0) > -NEAR).any(), vars(loop)
            counts["unstable"] += 1
            continue
        shares = (0.0, 0.1, 0.5, 0.9, 0.99)
        times = [share * margin for share in shares]
        if np.isinf(margin):
            times = [0.0, *10 ** rng.uniform(-2, 1, 4)]
        for time in times:
            assert (loop.modes(time) < NEAR).any(), (vars(loop), margin, time)
        if np.isfinite(margin):
            assert (loop.modes(1.01 * margin) > -NEAR).any(), (vars(loop), margin)
        counts["no limit" if np.isinf(margin) else "limit"] += 1
    print(dict(counts))
    assert counts["limit"] >= number / 10


@attacked(6, 60)
def test_a_late_loop_grows_at_its_gain_margin_and_not_before(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    while sum(counts.values()) < number:
        loop = LateLoop(rng)
        if loop.inner or loop.plain:
            continue
        try:
            margin = gain_margin(loop.gain())
        except UnstableLoop:
            counts["unstable"] += 1
            continue
        parts, near = loop.parts, []
        for share in (-1.01, -0.9, -0.5, 0.5, 0.9, 1.01):
            factor = (margin if np.isfinite(margin) else 1e6) ** share
            loop.parts = [([factor * c for c in above], below) for above, below in parts]
            if abs(share) < 1 or np.isinf(margin):
                assert (loop.modes(0.0) < NEAR).any(), (vars(loop), margin, share)
            else:
                near.append((loop.modes(0.0) > -NEAR).any())
        assert np.isinf(margin) or any(near) or margin < 1.02, (vars(loop), margin)
        counts["no limit" if np.isinf(margin) else "limit"] += 1
    print(dict(counts))
    assert counts["limit"] >= number / 10
