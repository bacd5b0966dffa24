"""A model compared by simulation: against a motion whose exact solution is known."""

import json

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign import Value
from teleopdesign.diagnose import RecordedLoop
from teleopdesign.diagnose.by_simulation import HORIZONS, simulation_data

MASS, DAMPING, STEP = 2.0, 4.0, 1e-3


def recorded(rows_late=0):
    """A mass on a damper under a held force, solved exactly; the force logged so many rows late."""
    time = STEP * np.arange(6000)
    force = 3.0 * np.sin(2 * np.pi * 0.5 * time) + 2.0 * np.sin(2 * np.pi * 1.3 * time + 1.0)
    decay = np.exp(-DAMPING / MASS * STEP)
    position, velocity = np.zeros(len(time)), np.zeros(len(time))
    for k in range(len(time) - 1):
        speed = force[k] / DAMPING
        velocity[k + 1] = speed + (velocity[k] - speed) * decay
        moved = speed * STEP + (velocity[k] - speed) * (1 - decay) * MASS / DAMPING
        position[k + 1] = position[k] + moved
    data = {"t": time, "x": position, "u": np.roll(force, rows_late)}
    return td.experiment(
        data,
        axis="prismatic",
        position={"column": "x", "unit": "m", "resolution": 1e-7},
        actuator_force="u",
        time="t",
        inertia=MASS,
        effects=("viscous",),
        fit=[(0.0, 3.0)],
        check=[(3.0, 5.999)],
        bandwidth=30.0,
    )


@pytest.fixture(scope="module")
def experiment():
    return recorded()


def model_of(experiment, damping=DAMPING, mass=MASS):
    values = {"device.viscous.damping": damping, "device.inertia": mass}
    return td.Model.from_experiment(experiment).with_values(values)


def test_the_true_model_moves_as_the_device_did(experiment):
    comparison = td.compare(model_of(experiment), experiment, by="simulation")
    whole = comparison.error(np.inf)
    # the filtered motion that it is held against and starts on is off by less than this
    assert whole.of_travel < 1e-3 and whole.of_speed < 1e-3
    assert comparison.check_error < 1e-3
    # as many horizons as the record is longer than, and the whole of it, for either use
    assert [e.horizon for e in comparison.errors] == 2 * [*(h for h in HORIZONS if h < 2), np.inf]


def test_a_wrong_damping_leads_the_further_away_the_longer_it_is_left_alone(experiment):
    comparison = td.compare(model_of(experiment, 1.2 * DAMPING), experiment, by="simulation")
    check = [e.position for e in comparison.errors if e.use == "check"]
    assert all(later > 1.5 * earlier for earlier, later in zip(check, check[1:], strict=False))
    assert comparison.error(np.inf).of_travel > 0.05
    by_force = td.compare(model_of(experiment, 1.2 * DAMPING), experiment)
    assert comparison.check_error == pytest.approx(by_force.check_error)


def test_a_loop_holds_a_wrong_model_near_the_recorded_motion(experiment):
    model = model_of(experiment, 1.2 * DAMPING)
    free = td.compare(model, experiment, by="simulation").error(np.inf)
    held = td.compare(model, experiment, by="simulation", loop=RecordedLoop(400.0, 40.0))
    # quasi-statically the deviation is the missing force over the stiffness
    missing = 0.2 * DAMPING * np.std(held.prepared.parts[""].of("check")[0].motion.velocity)
    assert held.error(np.inf).position == pytest.approx(missing / 400.0, rel=0.3)
    assert held.error(np.inf).position < 0.1 * free.position


def test_a_command_that_is_logged_late_drives_the_model_in_time():
    experiment = recorded(rows_late=5)
    model = model_of(experiment)
    late = model.with_record_shift({"device": Value(5 * STEP)})
    wrong, right = (td.compare(m, experiment, by="simulation").error(np.inf) for m in (model, late))
    assert right.of_travel < 1e-3 < 0.2 * wrong.of_travel


def test_the_answer_holds_every_horizon_with_units(experiment):
    comparison = td.compare(model_of(experiment), experiment, by="simulation")
    data = json.loads(json.dumps(simulation_data(comparison), allow_nan=False))
    assert len(data["horizons"]) == len(comparison.errors) and data["loop"] is None
    assert data["horizons"][0]["horizon"] == {"value": 0.1, "unit": "s"}
    assert data["horizons"][-1]["horizon"]["value"] is None  # the whole record
    assert data["horizons"][0]["position"]["unit"] == "m"
    assert "whole record" in repr(comparison) and "whole record" in comparison._repr_html_()
