"""Margins of loops that sample and hold, against the eigenvalues of one sample.

Dead times of the loops are eighths of a sample. The attacker has an own step over one sample, exact
for any dead time: a loop may grow at one dead time alone, or over a hundredth of a sample.
"""

from collections import Counter
from fractions import Fraction

import control as ct
import numpy as np
import pytest
import scipy.linalg
import sympy as sp
from passivity.attacks.budget import attacked

from teleopdesign.frequency import LoopGain, gain_margin, phase_margin, sampled_margins
from teleopdesign.frequency.sampled_loop import SampledLoop

STEPS = 8
#: of an eigenvalue's size: nearer to the circle it is undecided
NEAR = 1e-9


def plain(rng, n, proper):
    """(numerator, denominator) of that order; poles that hardly decay, at 0 or growing."""
    poles = []
    while len(poles) < n:
        if n - len(poles) > 1 and rng.random() < 0.5:
            w, z = 10 ** rng.uniform(-1, 1.3), 10 ** rng.uniform(-3, 0)
            poles += [complex(-z * w, w), complex(-z * w, -w)]
        else:
            poles.append(
                float(rng.choice([0.0, -1.0, -1.0, -1.0, 0.05])) * 10 ** rng.uniform(-1, 1)
            )
    below = np.atleast_1d(np.real(np.poly(poles)))
    m = n if proper else int(rng.integers(0, n))
    zeros = -(10 ** rng.uniform(-1, 1, m)) * rng.choice([1, 1, 1, -1], m)
    above = np.atleast_1d(np.real(np.poly(zeros))) * 10 ** rng.uniform(-1, 1.5)
    return [[float(f"{c:.4g}") for c in p] for p in (above, below)]


class Sampled:
    """A law in z, and a plant with a late share and one that is not, or later."""

    def __init__(self, rng):
        self.period = float(f"{10 ** rng.uniform(-3, 0):.2g}")
        n = int(rng.integers(0, 4))
        self.below = [1.0]
        self.above = []
        for _ in range(int(rng.integers(1, 3))):
            above, below = plain(rng, n, proper=n == 0 or rng.random() < 0.3)
            self.below = self.below if self.above else below
            self.above.append((int(rng.integers(0, 3 * STEPS)), above))
        pole = float(rng.choice([1.0, 0.0, -0.3, float(f"{rng.uniform(0, 0.99):.3g}")]))
        zero = float(f"{rng.uniform(-0.5, 0.95):.3g}")
        self.law = [[1.0, -zero], [1.0, -pole]] if rng.random() < 0.6 else [[1.0], [1.0]]

    @classmethod
    def of(cls, period, below, above, law):
        """One that is not drawn."""
        made = object.__new__(cls)
        made.period, made.below, made.above, made.law = period, below, above, law
        return made

    def loop(self):
        exact = [tuple(Fraction(repr(c)) for c in p) for p in (*self.law, self.below)]
        period = Fraction(repr(self.period))
        late = {}
        for steps, above in self.above:
            size = len(self.below)
            padded = [0.0] * (size - len(above)) + above
            old = late.get(period * steps / STEPS, (Fraction(0),) * size)
            late[period * steps / STEPS] = tuple(
                a + Fraction(repr(b)) for a, b in zip(old, padded, strict=True)
            )
        return SampledLoop(period, (exact[0], exact[1]), exact[2], tuple(sorted(late.items())))

    def radius(self, factor=1.0, further=0):
        """Largest size of an eigenvalue of one sample; further: dead time in steps, any part too.

        State: plant, the commands before this sample (newest first), law. What is `m` samples
        and a part late acts by the command of `m` samples ago, and until that part by one before.
        """
        systems = [ct.ssdata(ct.tf2ss(ct.tf(p, self.below))) for _, p in self.above]
        late = [divmod((steps + Fraction(further)) / STEPS, 1) for steps, _ in self.above]
        n, line = len(self.below) - 1, max(int(m) for m, _ in late) + 1
        # one realisation for all inputs: that of the transposed systems shares A and C
        a, c = np.asarray(systems[0][0]).T, np.asarray(systems[0][1]).T.reshape(1, n)
        law_a, law_b, law_c, law_d = (
            np.asarray(x, float) for x in ct.ssdata(ct.tf2ss(ct.tf(*self.law, self.period)))
        )
        size = n + line + len(law_a)
        measured = np.zeros((1, size))
        measured[:, :n] = c
        for (*_, d), (m, _) in zip(systems, late, strict=True):
            # what passes straight through shows the command that acts up to the reading
            measured[0, n + int(m)] += float(np.asarray(d).squeeze())
        command = -factor * float(law_d.squeeze()) * measured
        command[:, n + line :] -= factor * law_c.reshape(1, -1)
        commands = np.vstack([command, np.eye(size)[n : n + line]])
        after = np.zeros((size, size), dtype=np.result_type(factor, float))
        after[n : n + line] = commands[:line]
        after[n + line :] = law_b.reshape(-1, 1) @ measured
        after[n + line :, n + line :] += law_a
        after[:n, :n] = scipy.linalg.expm(a * self.period)
        for (*_, out, _), (m, part) in zip(systems, late, strict=True):
            column = np.asarray(out).reshape(-1, 1)
            rest, first = (_moved(a, column, self.period * float(x)) for x in (1 - part, part))
            after[:n] += rest[1] @ commands[int(m)][None]
            after[:n] += rest[0] @ first[1] @ commands[int(m) + 1][None]
        return np.abs(np.linalg.eigvals(after)).max()


