"""A spring whose neutral place is not where the encoder reads zero is a spring and a bias."""

import numpy as np
import pytest

import teleopdesign as td

T = np.arange(0.0, 14.0, 2e-3)
#: axis -> what would stand for the two
STAND_INS = {"revolute": "gravity", "prismatic": "stops"}


def sprung(axis, neutral):
    """A body of 0.05 on a spring of 0.5, moved by three sines; forces of its own sensor."""
    w, a = 2 * np.pi * np.array([0.41, 0.9, 1.7]), np.array([0.7, 0.3, 0.15])
    x = neutral + np.sin(np.outer(T, w)) @ a
    v, acceleration = np.cos(np.outer(T, w)) @ (a * w), -np.sin(np.outer(T, w)) @ (a * w**2)
    force = 0.05 * acceleration + 0.2 * np.sign(v) + 0.03 * v + 0.5 * (x - neutral)
    force += 0.002 * np.random.default_rng(1).standard_normal(len(T))
    unit = {"revolute": "rad", "prismatic": "m"}[axis]
    channels = {"position": {"column": "x", "unit": unit}, "actuator_force": "u"}
    table = {"t": T, "x": 1e-4 * np.round(1e4 * x), "u": force}
    return td.experiment(table, axis=axis, fit=[(0, 8)], check=[(8, 14)], **channels)


@pytest.mark.parametrize("axis", ["revolute", pytest.param("prismatic", marks=pytest.mark.slow)])
def test_a_spring_and_a_bias_are_named_where_the_neutral_place_is_not_zero(axis):
    among = ["spring", "bias", "stribeck", STAND_INS[axis]]
    diagnosis = td.find_missing(sprung(axis, 0.4), among=among)
    assert {one["effect"] for one in diagnosis.missing_places} == {"spring", "bias"}
    values = {n.partition(".")[2]: v.value for n, v in diagnosis.model.parameters.items()}
    assert values["spring.stiffness"] == pytest.approx(0.5, rel=0.02)
    assert -values["bias.force"] / values["spring.stiffness"] == pytest.approx(0.4, abs=0.02)
