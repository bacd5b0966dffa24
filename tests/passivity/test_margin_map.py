"""The map of margins is the two-port of the diagram, point by point, and claims no more."""

import numpy as np
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
