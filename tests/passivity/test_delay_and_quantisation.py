"""Compensators that act late, and virtual springs on encoder steps."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.base.errors import ModelError
from teleopdesign.passivity import (
    delayed_small_motion,
    inertia_given_out,
    quantised_spring,
    read_record,
    released_by_delay,
    write_record,
)
from teleopdesign.passivity.rate_independent import Dahl, dahl_loss
from teleopdesign.passivity.theorems.quantised_spring import stiffest_spring

DAHL = {"level": 0.7, "stiffness": 1e4}


def given_out_by_integration(amplitude, phase, *, level, stiffness):
    """Energy per cycle of x = A sin(wt), the Dahl force being that of the position before."""
    n = 20000
    angle = 2 * np.pi * np.arange(3 * n + 1) / n
    position = amplitude * np.sin(angle - phase)
    true = amplitude * np.sin(angle)
    force, element = np.zeros(len(position)), Dahl(level, stiffness)
    here = 0.0
    for k in range(1, len(position)):
        here, _ = element.leg(here, float(position[k] - position[k - 1]))
        force[k] = here
    last = slice(2 * n, 3 * n + 1)
    return np.trapezoid(force[last], true[last])


@pytest.mark.parametrize(("u", "phase"), [(0.5, 0.3), (4.0, 0.3), (4.0, 1.5)])
def test_what_a_late_compensator_gives_out(u, phase):
    """Closed form with a modified Bessel function against integration with 2e4 steps a cycle."""
    amplitude = u * DAHL["level"] / DAHL["stiffness"]
    energy = released_by_delay(**DAHL, amplitude=amplitude, phase=phase)
    expected = given_out_by_integration(amplitude, phase, **DAHL)
    assert energy == pytest.approx(expected, rel=1e-3)


@settings(max_examples=100)
@given(st.floats(0.01, 1e3), st.floats(0, math.pi))
def test_delay_makes_a_friction_compensator_give_out_less(u, phase):
    amplitude = u * DAHL["level"] / DAHL["stiffness"]
    without = dahl_loss(DAHL["level"], DAHL["stiffness"], amplitude)
    late = released_by_delay(**DAHL, amplitude=amplitude, phase=phase)
    assert late <= without * (1 + 1e-12)


def test_a_large_motion_gives_out_that_of_coulomb_friction():
    """4 f A cos(w tau) for A far beyond the bristle, where the spring part decays as u^-1/2."""
    energy = released_by_delay(**DAHL, amplitude=1e4, phase=0.4)
    assert energy == pytest.approx(4 * 0.7 * 1e4 * math.cos(0.4), rel=1e-3)


def test_delayed_cancellation_of_inertia_always_gives_out_energy():
    for delay in (1e-6, 1e-3, 0.1):
        given_out = inertia_given_out(inertia=0.1, amplitude=0.01, frequency=2.0, delay=delay)
        w = 4 * np.pi
        t = np.linspace(0, 0.5, 20001)
        force = -0.1 * w**2 * 0.01 * np.sin(w * (t - delay))  # m x'' of the late position
        x = 0.01 * np.sin(w * t)
        assert given_out == pytest.approx(np.trapezoid(force, x), rel=1e-6)
        assert given_out > 0


@pytest.mark.parametrize(
    ("damping", "compensator", "status"),
    [
        (1.0862, 5e3, "proved"),
        (1.086, 5e3, "refuted"),
        (2.1725, 1e4, "proved"),
        (2.172, 1e4, "refuted"),
        (9, 1.1e4, "refuted"),
    ],
)
def test_small_motion_with_a_late_compensator(damping, compensator, status):
    """B >= 0.2172336 sigma_D tau (1.08617 N s/m for 5 kN/m and 1 ms), and sigma_D <= sigma_p."""
    claim = delayed_small_motion(
        damping=damping,
        compensator_stiffness=compensator,
        delay=1e-3,
        presliding_stiffness=1e4,
    )
    assert claim.status == status
    if status == "refuted":
        assert claim.record.energy > 0
        assert claim.record.replay() > 0


def test_the_constant_is_minus_the_least_value_of_sinc():
    from scipy.optimize import minimize_scalar

    from teleopdesign.passivity.theorems.delayed_compensation import SINC_LEAST

    least = minimize_scalar(lambda y: math.sin(y) / y, bounds=(4, 5), method="bounded").fun
    assert 0 < float(SINC_LEAST) + least < 1e-5


def test_real_part_of_the_impedance_over_frequency():
    """Re Z = B + sigma_D sin(w tau)/w: the sweep agrees with the verdict on both sides."""
    w = np.geomspace(1.0, 1e5, 200001)
    for damping, status in ((1.0862, "proved"), (1.086, "refuted")):
        real = damping + 5e3 * np.sin(w * 1e-3) / w
        assert (real.min() >= 0) == (status == "proved")


# --- encoder steps ----------------------------------------------------------------------------


def spring(stiffness, **changes):
    arguments = {
        "damping": 4,
        "sample_time": 1e-3,
        "step": 1e-4,
        "coulomb_level": 0.2,
    } | changes
    return quantised_spring(stiffness=stiffness, **arguments)


@pytest.mark.parametrize(
    ("stiffness", "changes", "status"),
    [
        (4000, {}, "proved"),  # 2 f_C/Delta
        (4001, {}, "refuted"),
        (8000, {"coulomb_level": 1}, "proved"),  # 2 b/T
        (8001, {"coulomb_level": 1}, "refuted"),
        (2000, {"compensator_level": 0.1}, "proved"),  # 2 (f_C - f_D)/Delta
        (2001, {"compensator_level": 0.1}, "refuted"),
        (1, {"compensator_level": 0.2}, "refuted"),  # nothing left for the steps
        (8000, {"step": 0, "coulomb_level": 0}, "proved"),
    ],
)
def test_a_quantised_spring_is_passive_up_to_its_limit(stiffness, changes, status, tmp_path):
    """K <= min(2 b/T, 2 (f_C - f_D)/Delta), equality included."""
    claim = spring(stiffness, **changes)
    assert claim.status == status
    if status == "refuted":
        write_record(claim.record, tmp_path / "motion.json")
        assert read_record(tmp_path / "motion.json").replay() > 0


@settings(max_examples=100)
@given(st.lists(st.floats(-3, 3), min_size=1, max_size=40), st.floats(-0.5, 0.5))
def test_no_motion_takes_energy_out_of_the_limiting_spring(steps, start):
    """Both limits met at once, 4000 N/m: positions in encoder steps, from any start.

    The energy put in is at least the change of K x^2/2.
    """
    k, b, late, delta, f_c = 4000.0, 2.0, 1e-3, 1e-4, 0.2
    x = delta * (start + np.concatenate([[0.0], np.cumsum(steps)]))
    force = k * delta * np.floor(x[:-1] / delta + 0.5)
    d = np.diff(x)
    put_in = np.sum(force * d + b / late * d**2 + f_c * np.abs(d))
    assert put_in - k / 2 * (x[-1] ** 2 - x[0] ** 2) >= -1e-15


def test_nothing_negative_is_accepted():
    with pytest.raises(ModelError, match="stiffness: expected a number >= 0"):
        spring(-1)


@pytest.mark.parametrize(
    ("damping", "step", "level", "compensator", "expected"),
    [
        (1.0, 1e-5, 0.5, 0.0, 2000.0),  # 2 b/T
        (100.0, 1e-5, 0.5, 0.0, 1e5),  # 2 f_C/Delta
        (100.0, 1e-5, 0.5, 0.3, 4e4),  # what the compensator leaves of it
        (100.0, 1e-5, 0.5, 0.6, 0.0),
        (100.0, 0.0, 0.5, 0.0, 2e5),  # no steps
        (0.0, 1e-5, 0.5, 0.0, 0.0),
    ],
)
def test_the_stiffest_spring_is_the_least_that_damping_and_friction_pay_for(
    damping, step, level, compensator, expected
):
    stiffest = stiffest_spring(
        damping=damping,
        sample_time=1e-3,
        step=step,
        coulomb_level=level,
        compensator_level=compensator,
    )
    assert stiffest == pytest.approx(expected)
