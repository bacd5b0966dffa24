"""How much friction may be cancelled: Coulomb, presliding, changing level, LuGre."""

import math

import numpy as np
import pytest
import sympy as sp

from teleopdesign.passivity import (
    dahl_compensation,
    largest_passive_level,
    lugre_passivity,
    onset_amplitude,
    read_record,
    region,
    self_motion_speed,
    write_record,
)
from teleopdesign.passivity.rate_independent import (
    Dahl,
    dahl_loss,
    symmetric_cycle,
)


def compensated(level, stiffness=1e4, **true):
    """True friction of 1 N, unless said otherwise."""
    arguments = {"coulomb_level": 1} | true
    return dahl_compensation(compensator_level=level, compensator_stiffness=stiffness, **arguments)


# --- cycles -----------------------------------------------------------------------------------


@pytest.mark.parametrize("u", [1e-4, 0.03, 0.7, 3.0, 40.0])
def test_the_loss_of_a_cycle_is_the_closed_form(u):
    """4 f A (1 - tanh(u)/u) from travel by travel, once the start is forgotten."""
    level, stiffness = 0.7, 2e4
    amplitude = u * level / stiffness
    cycle = symmetric_cycle(Dahl(level, stiffness), [], amplitude)
    expected = 4 * level * amplitude * (1 - math.tanh(u) / u) if u > 1e-2 else None
    loss = dahl_loss(level, stiffness, amplitude)
    if expected is not None:
        assert loss == pytest.approx(expected, rel=1e-9)
    assert cycle.energy == pytest.approx(loss, rel=1e-6)


ONSETS = {1.02: 51.0, 1.05: 21.0, 1.1: 11.0, 1.2: 6.0, 1.5: 2.985, 2.0: 1.915}


@pytest.mark.parametrize("ratio", ONSETS)
def test_the_onset_agrees_with_a_search_to_a_tenth_of_a_percent(ratio):
    """f_D (1 - tanh(u)/u) = f_C at u = sigma_D A/f_D; figures of the closed form."""
    from scipy.optimize import brentq

    stiffness = 2e4
    onset = onset_amplitude(
        coulomb_level=1, compensator_level=ratio, compensator_stiffness=stiffness
    )
    u = onset * stiffness / ratio
    exact = brentq(lambda x: ratio * (1 - math.tanh(x) / x) - 1, 0.1, 100)
    assert u == pytest.approx(exact, rel=1e-3)
    assert u == pytest.approx(ONSETS[ratio], rel=1e-3)


def test_a_soft_compensator_hides_over_compensation_until_motion_is_large():
    """The curve of largest level over amplitude; where it is finite, a cycle just balances."""
    for amplitude in (3e-4, 1e-3, 1e-2):
        level = largest_passive_level(coulomb_level=1, stiffness=1e4, amplitude=amplitude)
        if math.isfinite(level):
            assert dahl_loss(level, 1e4, amplitude) == pytest.approx(4 * amplitude, rel=1e-9)
    soft, stiff = (
        largest_passive_level(coulomb_level=1, stiffness=k, amplitude=1e-2) for k in (1e3, 1e5)
    )
    assert 1 < stiff < soft
    assert largest_passive_level(coulomb_level=1, stiffness=1e3, amplitude=1e-4) == math.inf


def test_viscous_damping_bounds_the_speed_of_self_motion():
    assert self_motion_speed(coulomb_level=1, compensator_level=1.5, damping=10) == 0.05
    assert self_motion_speed(coulomb_level=1, compensator_level=0.5, damping=0) == 0
    assert self_motion_speed(coulomb_level=1, compensator_level=2, damping=0) == math.inf


# --- true friction with presliding ------------------------------------------------------------


def test_the_region_is_the_wedge_of_the_formula():
    """(sigma_D/sigma_p)^2 <= f_D/f_C <= 1, at every point of a grid."""
    softness, share = np.array([0.2, 0.5, 0.9, 1.1]), np.array([0.1, 0.5, 0.85, 1.0, 1.1])
    plane = region(lambda x, y: compensated(y, 1e3 * x, presliding_stiffness=1e3), softness, share)
    expected = (softness[None, :] ** 2 <= share[:, None]) & (share[:, None] <= 1)
    assert np.array_equal(plane.status == "proved", expected)
    assert np.array_equal(plane.status == "refuted", ~expected)


def test_the_storage_function_is_the_one_in_the_documentation():
    """V >= 0, and 0 only at rest: both bristles relaxed."""
    d, p, sigma_D, sigma_p = sp.symbols("d p sigma_D sigma_p")
    claim = compensated(0.9, 1e3, presliding_stiffness=2e3)
    storage = sp.sympify(
        claim.certificates[0].content["storage"],
        locals={x.name: x for x in (d, p, sigma_D, sigma_p)},
    )
    total, softer = sigma_p + sigma_D, sigma_p - sigma_D
    expected = (total * (p**2 / sigma_p + d**2 / sigma_D) / 2 - 2 * p * d) / softer
    assert sp.simplify(storage - expected) == 0


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
