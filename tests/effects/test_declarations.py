"""What each effect declares beside its law, written out a second time: a change is deliberate.

Bounds and starts are numbers that no law repeats. What follows from a law is held against what the
physics says of it: which laws are linear, which repeat along the way, which follow time.
"""

from dataclasses import replace
from math import inf, pi

import numpy as np
import pytest

from teleopdesign.effects import (
    BLOCK_EFFECTS,
    EFFECTS,
    Effect,
    Parameter,
    acts_linearly,
    depends_on_position,
    depends_on_time,
    period,
)

KNOWN = {**EFFECTS, **BLOCK_EFFECTS}

#: parameters that may be less than zero, or have a largest value
BOUNDS = {
    "actuation_delay.delay": (0.0, 0.2),
    "actuator_lag.time_constant": (0.0, 0.2),
    "bias.force": (-inf, inf),
    "cogging.amplitude": (-inf, inf),
    "cogging.phase": (-inf, inf),
    "cogging_harmonic.amplitude": (-inf, inf),
    "cogging_harmonic.phase": (-inf, inf),
    "contact_hardening.power": (1.0, 4.0),
    "coulomb_asymmetry.half_difference": (-inf, inf),
    "coupling.inertia": (-inf, inf),
    "environment.contact_position": (-inf, inf),
    "friction_drift.fraction": (-1.0, 1.0),
    "friction_memory.time_constant": (0.0, 2.0),
    "gravity.amplitude": (-inf, inf),
    "gravity.phase": (-inf, inf),
    "hardening_spring.neutral": (-inf, inf),
    "load_dependent_friction.driving_difference": (-1.0, 1.0),
    "load_dependent_friction.output_share": (0.0, 1.0),
    "position_dependent_friction.amplitude": (-1.0, 1.0),
    "position_dependent_friction.phase": (-inf, inf),
    "position_dependent_gain.centre": (-inf, inf),
    "shear_thinning.exponent": (0.0, 1.0),
    "stops.lower": (-inf, inf),
    "stops.upper": (-inf, inf),
    "torque_ripple.amplitude": (-1.0, 1.0),
    "torque_ripple.phase": (-inf, inf),
    "viscous_asymmetry.half_difference": (-inf, inf),
    "viscous_temperature.coefficient": (-0.2, 0.2),
}
#: periods: three quarters of a cycle over the travel from one to the next
WAVES = tuple(1.0 / (0.75 * k) for k in range(1, 151))
SHORT_WAVES = tuple(1.0 / (0.75 * k) for k in range(1, 301))
#: where a search of a parameter starts, in the record's scale; the others start at 0.01 and 0.1
STARTS = {
    "actuation_delay.delay": (0.05, 0.5, 2.0),
    "actuator_gain.gain": (1.0,),
    "actuator_lag.time_constant": (0.05, 0.5, 2.0),
    "actuator_saturation.limit": tuple(0.7 * 1.25**k for k in range(9)),
    "backlash.damping": (0.03,),
    "backlash.gap": (0.7, 2.5, 10.0, 35.0, 120.0),
    "backlash.stiffness": (0.03, 0.1, 0.3),
    "backlash.tip_inertia": (0.1, 0.2, 0.4, 0.8),
    "cogging.amplitude": (0.03,),
    "cogging.period": WAVES,
    "cogging.phase": (0.0,),
    "cogging_harmonic.amplitude": (0.03,),
    "cogging_harmonic.period": SHORT_WAVES,
    "cogging_harmonic.phase": (0.0,),
    "contact_hardening.depth": (0.5,),
    "contact_hardening.power": (1.2, 1.5, 2.0),
    "coupling.inertia": (0.1,),
    "friction_drift.time_constant": (0.2, 1.0),
    "friction_memory.time_constant": (1.0, 10.0),
    "gravity.phase": (0.0,),
    "hardening_spring.neutral": (-1.0, 0.0, 1.0),
    "load_dependent_friction.driving_difference": (0.0,),
    "load_dependent_friction.extra_at_rest": (0.0,),
    "load_dependent_friction.output_share": (0.0, 1.0),
    "load_dependent_friction.stribeck_velocity": (0.1,),
    "maxwell_slip.level_2": (0.25,),
    "maxwell_slip.level_3": (0.25,),
    "maxwell_slip.level_4": (0.25,),
    "maxwell_slip.stiffness_1": (0.1, 0.3, 1.0, 3.0, 10.0),
    "maxwell_slip.stiffness_2": (3.0, 10.0),
    "maxwell_slip.stiffness_3": (3.0,),
    "maxwell_slip.stiffness_4": (3.0,),
    "position_dependent_friction.amplitude": (0.05,),
    "position_dependent_friction.period": (3.0, *WAVES),
    "position_dependent_friction.phase": (0.0,),
    "position_dependent_gain.centre": (-1.0, 0.0, 1.0),
    "position_dependent_gain.fall": (0.05,),
    "presliding.bristle_damping": (0.1,),
    "presliding.stiffness": (3.0, 10.0, 30.0, 100.0, 300.0, 1e3, 3e3, 1e4),
    "shear_thinning.exponent": (0.25, 0.5, 0.75),
    "smoothed_coulomb.level": (0.1,),
    "smoothed_coulomb.smoothing_velocity": (0.05, 0.3),
    "stops.lower": (-1.2,),
    "stops.upper": (1.2,),
    "stribeck.stribeck_velocity": (0.02, 0.1, 0.5),
    "tip_friction.level": (0.1,),
    "torque_ripple.amplitude": (0.05,),
    "torque_ripple.period": WAVES,
    "torque_ripple.phase": (0.0,),
    "transmission_compliance.damping": (0.01,),
    "transmission_compliance.stiffness": (0.004, 0.02, 0.1, 0.5),
    "transmission_compliance.tip_inertia": (0.1, 0.5),
    "viscous_temperature.coefficient": (-0.01, 0.01, 0.04),
}
#: unit of the search where it is not that of the quantity
SCALES = {
    "backlash.damping": "resonance_damping",
    "backlash.gap": "resonance_position",
    "backlash.stiffness": "resonance_stiffness",
    "cogging.period": "travel",
    "cogging_harmonic.period": "travel",
    "friction_drift.time_constant": "duration",
    "position_dependent_friction.period": "travel",
    "stribeck.extra_static_level": "largest_force",
    "torque_ripple.period": "travel",
    "transmission_compliance.damping": "resonance_damping",
    "transmission_compliance.stiffness": "resonance_stiffness",
}
#: largest value of a search, in that unit
WITHIN = {
    "cogging.period": 2.0,
    "cogging_harmonic.period": 2.0,
    "position_dependent_gain.fall": 1.0,
    "load_dependent_friction.coefficient": 1.0,
    "torque_ripple.period": 2.0,
    **{f"maxwell_slip.{n}_{i}": 1e4 for n in ("stiffness", "level") for i in (3, 4)},
}
#: largest value that can have acted, in that unit
LIMIT = {"stribeck.extra_static_level": 1.0}
#: set, and not estimated
CHOSEN = {
    "contact_hardening.depth",
    "load_dependent_friction.driving_difference",
    "load_dependent_friction.extra_at_rest",
    "load_dependent_friction.output_share",
    "load_dependent_friction.stribeck_velocity",
}
#: parameters whose starts are multiples of another one's
OF = {f"maxwell_slip.stiffness_{i}": f"stiffness_{i - 1}" for i in (2, 3, 4)}
#: may be left out, and are zero then
OPTIONAL = {
    "hardening_spring.neutral",
    "position_dependent_gain.centre",
    "load_dependent_friction.driving_difference",
    "load_dependent_friction.extra_at_rest",
    "load_dependent_friction.output_share",
    "load_dependent_friction.stribeck_velocity",
    "presliding.bristle_damping",
    *(f"maxwell_slip.{n}_{i}" for n in ("stiffness", "level") for i in (3, 4)),
}
PARAMETERS = {f"{n}.{p}": q for n, e in KNOWN.items() for p, q in e.parameters.items()}


