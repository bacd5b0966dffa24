"""Regions of two parameters, point by point: motions, or waves, where the point is proved.

A point that stands at the wrong place of the grid is beaten there, as the axes differ in number and
in what they mean.
"""

from collections import Counter

import numpy as np
import sympy as sp
from passivity.attacks.budget import attacked, near
from passivity.attacks.test_delays import active
from passivity.attacks.test_friction import ROUNDING, dahl, gain

from teleopdesign.passivity import dahl_compensation, positive_real, region
from teleopdesign.realise.lti import S

#: points along x and along y
SHAPE = 5, 4


def compensators(rng):
    """Level and stiffness of a Dahl compensator on friction that gives; (region, x, y, judge)."""
    f_c, length = 10.0 ** rng.uniform(-6, 6, 2)
    sigma = f_c / length

    def claim(level, stiffness):
        return dahl_compensation(
            coulomb_level=f_c, compensator_level=level, compensator_stiffness=stiffness,
            presliding_stiffness=sigma,
        )  # fmt: skip

    levels = np.array([near(rng, f_c * rng.uniform(0.2, 1)) for _ in range(SHAPE[0])])
    soft = np.array([sigma * rng.uniform(0.2, 1.2) for _ in range(SHAPE[1])])

    def beaten(level, stiffness):
        lengths = [level / stiffness, f_c / sigma]
        law = dahl(level, level, stiffness)
        return gain(rng, law, dahl(f_c, f_c, sigma), level, lengths, rounds=15) > ROUNDING

    return region(claim, levels, soft), levels, soft, beaten


def low_passes(rng):
    """Damping, and a low-passed force that pushes: m s + b - k/(1 + s T)."""
    b, time = 10.0 ** rng.uniform(-6, 6, 2)
    m = float(b * time * 10 ** rng.uniform(-2, 1))
    exact = [sp.Rational(repr(float(x))) for x in (m, time)]

    def claim(damping, push):
        x, y = (sp.Rational(repr(float(v))) for v in (damping, push))
        return positive_real(exact[0] * S + x - y / (1 + S * exact[1]))

    dampings = np.array([near(rng, b) for _ in range(SHAPE[0])])
    pushes = b * 10 ** rng.uniform(-1, 0.5, SHAPE[1]) * rng.choice([1, 1, -1], SHAPE[1])

    def beaten(damping, push):
        def z(s, exp):
            return m * s + damping - push / (1 + s * time)

        return active(rng, z, [1 / time, damping / m], number=600) is not None

    return region(claim, dampings, pushes), dampings, pushes, beaten


@attacked(0, 80)
def test_no_point_of_a_region_is_beaten_where_it_is_proved(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    while sum(counts.values()) < number:
        region, x, y, beaten = (compensators, low_passes)[int(rng.integers(2))](rng)
        assert region.status.shape == region.holds.shape == SHAPE[::-1]
        np.testing.assert_array_equal(region.x, x)
        np.testing.assert_array_equal(region.y, y)
        for i, j in np.ndindex(*SHAPE[::-1]):
            status, out = region.status[i, j], beaten(float(x[j]), float(y[i]))
            assert not (status == "proved" and out), (beaten.__qualname__, x[j], y[i])
            # 1 where it holds, 0 where not, not a number where it is left open
            holds = {"proved": 1.0, "refuted": 0.0, "unknown": np.nan}[status]
            np.testing.assert_equal(region.holds[i, j], holds)
            counts[str(status), out] += 1
    print(dict(counts))
    assert counts["proved", False] and counts["refuted", True] > counts["refuted", False]
