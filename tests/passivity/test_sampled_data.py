"""Sampled controllers: the condition of Colgate and Schenkel, exact, and the Z-width."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.base.errors import ModelError
from teleopdesign.passivity import (
    WALL_DAMPING,
    WALL_STIFFNESS,
    read_record,
    required_damping,
    sampled_coupling,
    sampled_passivity,
    write_record,
    z_width,
)
from teleopdesign.passivity.theorems.sampled_data import Z, sampled_wave

T, K, B = sp.Rational(1, 1000), 1000, sp.Rational(3, 10)
DIFFERENCE = (Z - 1) / (T * Z)

# law, spring of the body, least damping: Colgate and Schenkel 1997, and what follows from them
LIMITS = {
    "spring": (K, 0, K * T / 2),
    "spring and damper": (K + B * DIFFERENCE, 0, K * T / 2 + B),
    "spring and negative damper": (K - B * DIFFERENCE, 0, K * T / 2 + B),
    "negative damper": (-B * DIFFERENCE, 0, B),
    "spring one sample late": (K / Z, 0, 3 * K * T / 2),
    "compensator one sample late": (-500 / Z, 500, 500 * T / 2),
    "compensator two samples late": (-500 / Z**2, 500, sp.Rational(5, 8) * 500 * T),
}


@pytest.mark.parametrize("name", LIMITS)
def test_the_least_damping_is_met_exactly(name):
    """At the limit proved, equality included; 1 % of it less is refuted by a replayed motion."""
    law, spring, limit = LIMITS[name]
    assert required_damping(law, sample_time=T, stiffness=spring) == pytest.approx(float(limit))
    at = sampled_passivity(law, damping=limit, sample_time=T, stiffness=spring)
    assert at.status == "proved"
    assert at.verdict.equality
    below = limit - abs(limit) / 100
    claim = sampled_passivity(law, damping=below, sample_time=T, stiffness=spring)
    assert claim.status == "refuted"
    assert claim.record.replay() > 0


def test_a_compensator_near_rest_needs_no_damping_but_allows_none_that_drives():
    """The condition on the unit circle is met by b > -0.25 N s/m; between samples b < 0 drives."""
    assert required_damping(-500, sample_time=T, stiffness=500) == 0
    with pytest.raises(ModelError, match="damping: expected a number >= 0"):
        sampled_passivity(-500, damping=sp.Rational(-1, 5), sample_time=T, stiffness=500)


def test_a_body_on_a_negative_spring_is_refuted_without_any_law():
    claim = sampled_passivity(0, damping=1, sample_time=1, stiffness=-1)
    assert claim.status == "refuted" and claim.record.replay() > 0


def test_a_negative_spring_alone_is_never_passive():
    """The condition on the unit circle is met by any b >= 0; the pole at z = 1 refutes it."""
    assert required_damping(-500, sample_time=T) == np.inf
    assert sampled_passivity(-500, damping=100, sample_time=T).status == "refuted"
    assert sampled_passivity(-500, damping=0, sample_time=T, stiffness=500).status == "proved"
    assert sampled_passivity(-500, damping=9, sample_time=T, stiffness=499).status == "refuted"


def test_a_controller_that_is_unstable_is_refuted():
    law = 100 / (1 - sp.Rational(11, 10) / Z)
    assert sampled_passivity(law, damping=50, sample_time=T).status == "refuted"


def test_a_refuting_motion_replays_from_its_file(tmp_path):
    claim = sampled_passivity(K / Z, damping=1, sample_time=T)
    write_record(claim.record, tmp_path / "motion.json")
    assert read_record(tmp_path / "motion.json").replay() == pytest.approx(claim.record.energy)


def test_the_motion_gives_out_what_a_plain_simulation_finds():
    """Sample by sample, in a loop: held force, damping at constant speed, spring of the body."""
    late = float(T)
    claim = sampled_passivity(K + B * DIFFERENCE, damping=0.6, sample_time=T)
    position, before, energy = 0.0, 0.0, 0.0
    for d in claim.record.travel:
        force = K * position + float(B) * (position - before) / late
        energy += force * d + 0.6 * d * d / late
        position, before = position + d, position
    assert -energy == pytest.approx(claim.record.energy, rel=1e-9)


@settings(max_examples=25)
@given(
    st.integers(1, 400).map(lambda x: sp.Rational(x, 10)),
    st.integers(0, 3),
    st.lists(st.floats(-1, 1), min_size=6, max_size=30),
)
def test_no_motion_takes_energy_out_at_the_limit(stiffness, delay, travel):
    """A delayed spring with just enough damping, along any positions whatever."""
    law = stiffness / Z**delay
    b = required_damping(law, sample_time=1) * (1 + 1e-9)
    position = np.concatenate([[0.0], np.cumsum(travel)])
    late = np.concatenate([np.zeros(delay), position])[: len(position)]
    force = float(stiffness) * late[:-1]
    energy = force @ np.array(travel) + b * (np.array(travel) @ np.array(travel))
    # with the body held until the delayed force has settled nothing more flows
    assert energy >= -1e-9 * float(stiffness) * (1 + np.abs(position).max() ** 2)


def test_the_condition_over_frequency_is_that_of_the_paper():
    """b > T/2/(1 - cos wT) Re[(1 - e^-jwT) H], maximised over a fine grid of wT."""
    theta = np.linspace(1e-3, np.pi, 200001)
    z = np.exp(1j * theta)
    for law in (K + B * DIFFERENCE, K / Z + B * DIFFERENCE, (K + B * DIFFERENCE) / (2 - 1 / Z)):
        h = sp.lambdify(Z, law, "numpy")(z)
        needed = float(T) / 2 / (1 - np.cos(theta)) * ((1 - 1 / z) * h).real
        assert required_damping(law, sample_time=T) == pytest.approx(needed.max(), rel=1e-4)


def test_a_sampled_coupling_needs_the_parallel_damping():
    """b_m b_s/(b_m + b_s) >= P T/2: 2 and 2 N s/m carry 2000 N/m at 1 ms, not more."""
    arguments = {"master_damping": 2, "slave_damping": 2, "sample_time": T}
    assert sampled_coupling(2000, **arguments).status == "proved"
    assert sampled_coupling(2001, **arguments).status == "refuted"
    assert sampled_coupling(1, master_damping=0, slave_damping=9, sample_time=T).holds is False


def test_the_z_width_of_a_wall_without_delay():
    """K = 2 (b - B)/T for wall dampings from 0 to b."""
    width = z_width(damping=5.0, sample_time=1e-3, inertia=0.15, wall_damping=np.linspace(0, 4, 5))
    assert width.verified
    assert width.stiffness == pytest.approx(2 * (5 - width.wall_damping) / 1e-3, rel=1e-7)
    assert width.stiffest == pytest.approx((1e4, 0.0))
    free = 5 + 0.15 * 2j * np.pi  # m s + b at 1 Hz, and the wall beside it
    wall = abs(free + 1e4 / (2j * np.pi)) / abs(free)
    assert width.width(1.0) == pytest.approx(20 * np.log10(wall))
    assert "K (N/m)" in width.graph().y_label


def test_delay_narrows_the_z_width_and_then_some_damping_widens_it():
    """One sample late: 2 b/(3 T) without wall damping, more with some; verified exactly."""
    width = z_width(damping=5.0, sample_time=1e-3, delay=1, wall_damping=np.linspace(0, 4, 5))
    assert width.verified
    assert width.stiffness[0] == pytest.approx(2 * 5 / 3e-3, rel=1e-6)
    assert width.stiffness[1] > width.stiffness[0]


def test_a_wall_with_filtered_velocity_is_a_separate_law():
    """Any law linear in K and B; a first-order filter of the velocity."""
    a = sp.Rational(9, 10)
    law = WALL_STIFFNESS + WALL_DAMPING * (1 - a) / (1 - a / Z) * DIFFERENCE
    width = z_width(damping=5.0, sample_time=1e-3, law=law, wall_damping=np.array([0.0, 5.0, 20.0]))
    assert width.verified
    assert width.stiffness[0] == pytest.approx(1e4, rel=1e-6)


@pytest.mark.parametrize(
    ("law", "sample_time", "message"),
    [
        (sp.Symbol("K") / Z, T, "values are needed for K"),
        (Z, T, "samples of the future"),
        (sp.exp(Z), T, "rational function of z"),
        (1, 0, "sample_time"),
        (1, "soon", "finite real number"),
    ],
)
def test_wrong_input_is_one_clear_line(law, sample_time, message):
    with pytest.raises(ModelError, match=message):
        sampled_passivity(law, damping=1, sample_time=sample_time)


def test_a_wall_of_damping_alone_is_passive_up_to_that_of_the_device():
    """No stiffness is asked for, so none is too large."""
    law = WALL_DAMPING * (Z - 1) / (sp.Rational(1, 1000) * Z)
    width = z_width(damping=5, sample_time=0.001, law=law, wall_damping=np.array([0, 4.9, 5.1, 50]))
    assert np.isinf(width.stiffness[:2]).all() and np.isnan(width.stiffness[2:]).all()


@pytest.mark.parametrize(("rate", "frequency"), [(1, 0), (2, 0), (Fraction(1, 3), 0), (1, 2)])
def test_the_travel_of_a_wave_grows_by_the_bilinear_image_of_its_rate(rate, frequency):
    """(1 + s)/(1 - s) from one sample to the next; at s = 1 all of it is the last travel."""
    at = Fraction(rate), Fraction(frequency)
    wave = sampled_wave(-B * DIFFERENCE, sp.Rational(1, 10), T, sp.S(0), *at)
    assert np.isfinite(wave.travel).all() and np.abs(wave.travel).max() > 0
    one = complex(float(rate), float(frequency))
    assert wave.factor * (1 - one) == pytest.approx(1 + one) or (
        one == 1 and abs(wave.factor) > 1e9
    )
