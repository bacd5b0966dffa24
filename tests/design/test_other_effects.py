"""What C cancels beside a constant level: within every interval, and by the effects' own laws."""

from dataclasses import replace

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.blocks import Value
from teleopdesign.design import Assumptions
from teleopdesign.design.cancellation import ProposedController, Reason
from teleopdesign.design.device import Device
from teleopdesign.design.other_effects import (
    following_cancellation,
    forces_to_cancel,
    late_force_claim,
    not_cancelled,
    with_forces,
)
from teleopdesign.design.quasi_static import law_along, slow_output
from teleopdesign.effects import SIGNALS
from teleopdesign.realise.reach import Reach

REACH = Reach(
    low=-0.5,
    high=0.5,
    peak_speed=2.0,
    rms_speed=1.0,
    command=0.5,
    duration=10.0,
    sample_period=1e-3,
    step=1e-4,
    unresolved=1e-3,
    both_ways=True,
    measures_force=True,
)
SETTINGS = Assumptions(sample_period=1e-3, delay=1e-3, velocity_bandwidth=50.0, load=0.03)
SMOOTHED = ProposedController(
    td.controller("smoothed_coulomb", {"level": 0.1, "smoothing_velocity": 1e-6}),
    (
        Reason("smoothed_coulomb.level", 0.1, "N*m", "a constant level"),
        Reason("smoothed_coulomb.smoothing_velocity", 1e-6, "rad/s", "none to speak of"),
    ),
)


def joint(settings=SETTINGS, **effects):
    """A joint with Coulomb and viscous friction and these effects, every value within 2 %."""
    body = td.Body("revolute", {"inertia": 0.01})
    stated = {"coulomb": {"level": 0.3}, "viscous": {"damping": 0.02}, **effects}
    for name, values in stated.items():
        body = body.with_effect(td.EFFECTS[name], values)
    errors = {
        n: Value(v.value, stderr=0.02 * abs(v.value))
        for n, v in body.parameters.items()
        if v.value and not v.fixed
    }
    return Device(body.with_values(errors), REACH, settings)


PLACE = {"amplitude": 0.4, "period": 0.9, "phase": 0.3}
COGGING = {"amplitude": 0.1, "period": 0.57, "phase": 0.3}


@pytest.mark.parametrize(
    "effects",
    [
        pytest.param({"position_dependent_friction": PLACE}, marks=pytest.mark.slow),
        pytest.param(
            {"stribeck": {"extra_static_level": 0.2, "stribeck_velocity": 0.2}},
            marks=pytest.mark.slow,
        ),
        {"coulomb_asymmetry": {"half_difference": 0.1}},
    ],
)
def test_a_level_that_is_followed_stays_below_every_level_of_the_interval(effects):
    device = joint(**effects)
    made, body = following_cancellation(SMOOTHED, device), device.body
    places, speeds = np.linspace(-0.5, 0.5, 41), np.array([0.01, 0.2, 1.5, -0.01, -0.2, -1.5])
    cancelled = np.array([slow_output(made.controller, places, np.full(41, v)) for v in speeds])
    random = np.random.default_rng(2)
    signals = {
        SIGNALS["position"]: places,
        SIGNALS["velocity"]: speeds[:, None],
        SIGNALS["direction"]: np.sign(speeds)[:, None],
    }
    for _ in range(8):
        values = {
            n: v.value + 1.96 * v.stderr * random.uniform(-1, 1)
            for n, v in body.parameters.items()
            if np.isfinite(v.stderr)
        }
        level, _ = law_along(body.with_values(values), body.level(), signals)
        assert (np.abs(cancelled) <= level).all()
    estimate, _ = law_along(body, body.level(), signals)
    assert (np.abs(cancelled) > 0.6 * estimate).all()  # and is no guess far below


def test_a_spring_is_cancelled_by_a_part_and_a_periodic_force_whole():
    wanted = forces_to_cancel(joint(spring={"stiffness": 2.0}, cogging=COGGING))
    assert wanted["cogging"] == COGGING
    assert wanted["spring"]["stiffness"] == pytest.approx(0.9 * 2.0 * (1 - 1.96 * 0.02), rel=0.01)


def test_what_no_command_cancels_is_listed_with_its_reason():
    device = joint(cogging=COGGING, quadratic_drag={"drag": 0.01})
    left = not_cancelled(device, with_forces(SMOOTHED, device))
    assert set(left) == {"viscous", "quadratic_drag"} and all(left.values())


def test_a_force_of_place_that_comes_late_needs_damping_of_its_slope_times_the_delay():
    slope = COGGING["amplitude"] * 2 * np.pi / COGGING["period"]
    enough = late_force_claim(joint(cogging=COGGING))
    damping = 0.02 * (1 - 1.96 * 0.02)
    assert enough.holds
    assert enough.verdict.margin == pytest.approx(damping - slope * 2e-3, rel=1e-3)
    late = replace(SETTINGS, delay=0.029)
    assert not late_force_claim(joint(late, cogging=COGGING)).holds
    assert late_force_claim(joint(late)) is None
