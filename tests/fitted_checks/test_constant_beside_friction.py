"""A constant force much larger than the friction does not make a right sign look wrong."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.fitted_checks import check_experiment

EXPERIMENT = """title = "Cylinder"
[model.device]
axis = "prismatic"
inertia = { value = 0.5, unit = "kg", fixed = false }
[model.device.effects]
coulomb = { level = { value = 7.0, unit = "N" } }
viscous = { damping = { value = 100.0, unit = "N*s/m" } }
[channels]
time = { column = "t", unit = "s" }
position = { column = "x", unit = "m", resolution = 1e-6 }
actuator_force = { column = "f", unit = "N" }
[[records]]
file = "strokes.csv"
use = "fit"
"""


def write_strokes(folder, side, pressure):
    """Strokes at two speeds against a pressure (N) that the model lacks."""
    folder.mkdir()
    t = 0.01 * np.arange(2000)
    speed = np.where(np.sin(np.pi * t / 2.5) > 0, 0.005, -0.011)
    x = np.cumsum(np.convolve(speed, np.ones(15) / 15, "same")) * 0.01
    v = np.gradient(x, t)
    force = pressure + 7.0 * np.tanh(v / 2e-4) + 100.0 * v
    force += 0.1 * np.random.default_rng(1).standard_normal(len(t))
    rows = np.column_stack([t, x, side * force])
    np.savetxt(folder / "strokes.csv", rows, delimiter=",", header="t,x,f", comments="")
    (folder / "experiment.toml").write_text(EXPERIMENT)
    return td.load_experiment(folder)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("side", "pressure", "is_reported"),
    [(1.0, 250.0, False), (-1.0, 250.0, True), (1.0, 15.0, False), (-1.0, 0.0, True)],
)
def test_friction_beside_a_pressure_tells_the_sign(side, pressure, is_reported, tmp_path):
    findings = check_experiment(write_strokes(tmp_path / "strokes", side, pressure))
    warnings_of_sign = [f for f in findings if "opposite sign" in f.sentence]
    assert bool(warnings_of_sign) == is_reported, [f.sentence for f in findings]


PENDULUM = EXPERIMENT.replace("prismatic", "revolute").replace("kg", "kg*m^2")
PENDULUM = PENDULUM.replace("0.5, unit", "0.05, unit").replace('"m"', '"rad"')
PENDULUM = PENDULUM.replace("7.0", "0.1").replace("100.0", "0.01")
PENDULUM = PENDULUM.replace('"N*s/m"', '"N*m*s/rad"').replace('"N"', '"N*m"')


def write_swings(folder, side, stiffness):
    """A chirp far below the rate at which the pendulum swings by itself, 7.7 rad/s."""
    folder.mkdir()
    t = 0.01 * np.arange(1500)
    x = 0.8 * np.sin(0.18 * t**2)
    v = np.gradient(x, t)
    force = 0.05 * np.gradient(v, t) + stiffness * np.sin(x) + 0.1 * np.tanh(v / 1e-2) + 0.01 * v
    force += 0.01 * np.random.default_rng(1).standard_normal(len(t))
    rows = np.column_stack([t, x, side * force])
    np.savetxt(folder / "strokes.csv", rows, delimiter=",", header="t,x,f", comments="")
    (folder / "experiment.toml").write_text(PENDULUM)
    return td.load_experiment(folder)


@pytest.mark.slow
@pytest.mark.parametrize(("side", "stiffness"), [(1.0, 3.0), (-1.0, 3.0), (1.0, 0.3)])
def test_a_pendulum_that_the_model_lacks_turns_no_inertia(side, stiffness, tmp_path):
    """It swings in phase with its torque, as if it had a negative inertia."""
    findings = check_experiment(write_swings(tmp_path / "swings", side, stiffness))
    warnings_of_sign = [f for f in findings if "opposite sign" in f.sentence]
    assert bool(warnings_of_sign) == (side < 0), [f.sentence for f in findings]
    assert not [f for f in findings if "lags the motion" in f.sentence]
