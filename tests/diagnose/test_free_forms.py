"""Curves without a named law: they take any force, and the catalogue's search leaves them out."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.diagnose.search import estimate_from_starts
from teleopdesign.diagnose.stated_fit import estimate_stated
from teleopdesign.measurement.prepare import prepare

RANGE = {"lower": -0.05, "upper": 0.06}


def odd_force(x):
    """A force of the position that no file of the catalogue describes."""
    return 0.8 * np.tanh(x / 0.012) + 6.0 * x


def level(v):
    return 0.4 + 0.3 * np.exp(-(np.abs(v) / 0.02)) + 2.0 * np.abs(v)


@pytest.fixture(scope="module")
def recording():
    t = np.arange(0.0, 6.0, 2e-3)
    x = 0.03 * np.sin(2.3 * t) + 0.01 * np.sin(10.7 * t)
    v = 0.069 * np.cos(2.3 * t) + 0.107 * np.cos(10.7 * t)
    a = -0.1587 * np.sin(2.3 * t) - 1.1449 * np.sin(10.7 * t)
    u = 0.15 * a + odd_force(x) + level(v) * np.sign(v)
    u += 0.005 * np.random.default_rng(1).standard_normal(len(t))
    return {"t_s": t, "x_m": x, "u_N": u}


def stated(recording, *effects):
    return td.experiment(
        recording,
        axis="prismatic",
        position="x_m",
        actuator_force="u_N",
        time="t_s",
        effects=effects,
        bandwidth=30.0,
    )


@pytest.mark.slow
def test_they_follow_a_force_and_a_friction_that_no_law_describes(recording):
    experiment = stated(recording, "free_force", "free_friction")
    fit = estimate_stated(td.Model.from_experiment(experiment), prepare(experiment))
    assert fit.check_error < 0.015
    assert fit.model.parameters["device.inertia"].value == pytest.approx(0.15, rel=0.02)
    values = {n: v.value for n, v in fit.model.body("device").parameters.items()}
    places = np.linspace(values["free_force.lower"], values["free_force.upper"], 8)
    assert places[[0, -1]] == pytest.approx([recording["x_m"].min(), recording["x_m"].max()], 1e-3)
    forces = [values[f"free_force.value_{i}"] for i in range(1, 9)]
    assert forces[1:-1] == pytest.approx(odd_force(places[1:-1]), abs=0.04)
    speeds = values["free_friction.upper"] * np.linspace(0.0, 1.0, 8) ** 2
    levels = [values[f"free_friction.value_{i}"] for i in range(2, 9)]
    assert levels == pytest.approx(level(speeds[1:]), abs=0.04)


def test_range_that_a_user_states_is_kept_and_not_estimated(recording):
    model = td.Model.from_experiment(stated(recording, "coulomb", "viscous"))
    model = model.with_effect("free_force", values=RANGE)
    fit = estimate_from_starts(model, prepare(stated(recording)))
    for name, place in RANGE.items():
        assert fit.model.parameters[f"device.free_force.{name}"].value == place
        assert f"device.free_force.{name}" not in fit.free
    assert fit.model.parameters["device.free_force.value_5"].value != 0.0
