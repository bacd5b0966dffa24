"""Certificates of every kind that the package writes, which several tests attack."""

import pytest

from teleopdesign.passivity import (
    absolutely_stable,
    any_environment,
    bounded_compensation,
    dahl_compensation,
    delayed_small_motion,
    delayed_spring,
    lugre_passivity,
    passive,
    positive_real,
    quantised_spring,
    sampled_passivity,
    teleoperator_two_port,
)
from teleopdesign.realise.lti import S

PROVED = {
    "impedance": lambda: positive_real(0.15 * S + 4 + 300 / S),
    "two-port": lambda: passive(teleoperator_two_port(master=S + 1, slave=S + 2, stiffness=10)),
    "stable two-port": lambda: absolutely_stable(
        teleoperator_two_port(master=S + 1, slave=S + 2, stiffness=10)
    ),
    "delayed coupling": lambda: delayed_spring(
        master_inertia=1, master_damping=2, slave_inertia=1, slave_damping=2, stiffness=9, delay=0.1
    ),
    "sampled": lambda: sampled_passivity(1000, damping=1, sample_time=1e-3),
    "bounded": lambda: bounded_compensation(coulomb_level=1, bound=0.9),
    "coulomb": lambda: dahl_compensation(
        coulomb_level=1, compensator_level=1, compensator_stiffness=1e4
    ),
    "presliding": lambda: dahl_compensation(
        coulomb_level=0.5,
        compensator_level=0.4,
        compensator_stiffness=1e3,
        presliding_stiffness=2e3,
        highest_level=0.7,
    ),
    "identical": lambda: dahl_compensation(
        coulomb_level=1, compensator_level=1, compensator_stiffness=1e3, presliding_stiffness=1e3
    ),
    "lugre": lambda: lugre_passivity(
        coulomb_level=0.5,
        static_level=0.6,
        stiffness=1e5,
        bristle_damping=20,
        viscous_damping=4,
        stribeck_velocity=0.005,
    ),
    "motor": lambda: any_environment(
        motor_level=1,
        link_level=2,
        transmission_stiffness=1e4,
        compensator_level=0.9,
        compensator_stiffness=1e4,
    ),
    "quantised": lambda: quantised_spring(
        stiffness=1000, damping=4, sample_time=1e-3, step=1e-4, coulomb_level=0.2
    ),
    "late": lambda: delayed_small_motion(
        damping=2, compensator_stiffness=5e3, delay=1e-3, presliding_stiffness=1e4
    ),
}


@pytest.fixture(scope="session")
def certificates():
    """Each certificate of the claims above, by name."""
    return {
        f"{name} {k}": certificate
        for name, claim in PROVED.items()
        for k, certificate in enumerate(claim().certificates)
    }


@pytest.fixture(scope="session")
def genuine(certificates):
    """The same as plain data."""
    return [dict(c.content) for c in certificates.values()]
