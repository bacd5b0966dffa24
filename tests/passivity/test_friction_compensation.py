"""How much friction may be cancelled: Coulomb, presliding, changing level, LuGre."""

import numpy as np
import pytest

from teleopdesign.passivity import (
    dahl_compensation,
    lugre_passivity,
    read_record,
    region,
    write_record,
)


def compensated(level, stiffness=1e4, **true):
    """True friction of 1 N, unless said otherwise."""
    arguments = {"coulomb_level": 1} | true
    return dahl_compensation(compensator_level=level, compensator_stiffness=stiffness, **arguments)


# --- true friction with presliding ------------------------------------------------------------


def test_the_region_is_the_wedge_of_the_formula():
    """(sigma_D/sigma_p)^2 <= f_D/f_C <= 1, at every point of a grid."""
    softness, share = np.array([0.2, 0.5, 0.9, 1.1]), np.array([0.1, 0.5, 0.85, 1.0, 1.1])
    plane = region(lambda x, y: compensated(y, 1e3 * x, presliding_stiffness=1e3), softness, share)
    expected = (softness[None, :] ** 2 <= share[:, None]) & (share[:, None] <= 1)
    assert np.array_equal(plane.status == "proved", expected)
    assert np.array_equal(plane.status == "refuted", ~expected)


# --- LuGre ------------------------------------------------------------------------------------


def lugre(viscous):
    return lugre_passivity(
        coulomb_level=0.5,
        static_level=0.6,
        stiffness=1e5,
        bristle_damping=20,
        viscous_damping=viscous,
        stribeck_velocity=0.005,
    )


def test_the_refutation_of_lugre_is_a_solution_of_its_equation(tmp_path):
    """The last round once more with small steps of the equation itself."""
    record = lugre(0.4).record
    write_record(record, tmp_path / "motion.json")
    assert read_record(tmp_path / "motion.json").replay() == pytest.approx(record.energy)
    y, given_out = 0.0, 0.0
    s1, s2 = record.dampings
    for _ in range(record.rounds):
        given_out = 0.0
        for velocity, travel in record.legs:
            n = 4000
            dt = travel / abs(velocity) / n
            for _ in range(n):
                rate = record.stiffness * (velocity - abs(velocity) * y / record.level(velocity))
                middle = y + rate * dt / 2
                rate = record.stiffness * (
                    velocity - abs(velocity) * middle / record.level(velocity)
                )
                force = middle + s1 * rate / record.stiffness + s2 * velocity
                given_out -= force * velocity * dt
                y += rate * dt
    assert given_out == pytest.approx(record.energy, rel=1e-3)
