"""Certificates that several tests attack."""

import pytest

from teleopdesign.passivity import (
    any_environment,
    dahl_compensation,
    lugre_passivity,
    positive_real,
    quantised_spring,
)
from teleopdesign.realise.lti import S


@pytest.fixture(scope="session")
def genuine():
    """Certificates of every kind that the package writes, as plain data."""
    claims = [
        dahl_compensation(coulomb_level=1, compensator_level=1, compensator_stiffness=1e4),
        dahl_compensation(
            coulomb_level=0.5,
            compensator_level=0.4,
            compensator_stiffness=1e3,
            presliding_stiffness=2e3,
            highest_level=0.7,
        ),
        dahl_compensation(
            coulomb_level=1,
            compensator_level=1,
            compensator_stiffness=1e3,
            presliding_stiffness=1e3,
        ),
        lugre_passivity(
            coulomb_level=0.5,
            static_level=0.6,
            stiffness=1e5,
            bristle_damping=20,
            viscous_damping=4,
            stribeck_velocity=0.005,
        ),
        any_environment(
            motor_level=1,
            link_level=2,
            transmission_stiffness=1e4,
            compensator_level=0.9,
            compensator_stiffness=1e4,
        ),
        quantised_spring(stiffness=1000, damping=4, sample_time=1e-3, step=1e-4, coulomb_level=0.2),
        positive_real(0.15 * S + 4 + 300 / S),
        positive_real((S**2 + 3 * S + 1) / (S + 1) ** 2),
    ]
    return [dict(c.content) for claim in claims for c in claim.certificates]
