"""The level that a cancellation may count on within the reach, and rounding to the safe side."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.blocks import Body, Value
from teleopdesign.design import Assumptions
from teleopdesign.design.cancellation import cancelled_level
from teleopdesign.design.device import Device, acting_gain
from teleopdesign.realise.friction_interval import friction_interval
from teleopdesign.realise.reach import Reach

REACH = Reach(
    low=-0.05, high=0.05, peak_speed=0.3, rms_speed=0.1, command=3.0, duration=10.0,
    sample_period=1e-3, step=5e-6, unresolved=2e-5, measures_force=True,
)  # fmt: skip


def body(level=1.0, stderr=0.0, **effects):
    """A body of 0.2 kg with Coulomb friction and other effects, {name: {parameter: value}}."""
    device = Body("prismatic", {"inertia": Value(0.2)})
    device = device.with_effect(td.EFFECTS["coulomb"]).with_values(
        {"coulomb.level": Value(level, stderr=stderr)}
    )
    for name, values in effects.items():
        device = device.with_effect(td.EFFECTS[name], values)
    return device


def least(device, errors=0.0):
    return friction_interval(device, REACH, errors=errors).lowest.low


@pytest.mark.slow
@settings(max_examples=20)
@given(
    errors=st.tuples(*[st.floats(0.0, 0.05)] * 3),
    signs=st.tuples(*[st.sampled_from([-1.0, 1.0])] * 3),
)
def test_the_bound_holds_however_the_errors_are_correlated(errors, signs):
    """Parameters one standard error off in any direction leave the level above the bound."""
    values = {"coulomb.level": 1.0, "stribeck.extra_static_level": 0.3}
    values["coulomb_asymmetry.half_difference"] = 0.2
    device = body(
        1.0,
        stribeck={"extra_static_level": 0.3, "stribeck_velocity": 0.02},
        coulomb_asymmetry={"half_difference": 0.2},
    )
    names = dict(zip(values, errors, strict=True))
    sure = least(
        device.with_values({n: Value(values[n], stderr=e) for n, e in names.items()}), errors=1.0
    )
    moved = {n: values[n] + s * e for (n, e), s in zip(names.items(), signs, strict=True)}
    # rounding: the level is a sum of three terms
    assert least(device.with_values(moved)) >= sure - 1e-12


def test_a_body_without_friction_has_no_range():
    assert friction_interval(Body("prismatic", {"inertia": Value(1.0)}), REACH, errors=0.0) is None


def test_a_strong_actuator_and_its_ripple_count():
    device = body(1.0, actuator_gain={"gain": 1.1})
    assert acting_gain(device, REACH, errors=0.0) == pytest.approx(1.1)
    device = body(1.0, torque_ripple={"amplitude": 0.2, "period": 0.05, "phase": 0.0})
    assert acting_gain(device, REACH, errors=0.0) == pytest.approx(1.2, rel=1e-4)
    device = body(1.0, actuator_lag={"time_constant": 0.01}, actuation_delay={"delay": 2e-3})
    assert acting_gain(device, REACH, errors=0.0) == pytest.approx(1.0)


@pytest.mark.parametrize("stderr", [0.0, 0.05, 0.3])
def test_the_level_is_commanded_so_that_no_more_acts_within_the_errors_of_the_gain(stderr):
    strong = body(1.0, actuator_gain={"gain": 1.25})
    strong = strong.with_values({"actuator_gain.gain": Value(1.25, stderr=1.25 * stderr)})
    device = Device(strong, REACH, Assumptions(fraction=0.5, errors=2.0))
    assert device.gain == pytest.approx(1.0 + 2.0 * stderr)
    level = cancelled_level(device).value * device.gain
    assert level == pytest.approx(0.5, rel=0.005)  # rounded down to three digits
