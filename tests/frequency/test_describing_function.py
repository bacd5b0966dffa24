"""Describing functions: closed forms, simulation, the catalogue; an interface from them."""

import numpy as np
import pytest
import sympy as sp
from devices import body
from effects.along import NAMES, body_of, with_needs

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller, scheduled_force_feedback
from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import EFFECTS
from teleopdesign.frequency import (
    closed_forms,
    describing_function,
    measured_impedance,
)
from teleopdesign.frequency.describing_function import driven_gain

AMPLITUDE = np.array([1e-5, 1e-3, 2e-2])
#: needs the hand's force, time, another measurement, or holds its state: no describing function
WITHOUT = {
    "backlash",
    "coupling",
    "friction_drift",
    "maxwell_slip",
    "tip_friction",
    "transmission_compliance",
    "viscous_temperature",
}
WHY = (
    "depends on (interaction_force|time|temperature|other_acceleration)|rests or slips by what it "
    "is itself"
)


def number(expression):
    return complex(sp.N(expression, 30))


def test_coulomb_friction_is_four_over_pi_at_any_frequency():
    response = describing_function(
        body(0.0, coulomb__level=0.5), amplitude=AMPLITUDE, frequency=7.0
    )
    expected = [number(closed_forms.coulomb(0.5, a)) for a in AMPLITUDE]
    np.testing.assert_allclose(response, expected, rtol=1e-6)  # (pi/2000)^2/6 of the midpoint rule


@pytest.mark.parametrize("smoothing", [1e-3, 0.05, 2 * np.pi * 7.0 * 1e-3, 1.0])
def test_smoothed_coulomb_friction_has_its_closed_form(smoothing):
    """Below, at and above a = V, at 7 Hz."""
    law = controller("smoothed_coulomb", {"level": 0.5, "smoothing_velocity": smoothing})
    response = describing_function(law, amplitude=AMPLITUDE, frequency=7.0)
    speed = 2 * np.pi * 7.0 * AMPLITUDE
    expected = [
        number(closed_forms.smoothed_coulomb(0.5, sp.Float(smoothing), a, sp.Float(v)))
        for a, v in zip(AMPLITUDE, speed, strict=True)
    ]
    np.testing.assert_allclose(response, expected, rtol=1e-6)


@pytest.mark.parametrize("stiffness", [1e3, 1e5])
def test_dahl_friction_has_its_closed_form(stiffness):
    law = controller("dahl", {"level": 0.5, "stiffness": stiffness})
    response = describing_function(law, amplitude=AMPLITUDE, frequency=3.0)
    expected = [number(closed_forms.dahl(0.5, sp.Float(stiffness), sp.Float(a))) for a in AMPLITUDE]
    # second order in steps of 1/2000: 7e-5 where the bristle turns within a step, u = 4000
    np.testing.assert_allclose(response, expected, rtol=2e-4)


@pytest.mark.slow
@pytest.mark.parametrize("name", [n for n in NAMES if n not in WITHOUT])
def test_every_dissipating_effect_takes_energy_from_a_sinusoid(name):
    """What opposes motion in phase with velocity is not negative where an effect claims that."""
    made = body_of(*with_needs(name))
    response = describing_function(made, amplitude=5e-3, frequency=2.0)
    assert np.isfinite(response)
    if EFFECTS[name].energy == "dissipates":
        assert response.imag > -1e-12 * abs(response)  # springs: rounding


@pytest.mark.parametrize("name", sorted(WITHOUT))
def test_a_law_of_other_signals_has_none_and_says_so(name):
    with pytest.raises(ModelError, match=WHY):
        describing_function(body_of(*with_needs(name)), amplitude=1e-3, frequency=1.0)


#: the catalogue, four effects on a body: to compile its loop takes most of the time
TOGETHER = [n for n in NAMES if n not in WITHOUT]
TOGETHER = [TOGETHER[i::8] for i in range(8)]


@pytest.mark.slow  # Coulomb friction is in test_measured_impedance.py
@pytest.mark.parametrize("names", TOGETHER, ids=" ".join)
def test_describing_function_and_simulation_agree_for_the_catalogue(names):
    made = body_of(*dict.fromkeys(n for name in names for n in with_needs(name)))
    simulated = measured_impedance(
        haptic_interface(made), amplitude=5e-3, frequency=4.0, computer="continuous"
    )
    response = describing_function(made, amplitude=5e-3, frequency=4.0)
    # the simulated contact gives by 1e-5 of the amplitude, which turns friction by 0.4 %
    assert simulated.data["impedance"].item() == pytest.approx(response, rel=5e-3)


def test_a_scheduled_gain_depends_on_the_phase_of_what_drives_it():
    """In phase with velocity it acts where speed is high, and gain low."""
    law = scheduled_force_feedback(gain=5.0, scheduling_velocity=0.08, bandwidth=1e4)
    gain = driven_gain(law, amplitude=0.01, frequency=5.0)
    assert abs(gain(1j)) < abs(gain(1.0)) < 5.0
    # at rest the whole gain; 1e-3 m/s of 0.08 lets it fall by 1 %
    slow = driven_gain(law, amplitude=3e-5, frequency=5.0)
    assert slow(1.0) == pytest.approx(5.0, rel=0.02)
