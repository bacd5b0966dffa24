"""What theorems take for granted: parts that are left out, and the best of all terminations."""

import numpy as np
import pytest

from teleopdesign.passivity.search.points import _best_far
from teleopdesign.passivity.theorems.compliant_transmission import any_environment
from teleopdesign.passivity.theorems.delayed_inertia import cancelled_inertia
from teleopdesign.passivity.theorems.quantised_spring import quantised_spring
from teleopdesign.passivity.theorems.sampled_compensation import sampled_compensation
from teleopdesign.passivity.theorems.velocity_compensation import velocity_compensation
from teleopdesign.passivity.theorems.wave_channel import wave_channel

JOINT = {
    "motor_level": 0.5,
    "link_level": 0.2,
    "transmission_stiffness": 2e3,
    "compensator_level": 0.4,
    "compensator_stiffness": 1e4,
}
RUBBING = {"coulomb_level": 0.5, "compensator_level": 0.4}
SAMPLED = {**RUBBING, "compensator_stiffness": 1e4, "sample_time": 1e-3}
GRID = {"stiffness": 100.0, "damping": 1.0, "sample_time": 1e-3, "step": 1e-5}
#: theorem, its arguments, and what those that are left out mean
LEFT_OUT = {
    "a transmission without damping": (any_environment, JOINT, {"transmission_damping": 0}),
    "masses of 1 kg, which decide nothing": (
        any_environment,
        JOINT,
        {"motor_inertia": 1, "link_inertia": 1},
    ),
    "no lag of the actuator": (
        cancelled_inertia,
        {"inertia": 0.2, "damping": 2.0, "cancelled": 0.05, "delay": 1e-3},
        {"time_constant": 0},
    ),
    "no compensator": (quantised_spring, {**GRID, "coulomb_level": 0.1}, {"compensator_level": 0}),
    "no damping of the device": (sampled_compensation, SAMPLED, {"viscous_damping": 0}),
    "ideal friction": (sampled_compensation, SAMPLED, {"presliding_stiffness": None}),
    "a sign of the velocity": (velocity_compensation, RUBBING, {"smoothing_velocity": 0}),
    "friction alone": (velocity_compensation, RUBBING, {"viscous_damping": 0}),
    "in continuous time": (velocity_compensation, RUBBING, {"sample_time": None}),
    "waves as they are": (wave_channel, {"wave_impedance": 5.0}, {"scale": 1}),
    "a delay that is constant": (wave_channel, {"wave_impedance": 5.0}, {"delay_growth": 0}),
}


def content_of(claim):
    return str(claim), claim.status, [dict(c.content) for c in claim.certificates]


@pytest.mark.parametrize("name", LEFT_OUT)
def test_what_is_left_out_is_not_there(name):
    theorem, arguments, meant = LEFT_OUT[name]
    assert content_of(theorem(**arguments)) == content_of(theorem(**arguments, **meant))


@pytest.mark.parametrize("seed", range(8))
def test_a_far_termination_passes_nearly_as_much_as_any_passive_one(seed):
    """Re(L/(z22 + Z2)) over a grid of all that dampers, masses and springs can be at s."""
    rng = np.random.default_rng(seed)
    s = complex(10.0 ** rng.uniform(-3, -1), 1.0)
    loop = complex(*rng.normal(size=2))
    z22 = complex(rng.uniform(0.05, 1.0), rng.normal())
    (second,) = _best_far(np.array([loop]), np.array([z22]), np.array([s]))
    half = np.angle(s)
    # by some rounds of a search: passive within a tenth of its damping
    assert np.pi / 2 - abs(np.angle(second)) > 0.9 * (np.pi / 2 - half) or abs(second) < 1e-9
    size = 10.0 ** np.linspace(-4, 4, 400)[:, None]
    grid = size * np.exp(1j * half * np.linspace(-1, 1, 41))
    best = max((loop / (z22 + grid)).real.max(), (loop / z22).real)
    assert (loop / (z22 + second)).real > 0.9 * best
