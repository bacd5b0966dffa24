"""A block along recorded rows, and its export compiled, is the block as the simulation steps it."""

import ctypes
import shutil
import subprocess
from functools import cache

import control
import numpy as np
import pytest
from devices import body

from teleopdesign.controllers import CONTROLLERS, Controller, Stage, controller, from_control
from teleopdesign.diagrams import haptic_interface
from teleopdesign.realise.c_header import as_c_header
from teleopdesign.realise.controller_along import controller_along
from teleopdesign.simulate import Sampling, Trajectory, simulate

PERIOD = 1e-3
NOTCH = control.tf([1.0, 6.0, 4e3], [1.0, 120.0, 4e3])
SECOND = control.ss([[-5.0, 2.0], [0.0, -9.0]], [[1.0], [2.0]], [[3.0, 1.0]], [[0.0]])
W = 30.0
MOTION = Trajectory(
    lambda t: 0.01 * (1 - np.cos(W * t)),
    lambda t: 0.01 * W * np.sin(W * t),
    lambda t: 0.01 * W**2 * np.cos(W * t),
)
compiled = pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")


def probe(name):
    law = CONTROLLERS[name]
    values = {n: min(max(2.0, p.lower), p.upper) for n, p in law.parameters.items()}
    return Controller((Stage(law, values),))


BLOCKS = {n: probe(n) for n in CONTROLLERS if CONTROLLERS[n].takes != "force"} | {
    "delay": controller("delay", {"time": 2.4e-3}),
    "transfer function": from_control(NOTCH),
    "state space": from_control(SECOND),
    "discrete": from_control(control.sample_system(NOTCH, PERIOD)),
    "in series": controller("low_pass", {"bandwidth": 20.0}).then(from_control(NOTCH)),
}


def library(text, folder):
    source, target = folder / "law.c", folder / "law.so"
    (folder / "law.h").write_text(text)
    source.write_text(
        '#include "law.h"\n'
        "void run(int n, const double *x, const double *v, double *out) {\n"
        "    law_state s;\n    law_start(&s);\n"
        "    for (int i = 0; i < n; i++) out[i] = law_step(&s, x[i], v[i], v[i]);\n}\n"
    )
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", "-O2"]
    done = subprocess.run(
        ["cc", *flags, str(source), "-o", str(target), "-lm"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return ctypes.CDLL(str(target))


@pytest.fixture(scope="module")
def simulated():
    """simulated(name): positions, velocities and outputs of a block, at 100 samples from rest."""

    @cache
    def run(name):
        made = simulate(
            haptic_interface(body(0.1), cancellation=BLOCKS[name]),
            duration=0.1,
            motion={"L": MOTION},
            computer=Sampling(period=PERIOD),
            step=PERIOD,
            jit=False,
        )
        x = np.ascontiguousarray(made["L"].values)
        return x, np.diff(x, prepend=x[0]) / PERIOD, made["R_MBC"].values

    return run


SOME = ("dahl", "low_pass", "delay", "velocity_schedule")


@pytest.mark.parametrize(
    "name", [n if n in SOME else pytest.param(n, marks=pytest.mark.slow) for n in BLOCKS]
)
def test_a_block_along_the_readings_is_that_of_the_simulation(name, simulated):
    """1e-9 of the range, here and below: rounding, and order of sums."""
    x, v, expected = simulated(name)
    out = controller_along(BLOCKS[name], input=x, velocity=v, travel_rate=v, period=PERIOD)
    assert np.abs(out - expected).max() <= 1e-9 * max(np.ptp(expected), 1e-12)


@pytest.mark.slow
@compiled
@pytest.mark.parametrize("name", BLOCKS)
def test_the_compiled_export_gives_the_output_of_the_block(name, simulated, tmp_path):
    x, v, expected = simulated(name)
    out = np.zeros_like(x)
    pointers = [a.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for a in (x, v, out)]
    library(as_c_header(BLOCKS[name], period=PERIOD, name="law"), tmp_path).run(len(x), *pointers)
    assert np.abs(out - expected).max() <= 1e-9 * max(np.ptp(expected), 1e-12)


@pytest.mark.slow
@compiled
@pytest.mark.parametrize("late", [1e-3, 2.4e-3])
def test_a_late_lag_is_the_difference_equation_that_it_is_by_hand(late, tmp_path):
    """y(n + 1) = y(n) + (1 - e^(-w T)) (u(n) - y(n)), u linear between samples; zero before."""
    block = controller("delay", {"time": late}).then(controller("low_pass", {"bandwidth": 20.0}))
    x = np.cos(0.2 * np.arange(40.0)) + 0.3
    out = np.zeros_like(x)
    pointers = [a.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for a in (x, x, out)]
    library(as_c_header(block, period=PERIOD, name="law"), tmp_path).run(len(x), *pointers)
    whole, part = divmod(round(late / PERIOD, 9), 1.0)
    before = np.concatenate([np.zeros(4), x])
    n = np.arange(40) + 4 - int(whole)
    u = (1.0 - part) * before[n] + part * before[n - 1]
    y, expected = 0.0, []
    for now in u:
        expected.append(y)
        y += (1.0 - np.exp(-2 * np.pi * 20.0 * PERIOD)) * (now - y)
    np.testing.assert_allclose(out, expected, rtol=1e-12, atol=1e-15)
