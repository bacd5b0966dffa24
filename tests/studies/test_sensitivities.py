"""Slopes of simulated signals in parameters, against formulas and sensitivity equations."""

import numpy as np
import pytest
import study_models as models
from devices import body
from hypothesis import given, settings
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.base.errors import ModelError

SPRUNG = td.haptic_interface(body(0.15, viscous__damping=2.0, spring__stiffness=300.0))
NAMES = ("Z_M.inertia", "Z_M.viscous.damping", "Z_M.spring.stiffness", "initial.L")
DECAY = {"duration": 0.3, "computer": "continuous", "initial": {"L": 5e-3}}


def decay(time, inertia, damping, stiffness, start):
    """Position of a released mass on a spring with a damper; takes complex numbers."""
    rate = damping / (2 * inertia)
    turn = np.sqrt(stiffness / inertia - rate**2 + 0j)
    swing = np.cos(turn * time) + rate / turn * np.sin(turn * time)
    return start * np.exp(-rate * time) * swing


def slope_of_decay(time, values, which, change):
    """By a central difference of the formula, right to (change/value)^2 and rounding."""
    sides = []
    for side in (-1, 1):
        moved = list(values)
        moved[which] += side * change
        sides.append(decay(time, *moved).real)
    return (sides[1] - sides[0]) / (2 * change)


@settings(max_examples=6)
@given(
    inertia=st.floats(0.05, 1.0),
    damping=st.floats(0.2, 5.0),
    stiffness=st.floats(50.0, 2000.0),
    start=st.floats(-0.01, 0.01).filter(lambda x: abs(x) > 1e-4),
)
def test_slopes_of_a_released_mass_are_those_of_its_formula(inertia, damping, stiffness, start):
    values = (inertia, damping, stiffness, start)
    here = SPRUNG.with_values(dict(zip(NAMES[:3], values[:3], strict=True)))
    settings = {**DECAY, "initial": {"L": start}}
    slopes = td.sensitivities(here, NAMES, ["L"], **settings)
    for k, name in enumerate(NAMES):
        exact = slope_of_decay(slopes["time"].values, values, k, 1e-5 * values[k])
        one = slopes.sel(parameter=name)
        # the simulation's own error at 0.1 ms is far below; what is apart bounds the rest
        bound = max(2 * float(one["L_apart"]), 1e-6)
        assert bound < 1e-4
        error = np.sqrt(np.mean((one["L"].values - exact) ** 2))
        assert error <= bound * np.sqrt(np.mean(exact**2))
    assert slopes["unit"].values.tolist() == ["kg", "N*s/m", "N/m", "m"]


def test_a_start_moves_a_linear_motion_by_the_motion_from_one():
    slopes = td.sensitivities(SPRUNG, ["initial.L"], ["L", "L_velocity"], **DECAY)
    unit = td.simulate_diagram(SPRUNG, **{**DECAY, "initial": {"L": 1.0}}, jit=False)
    for signal in ("L", "L_velocity"):
        # linear: equal but for rounding of differences
        np.testing.assert_allclose(slopes[signal].values[0], unit[signal].values, atol=1e-7)


def test_friction_that_slides_and_turns_has_slopes_and_the_force_follows_its_level():
    """Prescribed motion: the force that it takes is friction, d(force)/d(level) near sgn v."""
    slopes = td.sensitivities(
        models.interface(), ["Z_M.coulomb.level", "C.dahl.level"], ["R_V"], **models.SIMULATED
    )
    assert float(slopes["R_V_apart"].max()) < 1e-3
    velocity = np.cos(2 * np.pi * 5.0 * slopes["time"].values)
    slides = np.abs(velocity) > 0.5  # some bristle lengths after a reversal
    slides[0] = False  # at rest
    friction = slopes["R_V"].sel(parameter="Z_M.coulomb.level").values
    np.testing.assert_allclose(friction[slides], np.sign(velocity)[slides], atol=1e-3)
    cancelled = slopes["R_V"].sel(parameter="C.dahl.level").values
    later = slides & (slopes["time"].values > 0.05)  # the bristle of the law has come to its level
    np.testing.assert_allclose(cancelled[later], -np.sign(velocity)[later], atol=0.05)


def test_at_a_bound_the_slope_is_taken_from_the_side_that_exists():
    """Damping next to 0: there is no simulation with less."""
    least = 1e-9
    here = SPRUNG.with_values({"Z_M.viscous.damping": least})
    names = ["Z_M.viscous.damping"]
    slopes = td.sensitivities(here, names, ["L"], scales={names[0]: 1.0}, **DECAY)
    exact = slope_of_decay(slopes["time"].values, (0.15, least, 300.0, 5e-3), 1, 1e-4)
    # one-sided parabolas at 2e-4 of a change that matters, or less
    np.testing.assert_allclose(slopes["L"].values[0], exact, atol=1e-4 * np.abs(exact).max())


def test_an_encoder_leaves_no_derivative_and_that_is_reported():
    rounded = td.Sampling(encoder_step=1e-4)
    free = {"duration": 0.2, "inputs": {"R_V": 1.5}, "initial": {"L_velocity": 0.2}}
    by_encoder, by_position = (
        td.sensitivities(models.interface(), ["Z_M.inertia"], ["R_MBC"], computer=computer, **free)
        for computer in (rounded, td.Sampling())
    )
    assert (
        float(by_encoder["R_MBC_apart"].max()) > 0.1 > 10 * float(by_position["R_MBC_apart"].max())
    )


def test_a_dead_time_in_whole_steps_has_no_slope():
    """Its difference would be 0 or a jump, whatever its size; nothing is simulated to find out."""
    late = td.haptic_interface(body(0.15, viscous__damping=2.0, actuation_delay__delay=1e-3))
    with pytest.raises(ModelError, match="by jumps"):
        td.sensitivities(late, ["Z_M.actuation_delay.delay"], ["L"], duration=0.1)
