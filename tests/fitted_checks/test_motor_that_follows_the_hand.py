"""A motor whose force is computed from that of the hand: the motion tells no ratio of the two."""

import numpy as np
import pytest
from measurement.columns_by_hand import look

import teleopdesign as td
from teleopdesign.fitted_checks import check_experiment

T = 0.001 * np.arange(8000)
HAND = sum(a * np.sin(2 * np.pi * f * T + f) for a, f in ((2.0, 0.4), (1.4, 1.1), (1.0, 2.3)))
MOTOR = 0.25 * np.sin(2 * np.pi * 0.7 * T) + 0.25 * np.sin(2 * np.pi * 1.3 * T)


def moved(force):
    """Position of 0.4 kg with friction of 0.8 N and 20 N s/m, by steps of a tenth of a row."""
    x = v = 0.0
    positions = []
    for now in np.repeat(force, 10):
        v += 1e-4 * (now - 0.8 * np.tanh(v / 1e-3) - 20.0 * v) / 0.4
        x += 1e-4 * v
        positions.append(x)
    return np.array(positions[9::10])


def log_of_motor(motor):
    noise = 0.01 * np.random.default_rng(0).standard_normal(len(T))
    return {"t": T, "x_m": moved(motor + HAND), "u_N": motor, "f_hand_N": HAND + noise}


@pytest.mark.parametrize("gain", [0.5, 1.0, 3.0])
def test_its_signs_are_those_of_the_log(gain):
    survey = look(log_of_motor(gain * HAND))
    channels = survey.channels
    assert channels["interaction_force"]["column"] == "f_hand_N"
    assert not any("sign" in channels[key] for key in ("position", "interaction_force"))
    assert not any("factor" in note for note in survey.notes)


@pytest.mark.parametrize("gain", [0.5, 3.0])
def test_a_check_says_nothing_against_them(gain):
    keys = {"position": "x_m", "actuator_force": "u_N", "interaction_force": "f_hand_N"}
    channels = {q: {"column": n, "unit": n[-1]} for q, n in keys.items()}
    table = log_of_motor(gain * HAND)
    experiment = td.experiment(table, time="t", axis="prismatic", inertia=0.4, **channels)
    topics = {f.topic for f in check_experiment(experiment) if f.concern == "warning"}
    assert not topics & {"signs", "units"}


@pytest.mark.parametrize("copy", [False, True])
def test_a_hand_that_moves_the_device_is_not_its_motor(copy):
    """The motion explains the hand's force and its filtered copy, and little of the motor's."""
    table = log_of_motor(MOTOR)
    if copy:
        table["f_filt_N"] = np.convolve(HAND, np.full(9, 1 / 9), "same")
    channels = look(table).channels
    assert channels["actuator_force"]["column"] == "u_N"
    assert channels["interaction_force"]["column"] == "f_hand_N"


def test_a_wrong_sign_of_the_hand_is_turned():
    table = log_of_motor(2.0 * MOTOR)
    table["f_hand_N"] = -table["f_hand_N"]
    assert look(table).channels["interaction_force"]["sign"] == -1
