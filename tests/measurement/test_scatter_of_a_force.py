"""The scatter of a force that was read is stated as its noise; that of a command acts."""

import numpy as np
import pytest

from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.survey import Choices, survey_log

H, STEP = 0.005, 1e-4
T = H * np.arange(4000)
RNG = np.random.default_rng(3)
ANGLE = 0.6 * np.sin(1.7 * T) + 0.3 * np.sin(4.1 * T)
RATE = np.gradient(ANGLE, H)
TORQUE = 0.05 * np.gradient(RATE, H) + 0.4 * np.tanh(RATE / 0.01) + 0.2 * RATE


def channels(name="tau (Nm)", *, noise=0.03, step=STEP, torque=TORQUE, times=1, **choices):
    read = step * np.round(ANGLE / step) if step else ANGLE + 1e-5 * RNG.standard_normal(len(T))
    columns = {"t": T, "q (rad)": read, name: torque + noise * RNG.standard_normal(len(T))}
    columns = {n: x if n == "t" else np.repeat(x[::times], times) for n, x in columns.items()}
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted}, remarks=())
    survey = survey_log(log, "log", Choices(**choices))
    return survey.channels["actuator_force"], " ".join(survey.notes)


@pytest.mark.parametrize("name", ["tau (Nm)", "motor current (A)", "effort"])
def test_the_scatter_of_a_force_that_was_read_is_its_noise(name):
    """A diagnosis took an encoder's steps for the only error: 138 noise floors were left, not 2."""
    entry, notes = channels(name)
    assert entry["noise"] == pytest.approx(0.03, rel=0.1)
    assert f"{name!r} scatters by" in notes


@pytest.mark.parametrize("name", ["cmd torque (Nm)", "u", "voltage (V)", "setCurrent"])
def test_the_scatter_of_a_command_acts_and_is_no_noise(name):
    entry, notes = channels(name)
    assert entry["column"] == name
    assert "noise" not in entry and "scatters" not in notes


def test_nothing_is_stated_where_a_diagnosis_estimates_noise_or_none_is_there():
    for entry, notes in (channels(step=0.0), channels(noise=0.0)):
        assert "noise" not in entry and "scatters" not in notes


@pytest.mark.parametrize(
    "torque",
    [
        RNG.standard_normal(len(T)),
        np.sign(RNG.standard_normal(len(T))),
        np.sign(np.sin(2 * np.pi * 37.0 * T)),
    ],
)
def test_a_force_that_is_tossed_from_row_to_row_is_an_excitation(torque):
    """Its scatter was stated as noise, 1.03 of its standard deviation: any model is adequate."""
    entry, notes = channels(torque=torque, actuator_force="tau (Nm)")
    assert "noise" not in entry and "scatters" not in notes
