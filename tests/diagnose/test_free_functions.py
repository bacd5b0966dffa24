"""Belief in an effect: what it explains beside free functions of the motion."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.free_functions import belief
from teleopdesign.diagnose.search import estimate_from_starts
from teleopdesign.measurement.prepare import prepare

T = 0.005 * np.arange(8000)
FREQUENCIES = np.array([0.13, 0.31, 0.57, 0.91, 1.3])[:, None]  # Hz
PHASES = np.array([0.3, 2.1, 4.0, 5.2, 1.1])[:, None]
SIZES = 0.01 / (1.0 + FREQUENCIES)  # m
ANGLES = 2 * np.pi * FREQUENCIES * T + PHASES
X = (SIZES * np.sin(ANGLES)).sum(axis=0)
V = (SIZES * 2 * np.pi * FREQUENCIES * np.cos(ANGLES)).sum(axis=0)
A = (-SIZES * (2 * np.pi * FREQUENCIES) ** 2 * np.sin(ANGLES)).sum(axis=0)
SPRING = 60.0 * X


def believed(effect, force, *, check=True):
    """Belief in an effect of a mass with a damper, on which a force acts besides."""
    noise = 1e-3 * np.random.default_rng(1).standard_normal(len(T))
    table = {"time": T, "x": X, "u": 0.5 * A + 2.0 * V + force + noise}
    spans = {"fit": (0.0, 25.0), "check": (25.0, 40.0)} if check else {}
    experiment = td.experiment(
        table,
        axis="prismatic",
        position="x",
        actuator_force="u",
        inertia=0.5,
        effects=("viscous",),
        bandwidth=10.0,
        **spans,
    )
    prepared = prepare(experiment)
    model = td.Model.from_experiment(experiment)
    bare = estimate(model, prepared)
    whole = estimate_from_starts(model.with_effect(effect, at="device"), prepared, bare)
    return belief(bare, whole, "device", prepared)


@pytest.mark.parametrize("check", [True, False])
def test_a_true_effect_explains_what_a_free_function_does(check):
    one = believed("spring", SPRING, check=check)
    assert one.rho > 0.99 and one.lambda_ > -0.1
    assert one.best.startswith("position")


@pytest.mark.parametrize("check", [True, False])
def test_an_effect_that_stands_in_for_another_force_explains_clearly_less(check):
    pattern = 0.4 * np.sin(2 * np.pi * X / 0.012)
    one = believed("spring", pattern + 8.0 * X, check=check)
    assert one.share < 0.7 and one.lambda_ < 0.0
    friction = 0.5 * np.tanh(V / 0.004)
    assert believed("quadratic_drag", friction, check=check).share < 0.7
