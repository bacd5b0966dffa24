"""Over a short travel a constant torque may be gravity, and the answer says so."""

import numpy as np
import pytest

import teleopdesign as td

BIAS, NOISE = 0.03, 3e-3  # N*m


def joint(travel):
    """8 s of a joint with a constant torque, exact but for the noise of the torque."""
    t = np.arange(0, 8, 0.004)
    parts = [(0.7, 2.1), (0.2, 7.3), (0.1, 17.0)]  # of the travel, rad/s
    q = travel * sum(a * np.sin(w * t) for a, w in parts)
    v = travel * sum(a * w * np.cos(w * t) for a, w in parts)
    acceleration = -travel * sum(a * w**2 * np.sin(w * t) for a, w in parts)
    torque = 0.004 * acceleration + 0.02 * v + BIAS
    noise = NOISE * np.random.default_rng(1).standard_normal(len(t))
    return td.experiment(
        {"t": t, "q": q, "u": torque + noise},
        axis="revolute", position="q", actuator_force="u", inertia=0.004,
        effects=("viscous",),
    )  # fmt: skip


@pytest.mark.parametrize(("travel", "alike"), [(0.05, [("bias", "gravity")]), (1.5, [])])
def test_gravity_is_listed_where_the_travel_does_not_show_the_difference(travel, alike):
    diagnosis = td.find_missing(joint(travel), among=["bias", "gravity"])
    assert [c.effect.name for c in diagnosis.missing] == ["bias"]
    groups = [tuple(c.effect.name for c in group) for group in diagnosis.indistinguishable]
    assert groups == alike
    assert len(diagnosis.undetermined) == len(alike)
