"""Margins of loops that sample and hold, against the eigenvalues of one sample.

The attacker parts a sample into equal steps, of which each dead time is a whole number, and steps
the plant through them with a line of its own for the inputs on their way.
"""

from collections import Counter
from fractions import Fraction

import control as ct
import numpy as np
import scipy.linalg
from passivity.attacks.budget import attacked

from teleopdesign.frequency import sampled_margins
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
        """Largest size of an eigenvalue of one sample; further: dead time in steps."""
        systems = [ct.ssdata(ct.tf2ss(ct.tf(p, self.below))) for _, p in self.above]
        late = [steps + further for steps, _ in self.above]
        n = len(self.below) - 1
        # one realisation for all inputs: that of the transposed systems shares A and C
        a = np.asarray(systems[0][0]).T
        b = [np.asarray(c).reshape(-1, 1) if n else np.zeros((0, 1)) for _, _, c, _ in systems]
        c = np.asarray(systems[0][1]).T.reshape(1, n)
        d = [float(np.asarray(x).squeeze()) for *_, x in systems]
        line = max(late) + 1
        law = [
            np.asarray(x, dtype=float) for x in ct.ssdata(ct.tf2ss(ct.tf(*self.law, self.period)))
        ]
        m, size = len(law[0]), n + line + len(law[0])
        h = self.period / STEPS
        moves = []
        for column in b:
            block = np.zeros((n + 1, n + 1))
            block[:n, :n], block[:n, n:] = a * h, column * h
            stepped = scipy.linalg.expm(block)
            moves.append((stepped[:n, :n], stepped[:n, n:]))
        # state: plant, inputs of the last `line` steps (newest first), law
        measured = np.zeros((1, size))
        measured[:, :n] = c
        for x, steps in zip(d, late, strict=True):
            measured[0, n + steps] += x
        command = np.zeros((1, size))
        command[:, n + line :] = -factor * law[2].reshape(1, m)
        command -= factor * float(law[3].squeeze()) * measured
        after_law = np.eye(size)
        after_law[n + line :, :] = law[1].reshape(m, 1) @ measured
        after_law[n + line :, n + line :] += law[0].reshape(m, m)
        whole = np.eye(size)
        for k in range(STEPS):
            step = np.zeros((size, size))
            step[n + 1 : n + line, n : n + line - 1] = np.eye(line - 1)
            step[n + line :, n + line :] = np.eye(m)
            step[n, n] = 1.0
            first = np.eye(size)
            if k == 0:  # the computer reads, gives out, and its output begins the line
                step[n] = 0
                step[n] = command
                step[n + line :] = after_law[n + line :]
            # the input that acts in this step is that of `late` steps before, the new one first
            acts = step.copy()
            step[:n, :n] = moves[0][0] if n else 0
            for (_, move), steps in zip(moves, late, strict=True):
                if n:
                    step[:n] += move @ acts[n + steps : n + steps + 1]
            whole = step @ first @ whole
        return np.abs(np.linalg.eigvals(whole)).max()


@attacked(6, 60)
def test_a_sampled_loop_grows_from_its_margins_on_and_not_before(seed, number):
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
        gain = sampled_margins.gain_margin(loop)
        for share in (0.99, 0.6, 0.3, -0.3, -0.6, -0.99):
            factor = (gain if np.isfinite(gain) else 1e5) ** share
            assert drawn.radius(factor) < 1 + NEAR, (vars(drawn), gain, share)
        if np.isfinite(gain):
            beyond = [drawn.radius(gain**share) for share in (1.01, -1.01)]
            assert max(beyond) > 1 - NEAR or gain < 1.02, (vars(drawn), gain, beyond)
        delay = sampled_margins.delay_margin(loop)
        step = drawn.period / STEPS
        steps = min(delay / step, 12 * STEPS)
        for share in (0.25, 0.5, 0.75, 0.95):
            assert drawn.radius(further=int(share * steps)) < 1 + NEAR, (vars(drawn), delay, share)
        if np.isfinite(delay) and delay < 40 * drawn.period:
            after = [drawn.radius(further=int(np.ceil(delay / step + 1e-6)) + k) for k in (0, 1)]
            assert max(after) > 1 - NEAR, (vars(drawn), delay, after)
        counts["no delay limits" if np.isinf(delay) else "delay limits"] += 1
    print(dict(counts))
    assert counts["delay limits"] and counts["grows"]