def _moved(a, column, time):
    """e^(A t) and its integral times B."""
    n = len(a)
    block = np.zeros((n + 1, n + 1))
    block[:n, :n], block[:n, n:] = a * time, column * time
    stepped = scipy.linalg.expm(block)
    return stepped[:n, :n], stepped[:n, n:]


def in_steps(drawn, delay):
    return Fraction(delay) / Fraction(repr(drawn.period)) * STEPS


def before(rng, drawn, delay):
    """Dead times in steps below a margin (s): shares of it, any, and all at which what passes
    straight through comes a whole sample later, or a hair before or behind there.
    """
    most = 12 * STEPS if np.isinf(delay) else min(in_steps(drawn, delay), Fraction(12 * STEPS))
    hair = Fraction(1, 10**6)
    drawn_ones = [Fraction(float(x)) for x in rng.random(12)]
    shares = [most * x for x in (*drawn_ones, Fraction(19, 20), 1 - hair)]
    whole = [k + x for k in range(int(most) + 1) for x in (-hair, 0, hair)]
    return [x for x in (*shares, *whole) if 0 <= x <= most * (1 - hair / 2)]


def behind(drawn, delay):
    """Dead times in steps at a margin (s) and a hair behind it; an eighth that it is near to."""
    at = in_steps(drawn, delay)
    near = [Fraction(round(at))] if abs(at - round(at)) < 1e-6 else []
    return [*near, at * (1 + Fraction(1, 10**8)), at * (1 + Fraction(1, 10**6))]


@attacked(0, 6)
def test_a_sampled_loop_grows_from_its_delay_margin_on_and_not_before(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    while sum(counts.values()) < number:
        drawn = Sampled(rng)
        loop, now = drawn.loop(), drawn.radius()
        if abs(now - 1) < NEAR:
            continue
        assert loop.grows() == (now > 1), (vars(drawn), now)
        if now > 1:
            counts["grows"] += 1
            continue
        delay = sampled_margins.delay_margin(loop)
        for steps in before(rng, drawn, delay):
            assert drawn.radius(further=steps) < 1 + NEAR, (vars(drawn), delay, steps)
        if np.isfinite(delay) and delay < 40 * drawn.period:
            after = [drawn.radius(further=steps) for steps in behind(drawn, delay)]
            assert max(after) > 1 - NEAR, (vars(drawn), delay, after)
        counts["no delay limits" if np.isinf(delay) else "delay limits"] += 1
    print(dict(counts))
    assert counts["delay limits"] and counts["grows"]


@attacked(4, 15)
def test_a_sampled_loop_grows_from_its_gain_and_phase_margins_on_and_not_before(seed, number):
    """Its gain times a factor, or turned by an angle at all frequencies."""
    rng, counts = np.random.default_rng(seed), Counter()
    while sum(counts.values()) < number:
        drawn = Sampled(rng)
        if drawn.radius() > 1 - NEAR:
            counts["grows"] += 1
            continue
        loop = LoopGain(sp.S(1), "H", (), ("H",), np.inf, sampled=drawn.loop())
        gain, phase = gain_margin(loop), phase_margin(loop)
        most, turn = min(gain, 1e4), 1j * np.radians(min(phase, 180.0))
        for share in (0.3, 0.6, 0.9, 0.99, 1 - 1e-6):
            for factor in (most**share, most**-share, np.exp(share * turn), np.exp(-share * turn)):
                assert drawn.radius(factor) < 1 + NEAR, (vars(drawn), gain, phase, factor)
        for limit, ends in (
            (most == gain, (most * (1 + 1e-6), (1 - 1e-6) / most)),
            (phase < 180, np.exp(np.array([turn, -turn]) * (1 + 1e-6))),
        ):
            beyond = [drawn.radius(factor) for factor in ends]
            assert not limit or max(beyond) > 1 - NEAR, (vars(drawn), gain, phase, beyond)
        counts["limits" if most == gain else "no gain limits"] += 1
    print(dict(counts))
    assert counts["limits"] and counts["grows"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("until", "period", "below", "above", "law"),
    [
        (  # what passes straight through makes it grow from 5 to 6 eighths of a sample
            6,
            0.013,
            [1.0, 0.5168, 4.867],
            [(18, [0.3344, 0.5754, -0.299]), (11, [0.2541, 1.93, 0.7546])],
            [[1.0, -0.934], [1.0, 0.3]],
        ),
        (  # it grows from 5.955 to 6 eighths, and each sample later again
            6,
            0.67,
            [1.0, 16.49, 456.8, 0.0],
            [(18, [0.4214, 4.586, 8.7, 3.336])],
            [[1.0, 0.124], [1.0, 0.3]],
        ),
        (  # from 1.114 to 2 eighths, and each sample later again for a shorter time
            2,
            0.27,
            [1.0, 4.108, 10.5],
            [(22, [0.2428, 0.3754]), (22, [0.7581, 1.386, -0.2093])],
            [[1.0], [1.0]],
        ),
    ],
)
def test_a_loop_that_grows_over_a_part_of_a_sample_alone_has_its_margin_there(
    until, period, below, above, law
):
    drawn = Sampled.of(period, below, above, law)
    delay = sampled_margins.delay_margin(drawn.loop())
    steps = in_steps(drawn, delay)
    assert until - 1 - 1e-9 < steps < until
    assert max(drawn.radius(further=x) for x in behind(drawn, delay)) > 1 + NEAR
    assert drawn.radius(further=steps * (1 - Fraction(1, 10**6))) < 1
    assert drawn.radius(further=until) < 1