def test_every_name_of_these_tables_is_a_parameter():
    for names in (BOUNDS, STARTS, SCALES, OF, WITHIN, LIMIT, CHOSEN, OPTIONAL):
        assert set(names) <= set(PARAMETERS)


@pytest.mark.parametrize("name", sorted(PARAMETERS))
def test_a_parameter_has_the_bounds_and_the_search_of_these_tables(name):
    declared = PARAMETERS[name]
    assert (declared.lower, declared.upper) == BOUNDS.get(name, (0.0, inf))
    assert declared.optional == (name in OPTIONAL)
    search = declared.search
    assert np.allclose(search.starts, STARTS.get(name, (0.01, 0.1)), rtol=1e-12)
    assert declared.scale == SCALES.get(name, declared.quantity)
    assert search.of == OF.get(name, "")
    assert search.within == WITHIN.get(name, inf)
    assert search.limit == LIMIT.get(name, inf)
    assert search.chosen == (name in CHOSEN)
    # without a gap a play is a compliance
    assert search.essential == (name == "backlash.gap")
    effect, _, parameter = name.partition(".")
    zero = 0.0 if name in OPTIONAL else 1.0
    assert KNOWN[effect].default(parameter) == KNOWN[effect].absent.get(parameter, zero)


#: laws that are sums of signals times constants, and have a linear form
LINEAR = {
    *("actuation_delay", "actuator_gain", "actuator_lag", "added_inertia", "arm", "spring"),
    *("transmission_compliance", "viscous"),
}


@pytest.mark.parametrize("name", sorted(KNOWN))
def test_exactly_the_linear_laws_have_a_linear_form(name):
    assert KNOWN[name].linear == (name in LINEAR)
    # a damping counts in contact only, however linear its law
    assert acts_linearly(KNOWN[name]) == (name in {*LINEAR, "contact_damping"})


