"""A spring with a shifted rest position is not named a pendulum with a further effect."""

import numpy as np
import pytest
from diagnose.made_records import write_made

import teleopdesign as td

AMONG = ("gravity", "hardening_spring", "spring", "bias")
USER = "coulomb = {}\nviscous = {}"


def swings(amplitude, slow, fast):
    return lambda t: amplitude * (np.sin(2 * np.pi * slow * t) + 0.1 * np.sin(2 * np.pi * fast * t))


def as_a_slide(folder):
    """Write the same numbers as those of a prismatic axis."""
    path = folder / "experiment.toml"
    text = path.read_text().replace('"revolute"', '"prismatic"').replace('"kg*m^2"', '"kg"')
    path.write_text(text.replace('"N*m"', '"N"').replace('"rad"', '"m"'))


def diagnosed(folder, place_force, user=USER, *, prismatic=False):
    """What the user's model lacks where this force of the place acts beside friction."""
    records = {
        "fit": [(20.0, swings(0.7, 0.21, 0.9)), (20.0, swings(0.35, 0.13, 0.7))],
        "check": [(20.0, swings(0.6, 0.17, 0.8))],
    }

    def force(t, x, v):
        return place_force(x) + 0.1 * np.tanh(v / 1e-3) + 0.02 * v

    write_made(folder, records, force, effects=user, step=1e-5, noise=0.004)
    if prismatic:
        as_a_slide(folder)
    return td.find_missing(td.load_experiment(folder), among=AMONG)


@pytest.mark.slow
@pytest.mark.parametrize(("stiffness", "neutral"), [(0.8, -3.2)])
def test_a_spring_with_a_rest_position_is_a_spring_and_a_constant(tmp_path, stiffness, neutral):
    diagnosis = diagnosed(tmp_path / "line", lambda x: stiffness * (x - neutral))
    assert {c.effect.name for c in diagnosis.missing} == {"bias", "spring"}
    errors = [r.check_error for r in diagnosis.rungs]
    assert errors == sorted(errors, reverse=True)
    value = diagnosis.model.parameters["device.spring.stiffness"].value
    assert value == pytest.approx(stiffness, rel=0.02)


@pytest.mark.slow
def test_a_pendulum_whose_bend_is_visible_stays_one(tmp_path):
    diagnosis = diagnosed(tmp_path / "pendulum", lambda x: 0.8 * np.sin(x + 0.4))
    assert [c.effect.name for c in diagnosis.missing] == ["gravity"]
