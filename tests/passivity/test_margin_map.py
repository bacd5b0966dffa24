"""The map of margins is the two-port of the diagram, point by point, and claims no more."""

import numpy as np
import pytest
from devices import body

from teleopdesign.controllers import controller
from teleopdesign.diagrams import teleoperator
from teleopdesign.passivity import margin_map

F = np.geomspace(0.01, 100.0, 41)


def test_a_map_of_two_masses_joined_by_a_damper_has_its_closed_form_and_counts_what_is_stable():
    """D + c [1 -1; -1 1]: stable where d1 d2 + c (d1 + d2) >= 0; passive by an eigenvalue."""
    link = controller("spring_damper", {"stiffness": 100.0, "damping": 1.0})
    diagram = teleoperator(
        body(0.2, viscous__damping=1.0), body(0.3, viscous__damping=1.0), coupling=link
    )
    dampings, links = [0.5, 1.0, 3.0], [-0.6, -0.4, -0.2, 2.0]
    margins = margin_map(
        diagram, {"Z_m.viscous.damping": dampings, "P.spring_damper.damping": links}, frequency=F
    )
    stable = [[d + c * (d + 1.0) >= 0 for c in links] for d in dampings]
    np.testing.assert_array_equal(margins.data["llewellyn"].values >= 0, stable)
    least = [
        [np.linalg.eigvalsh(np.diag([d, 1.0]) + c * np.array([[1, -1], [-1, 1]]))[0] for c in links]
        for d in dampings
    ]
    np.testing.assert_allclose(margins.data["passive"].values, least, rtol=1e-6)
    assert f"not below 0 at {np.sum(stable)} of 12 points" in repr(margins)
    assert "left out" not in repr(margins)
    assert 0 < np.sum(stable) < 12 and set(np.unique(margins.data["frequency"])) <= set(F)


@pytest.mark.slow
def test_a_cancellation_of_friction_is_linear_at_the_speed_that_is_stated_and_at_rest_by_default():
    """0.5 tanh(v / 0.05) N has the slope 0.5/0.05 = 10 N s/m at rest; none at ten times that."""
    law = controller("smoothed_coulomb", {"level": 0.5, "smoothing_velocity": 0.05})
    arm = body(0.3, viscous__damping=12.0)
    spring_law = controller("spring_damper", {"stiffness": 100.0, "damping": 1.0})
    pair = teleoperator(arm, arm, coupling=spring_law, master_cancellation=law)
    names = {"Z_m.viscous.damping": [12.0, 13.0], "Z_s.viscous.damping": [12.0]}

    def lowest(**more):
        data = margin_map(pair, names, frequency=F, **more).data
        return data["passive"].values.ravel()

    at_rest = lowest()
    assert np.array_equal(at_rest, lowest(speed=0.0))
    fast = lowest(speed=0.5)
    assert (fast > at_rest).all()  # the damping that the cancellation takes off at rest
    assert np.diff(at_rest)[0] > 0.0
