"""Hidden states along a motion: their first value, and the fastest rate that has numbers."""

import numpy as np
import pytest
from effects.along import body_of, unled

from teleopdesign.blocks import Body, Value
from teleopdesign.effects import SIGNALS, Effect, Parameter
from teleopdesign.effects._effect import State
from teleopdesign.realise.ode_scan import ode_scan
from teleopdesign.realise.scan import driven_scan, stage_scan
from teleopdesign.realise.traced import Along, Traced

STEP, TAU = 1e-3, 0.02


def lag_of(signal, *, slower):
    """A first-order lag behind a signal, slower or not where the body is away from zero."""

    def rate(now, p):
        by = 1 + 9 * now.position**2 if slower else 1
        return (getattr(now, signal) - now.output) / (p.tau * by)

    return Effect(
        role="actuation" if signal == "command" else "friction_speed",
        law=lambda now, p: now.output,
        states={"output": State("force" if signal == "command" else "velocity", rate)},
        parameters={"tau": Parameter("time", "tau")},
        absent={"tau": 0.0},
    ).named("own", "")


def along_of(effect, signals, *, tau=TAU):
    """These signals, and tangents by the lag's time constant."""
    body = Body("prismatic", {"inertia": Value(0.1), "own.tau": Value(tau)}, (effect,))
    symbol = effect.symbols()["tau"]
    known = {SIGNALS[n]: Traced(y, np.zeros((1, len(y)))) for n, y in signals.items()}
    return Along(known, body.numbers(), (symbol,), STEP)


def state_by_hand(drive, position, *, slower, start):
    """The lag at the rows and its average over each row: exact, all signals held over a row."""
    z, ends, means = start, [], []
    for u, x in zip(drive, position, strict=True):
        tau = TAU * (1 + 9 * x**2) if slower else TAU
        keep = np.exp(-STEP / tau)
        ends.append(z)
        means.append(u + (z - u) * tau / STEP * (1 - keep))
        z = u + (z - u) * keep
    return np.array([*ends, z]), np.array(means)


@pytest.mark.parametrize("slower", [False, True], ids=["one rate", "a rate at each row"])
def test_a_lag_begins_at_rest_with_the_first_command_and_is_averaged_over_each_row(slower):
    t = STEP * np.arange(80)
    drive, position = 1.5 + np.cos(90 * t), 0.4 * np.sin(50 * t + 1.0)
    effect = lag_of("command", slower=slower)
    signals = {"command": drive, "position": position}
    (state,) = stage_scan(effect, along_of(effect, signals)).values()
    _, means = state_by_hand(drive, position, slower=slower, start=drive[0])
    np.testing.assert_allclose(state.value, means, rtol=1e-12)
    sides = [
        next(iter(stage_scan(effect, along_of(effect, signals, tau=TAU * s)).values())).value
        for s in (1 + 1e-6, 1 - 1e-6)
    ]
    slope = (sides[0] - sides[1]) / (2e-6 * TAU)
    np.testing.assert_allclose(state.tangent[0], slope, atol=1e-6 * np.abs(slope).max())
    assert state.value[0] == pytest.approx(drive[0], rel=1e-12) and abs(slope[0]) < 1e-6


def test_a_lag_behind_the_motion_has_at_a_row_what_the_sample_before_it_made():
    t = STEP * np.arange(80)
    drive, position = 0.2 * np.cos(90 * t + 0.3), 0.4 * np.sin(50 * t + 1.0)
    effect = lag_of("velocity", slower=True)
    along = along_of(effect, {"velocity": drive, "position": position})
    (state,) = driven_scan(effect, along).values()
    ends, _ = state_by_hand(drive, position, slower=True, start=drive[0])
    np.testing.assert_allclose(state.value[:-1], ends[1:-1], rtol=1e-12, atol=1e-15)
    assert state.value[-1] == state.value[-2]
    assert np.array_equal(state.tangent[:, -1], state.tangent[:, -2])


@pytest.mark.parametrize(("angle", "known"), [(1.0, True), (31.0, True), (33.0, False)])
def test_a_tip_has_numbers_up_to_thirty_two_radians_of_its_swing_in_a_row(angle, known):
    """Sixteen steps of two radians each; beyond, a step would be too long for its method."""
    inertia = 0.05
    values = {"tip_inertia": inertia, "stiffness": inertia * (angle / STEP) ** 2, "damping": 0.0}
    body = body_of(
        "transmission_compliance",
        values={f"transmission_compliance.{n}": v for n, v in values.items()},
    )
    (effect,) = unled(body).effects
    t = STEP * np.arange(50)
    signals = {
        "position": 0.01 * np.cos(20 * t),
        "velocity": -0.2 * np.sin(20 * t),
        "acceleration": -4.0 * np.cos(20 * t),
        "interaction_force": 0.0 * t,
    }
    signals_along = {SIGNALS[n]: Traced(y, np.zeros((0, 50))) for n, y in signals.items()}
    hidden = ode_scan(effect, Along(signals_along, body.numbers(), (), STEP))
    tip = hidden[effect.state_symbols()["tip_position"]].value
    assert np.isfinite(tip).all() == known and (known or np.isnan(tip).all())