#: what a law repeats after along the way; None: it depends on the position, and never repeats
REPEATS = {
    "arm": None,
    "cogging": "period",
    "cogging_harmonic": "period",
    "contact_hysteresis": None,
    "gravity": 2 * pi,
    "hardening_spring": None,
    "position_dependent_friction": "period",
    "position_dependent_gain": None,
    "spring": None,
    "stops": None,
    "torque_ripple": "period",
}


@pytest.mark.parametrize("name", sorted(KNOWN))
def test_what_depends_on_the_place_and_on_time_is_that_of_the_physics(name):
    assert depends_on_position(KNOWN[name]) == (name in REPEATS)
    assert period(KNOWN[name]) == REPEATS.get(name)
    assert depends_on_time(KNOWN[name]) == (name == "friction_drift")


WAVES_OF = ("cogging", "cogging_harmonic", "gravity")
#: the parameter that a law is proportional to, where no hidden state depends on it
STRENGTH = {
    "tip_friction": "level",
    "added_inertia": "inertia",
    "bias": "force",
    "contact_damping": "damping",
    "coulomb": "level",
    "coulomb_asymmetry": "half_difference",
    "coupling": "inertia",
    "friction_drift": "fraction",
    "load_dependent_friction": "coefficient",
    "quadratic_drag": "drag",
    "shear_thinning": "drag",
    "smoothed_coulomb": "level",
    "stops": "stiffness",
    "spring": "stiffness",
    "hardening_spring": "stiffness",
    "stribeck": "extra_static_level",
    "viscous": "damping",
    "viscous_asymmetry": "half_difference",
    "position_dependent_gain": "fall",
    **dict.fromkeys(WAVES_OF, "amplitude"),
    **dict.fromkeys(("position_dependent_friction", "torque_ripple"), "amplitude"),
}
WAVING = {*WAVES_OF, "position_dependent_friction", "torque_ripple"}


@pytest.mark.parametrize("name", sorted(KNOWN))
def test_strength_and_phase_are_those_of_the_equation(name):
    assert KNOWN[name].strength == STRENGTH.get(name)
    assert KNOWN[name].phase == ("phase" if name in WAVING else None)


#: hidden states: quantity, signal that they equal at the start, whether a correction leads them
STATES = {
    "actuator_lag": {"output": ("force", "", False)},
    "arm": {"arm_position": ("position", "", False), "arm_velocity": ("velocity", "", False)},
    "contact_hysteresis": {"bristle": ("position", "", False)},
    "friction_memory": {"film": ("velocity", "", False)},
    "maxwell_slip": {f"force_{i}": ("force", "", False) for i in (1, 2, 3, 4)},
    "presliding": {"bristle": ("position", "", False)},
    **dict.fromkeys(
        ("backlash", "transmission_compliance"),
        {
            "tip_position": ("position", "position", True),
            "tip_velocity": ("velocity", "velocity", False),
        },
    ),
}


@pytest.mark.parametrize("name", sorted(KNOWN))
def test_hidden_states_start_and_are_led_as_the_file_says(name):
    states = {
        n: (s.quantity, s.start, s.correction is not None) for n, s in KNOWN[name].states.items()
    }
    assert states == STATES.get(name, {})


#: rate at which a tip is led, over its natural frequency in contact and its part of the inertia
FOLLOWING = {"backlash": 3.0, "transmission_compliance": 1.0}


@pytest.mark.parametrize("name", sorted(FOLLOWING))
def test_the_force_left_unexplained_leads_the_tip_by_the_stated_rate(name):
    effect = KNOWN[name]
    (law,) = effect.corrections().values()
    m, k, body, left = 0.2, 800.0, 0.5, 3.0
    values = {f"{name}_tip_inertia": m, f"{name}_stiffness": k, "inertia": body}
    values |= {"unexplained": left}
    led = float(law.subs({s: values[s.name] for s in law.free_symbols}))
    assert led == pytest.approx(-FOLLOWING[name] * (k / m) ** 0.5 * (m / body) * left / k)
    momentum = effect.led_momentum()
    led_momentum = float(momentum.subs({s: values[s.name] for s in momentum.free_symbols}))
    assert led_momentum == pytest.approx(m * led)


def test_a_law_whose_slope_does_not_show_it_is_linear_too():
    """Of (a + b)^2 u - a^2 u the slope 2 (a + b) u - 2 a u holds a until it is expanded."""

    def law(now, p):
        return ((p.size + p.more) ** 2 - p.size**2) * now.velocity

    size, more = Parameter("damping", "a"), Parameter("damping", "b")
    effect = Effect("force", law, {"size": size, "more": more}, absent={"size": 0.0})
    assert effect.strength == "size"
    square = replace(effect, law=lambda now, p: p.size**2 * p.more * now.velocity)
    assert square.strength is None
