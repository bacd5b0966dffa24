"""A lag or a delay of a held command, against the transfer function that it is."""

from dataclasses import replace

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.measurement.prepare import prepare
from teleopdesign.realise.along_motion import residual_along


def response(body, motion, frequency):
    """Acting force over the held command of that frequency, complex."""
    wave = np.exp(2j * np.pi * frequency * motion.time)
    driven = replace(motion, command=wave.real)
    rows = slice(len(wave) // 4, -len(wave) // 4)  # away from the ends

    def phasor(signal):
        size, *_ = np.linalg.lstsq(
            np.column_stack([wave.real[rows], -wave.imag[rows]]), signal[rows], rcond=None
        )
        return complex(*size)

    acting = residual_along(body, driven).acting.value
    return phasor(acting) / phasor(driven.at_rows(driven.command))


@pytest.mark.parametrize("time", [0.2, 0.8, 3.0])  # in samples
@pytest.mark.parametrize("effect", ["actuator_lag", "actuation_delay"])
def test_what_acts_is_the_command_through_its_transfer_function(effect, time):
    experiment = td.load_experiment(td.example("rod"))
    (motion,) = [s.motion for s in prepare(experiment, bandwidth=60.0).of("fit")]
    tau = time * motion.sample_time
    name = {"actuator_lag": "time_constant", "actuation_delay": "delay"}[effect]
    body = td.Model.from_experiment(experiment).body("device")
    body = body.with_effect(td.EFFECTS[effect], {name: tau})
    frequency = 55.0
    s = 2j * np.pi * frequency
    expected = 1 / (1 + s * tau) if effect == "actuator_lag" else np.exp(-s * tau)
    # averages over a quarter of a row: (omega T/4)^2/8 = 1e-3; over whole rows it is 1.5e-2
    assert abs(response(body, motion, frequency) - expected) < 1.5e-3


@pytest.mark.parametrize("quarters", [0.0, 0.1, 0.5, 1.0, 1.5, 12.3])
def test_a_delay_amid_a_hold_weakens_no_wave(quarters):
    experiment = td.load_experiment(td.example("rod"))
    (motion,) = [s.motion for s in prepare(experiment, bandwidth=60.0).of("fit")]
    tau = quarters * motion.sample_time / 4
    body = td.Model.from_experiment(experiment).body("device")
    body = body.with_effect(td.EFFECTS["actuation_delay"], {"delay": tau})
    for frequency in (20.0, 55.0):
        acting = response(body, motion, frequency)
        assert abs(acting - np.exp(-2j * np.pi * frequency * tau)) < 1e-5
