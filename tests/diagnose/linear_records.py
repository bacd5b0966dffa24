"""Recordings of a linear device under tones, solved exactly, with noise on its recorded command."""

import numpy as np
from scipy.linalg import expm

import teleopdesign as td
from teleopdesign.diagnose.fit import estimate
from teleopdesign.measurement.prepare import prepare

MASS, DAMPING, STIFFNESS, STEP = 0.2, 1.5, 60.0, 2e-3
EFFECTS = ("viscous", "spring")
VALUES = {"inertia": MASS, "viscous.damping": DAMPING, "spring.stiffness": STIFFNESS}
#: N rms of noise of the command's reading, below 20 Hz, and m of the encoder's step
NOISE, ENCODER = 0.3, 1e-6


def true_response(frequency):
    """E/L of the device at frequencies in Hz, N/m, from its equation."""
    s = 2j * np.pi * np.asarray(frequency)
    return MASS * s**2 + DAMPING * s + STIFFNESS


def recordings(count, *, seconds=8.0, seed=1, noise=NOISE, disturbance=0.0):
    """Time (n,), and recorded command and position (count, n) of repeated recordings.

    noise: N rms, of the command's reading;  disturbance: N rms, of a force that nobody records
    """
    rng = np.random.default_rng(seed)
    time = STEP * np.arange(round(seconds / STEP))
    tones = np.linspace(0.4, 20.0, 120)
    phases = rng.uniform(0, 2 * np.pi, len(tones))
    command = 0.27 * np.sin(2 * np.pi * np.outer(time, tones) + phases).sum(axis=1)
    read, acts, keep = (*rng.standard_normal((2, len(time), count)), np.exp(-40.0 * np.pi * STEP))
    for k in range(1, len(time)):
        for one in (read, acts):
            one[k] = keep * one[k - 1] + np.sqrt(1 - keep**2) * one[k]
    rates = np.array([[0, 1, 0], [-STIFFNESS / MASS, -DAMPING / MASS, 1 / MASS], [0, 0, 0]])
    forward = expm(rates * STEP)
    state, position = np.zeros((2, count)), np.zeros((count, len(time)))
    for k in range(len(time)):
        position[:, k] = state[0]
        force = command[k] + disturbance * acts[k]
        state = forward[:2, :2] @ state + np.outer(forward[:2, 2], force)
    return time, command + noise * read.T, ENCODER * np.round(position / ENCODER)


def experiment(time, command, position, *, effects=EFFECTS):
    half = float(time[-1]) * 0.75
    return td.experiment(
        {"t": time, "x": position, "u": command},
        axis="prismatic",
        position={"column": "x", "unit": "m", "resolution": ENCODER},
        actuator_force="u",
        time="t",
        effects=effects,
        fit=[(0.0, half)],
        check=[(half, float(time[-1]))],
        bandwidth=25.0,
    )


def fitted(recorded):
    """The true structure, estimated on the fit record."""
    model = td.Model.from_experiment(recorded).with_values(
        {f"device.{name}": value for name, value in VALUES.items()}
    )
    return estimate(model, prepare(recorded))
