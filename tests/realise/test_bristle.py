"""Ideal friction as a bristle: how stiff it is, and how it is damped while it sticks."""

import pytest
from devices import body

from teleopdesign.realise.simulated import with_bristle


def test_a_bristle_gives_by_its_deflection_and_is_damped_as_its_ratio_says():
    """Damping ratio: the damping over 2 sqrt(k m)."""
    stuck = with_bristle(body(0.5, coulomb__level=2.0), 1e-4, damping_ratio=0.7)
    values = {n: v.value for n, v in stuck.parameters.items()}
    assert values["presliding.stiffness"] == pytest.approx(2.0 / 1e-4)
    assert values["presliding.bristle_damping"] == pytest.approx(2 * 0.7 * (2e4 * 0.5) ** 0.5)
