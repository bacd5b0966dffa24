"""The passivity controller on samples, against sums of fractions that the attacker keeps.

Below zero the energy comes only where nothing moves, or the damping that is needed is not allowed;
no damper is added where the energy stays above zero without, and none is larger than it must be.
"""

from collections import Counter
from fractions import Fraction

import numpy as np
from passivity.attacks.budget import attacked

from teleopdesign.passivity import passivity_controlled

#: of all the energy that is turned over, that rounding may leave
ROUNDING = Fraction(1, 10**13)


def random_samples(rng):
    """Velocities and forces: any, a motor that drives, one that brakes and lets go, with rests."""
    n = int(rng.integers(1, 80))
    speed, size, period = 10.0 ** rng.uniform(-6, 6, 3)
    v = rng.standard_normal(n) * 10 ** rng.uniform(-3, 1, n)
    if rng.random() < 0.5:
        v = np.cos(rng.uniform(0, 3) * np.arange(n))
    f = rng.standard_normal(n)
    if rng.random() < 0.6:
        f = -np.roll(v, int(rng.integers(0, 4))) * rng.choice([1.0, -1.0], p=[0.7, 0.3])
    v = np.where(rng.random(n) < 0.15, 0.0, v)
    largest = np.inf if rng.random() < 0.4 else float(size / speed * 10 ** rng.uniform(-3, 2))
    return v * speed, f * size, float(period), largest


@attacked(20, 800)
def test_no_samples_take_energy_out_that_a_damper_may_take_back(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for _ in range(number):
        v, f, period, largest = random_samples(rng)
        made = passivity_controlled(v, f, period=period, largest=largest)
        before, turned, kind = Fraction(0), Fraction(0), "no damper"
        for k, (speed, force) in enumerate(zip(v, f, strict=True)):
            case = (v, f, period, largest, k)
            step, damping = Fraction(period) * Fraction(speed), made.damping[k]
            without = before + step * Fraction(force)
            after = before + step * Fraction(made.force[k])
            turned += abs(after - before) + abs(step * Fraction(force))
            near = ROUNDING * turned
            assert 0 <= damping <= largest, case
            assert abs(Fraction(made.energy[k]) - after) <= near, case
            if damping == 0:
                assert without >= -near or speed == 0, case
            elif damping < largest:
                # just as much as brings it to zero
                assert without < near and abs(after) <= near, case
                kind = "damped" if kind == "no damper" else kind
            else:
                assert after <= near, case
                kind = "held back"
            before = after
        counts[kind] += 1
    print(dict(counts))
    assert min(counts[k] for k in ("no damper", "damped", "held back")) > number / 50
