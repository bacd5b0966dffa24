"""A log of the size of a force: the supply current of a servo is never negative."""

import numpy as np
import pytest
from check.made_channels import ask

import teleopdesign as td

H = 0.005
T = H * np.arange(1600)
#: strokes to and fro with rests between them, as a servo makes them
SPEED = np.where(np.sin(1.9 * T) > 0.3, 1.0, np.where(np.sin(1.9 * T) < -0.3, -1.0, 0.0))
SPEED = np.convolve(SPEED, np.hanning(41) / np.hanning(41).sum(), "same") * (1 + 0.2 * np.sin(T))
X = np.cumsum(SPEED) * H
PUSH = 0.05 * np.gradient(SPEED, T) + 0.4 * np.tanh(SPEED / 0.02) + 0.2 * SPEED
NOISE = 0.01 * np.random.default_rng(5).standard_normal(len(T))


def log(force, hand=None):
    table = {"t": T, "x": np.round(X, 4), "u": force}
    channels = {"position": {"column": "x", "unit": "rad"}, "actuator_force": "u"}
    if hand is not None:
        table["f"], channels["interaction_force"] = hand, "f"
    return td.experiment(table, axis="revolute", inertia=0.05, **channels)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_records_of_a_supply_current_tell_no_effect(sign):
    experiment = log(sign * (0.1 + np.abs(PUSH) + np.abs(NOISE)))
    diagnosis = td.diagnose(experiment, among=("bias", "gravity"))
    assert not diagnosis.missing
    assert "Log it with its sign" in str(diagnosis)
    sentences = [f.sentence for f in td.check_experiment(experiment) if f.stops]
    assert any("The force never changes its sign" in s for s in sentences)


@pytest.mark.parametrize(
    "load",
    [
        2.0,  # a weight
        3.0 + 0.5 * X,  # a spring with a preload
        2.5 * np.cos(X - X.mean()),  # a pendulum held up
        3.0 + 1.0 * (X - X.mean()) ** 2,
    ],
    ids=["weight", "spring", "pendulum", "parabola"],
)
def test_a_force_that_is_kept_from_zero_by_a_load_has_its_sign(load):
    force = load + PUSH + NOISE
    assert np.min(force) > 0.0
    assert not ask("unsigned_force", log(force))


@pytest.mark.parametrize(
    "push",
    [
        PUSH,
        PUSH + 0.4 * np.gradient(SPEED, T),
        PUSH + 2.0 * (X - X.mean()),
        2.0 * SPEED + 0.1 * PUSH,
    ],
    ids=["friction", "inertia", "spring", "damping"],
)
def test_the_size_of_any_force_that_takes_both_signs_is_no_force(push):
    """Its sign follows from the model itself: near its zeros the size has a corner."""
    assert ask("unsigned_force", log(np.abs(push + NOISE)))[0].stops


def test_a_force_beside_a_second_one_or_with_both_signs_has_its_sign():
    size = 0.1 + np.abs(PUSH) + np.abs(NOISE)
    assert ask("unsigned_force", log(size))[0].stops
    assert not ask("unsigned_force", log(size, hand=PUSH - size))
    assert not ask("unsigned_force", log(PUSH + NOISE))
