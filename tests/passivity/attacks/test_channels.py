"""Claims on channels of waves: power at both ends over random waves and delays, summed by time."""

from collections import Counter

import numpy as np
from passivity.attacks.budget import attacked, near

from teleopdesign.passivity import wave_channel

STEPS = 6000


def least_energy(rng, b, f, d, motions=40):
    """Least energy (J) that went in by any time, over the energy that was turned; T = 1 s.

    A delay T(t) grows at a rate within d, or falls, between 0.02 and 3 s; waves are zero before 0.
    """
    time = np.linspace(0, 20, STEPS)
    step, least = time[1], np.inf
    for _ in range(motions):
        waves, late = [], []
        for _ in range(2):
            wave = np.zeros(STEPS)
            for _ in range(int(rng.integers(1, 4))):
                start, span = rng.uniform(0, 6), 10 ** rng.uniform(-1, 1)
                inside = (time > start) & (time < start + span)
                wave += inside * rng.standard_normal() * np.cos(rng.uniform(0, 20) * time)
            waves.append(wave)
        for _ in range(2):
            slope = d * rng.choice([1.0, 1.0, 0.5, -1.0], STEPS // 500 + 1).repeat(500)[:STEPS]
            delay = np.clip(rng.uniform(0.02, 0.5) + np.cumsum(slope) * step, 0.02, 20)
            late.append(time - delay)
        arrived = [np.interp(t, time, w, left=0.0) for t, w in zip(late, waves, strict=True)]
        power = sum(w**2 - f**2 * a**2 for w, a in zip(waves, arrived, strict=True)) / (4 * b)
        energy = np.cumsum(power) * step
        turned = sum((w**2).sum() for w in waves) * step / (4 * b)
        least = min(least, float(energy.min() / turned))
    return least


@attacked(12, 100)
def test_no_waves_take_energy_out_of_a_channel_that_is_proved(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for _ in range(number):
        b, d = 10.0 ** rng.uniform(-6, 6), float(rng.choice([0.0, rng.uniform(0, 0.9)]))
        f = near(rng, np.sqrt(1 - d))
        claim = wave_channel(wave_impedance=b, scale=f, delay_growth=d)
        energy = least_energy(rng, b, f, d)
        # sums over steps of 3 ms of waves of 20 rad/s, with jumps at their ends
        assert not (claim.status == "proved" and energy < -0.02), (b, f, d, energy)
        counts[claim.status, energy < -0.02] += 1
    print(dict(counts))
    assert counts["proved", False] > number / 8 and counts["unknown", True] > 0
