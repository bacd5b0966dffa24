"""A log that samples a faster controller: its scatter is no missing physics."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose.stand_ins import Leaves
from diagnose.stand_ins import fit as made_fit

import teleopdesign as td
from teleopdesign.diagnose import between_rows as module
from teleopdesign.diagnose.between_rows import (
    command_scatter,
    floor_between_rows,
    is_amid_a_row,
    with_noise,
)
from teleopdesign.diagnose.criteria import CRITERIA
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.learnable import Learnable
from teleopdesign.diagnose.noise_floor import NoiseFloor, noise_floor
from teleopdesign.diagnose.record_shift import RecordShift
from teleopdesign.measurement.prepare import prepare
from teleopdesign.model import Model

INERTIA, DAMPING = 0.5, 2.0  # kg*m^2, N*m*s/rad
SCATTER = 0.4  # N*m rms, drawn anew each millisecond: it acts, as all of the command does

EXPERIMENT = """title = "Sampled"
[model.device]
axis = "revolute"
inertia = { value = 0.5, unit = "kg*m^2", fixed = false }
[model.device.effects.viscous]
damping = { value = 2.0, unit = "N*m*s/rad" }
[channels]
time = { column = "t", unit = "s" }
position = { column = "q", unit = "rad", resolution = 1e-6 }
actuator_force = { column = "u", unit = "N*m" }
[comparison]
bandwidth = { value = 12, unit = "Hz" }
[[records]]
file = "fit.csv"
use = "fit"
[[records]]
file = "check.csv"
use = "check"
"""


def simulate(seed, seconds=30, held=1):
    """t, q, u at 1 kHz: inertia and damping, a controller that follows a motion, and scatter.

    held: ms for which the controller holds its command
    """
    rng, n, step = np.random.default_rng(seed), 1000 * seconds, 1e-3
    t = np.arange(n) * step
    wanted = 0.8 * np.sin(1.9 * t) + 0.2 * np.sin(5.3 * t + seed)
    q, v, positions, commands = wanted[0], 0.0, np.empty(n), np.empty(n)
    decay = np.exp(-DAMPING / INERTIA * step)
    for k in range(n):
        positions[k] = q
        if k % held == 0:
            command = 400 * (wanted[k] - q) - 20 * v + SCATTER * rng.standard_normal()
        commands[k] = command
        final = commands[k] / DAMPING
        q += final * step + (v - final) * (1 - decay) * INERTIA / DAMPING
        v = final + (v - final) * decay
    return t, positions, commands


@pytest.fixture(scope="module")
def runs():
    return {"fit": simulate(1), "check": simulate(2)}


def logged(folder, runs, every=8):
    """The experiment with each so many-th row of the runs."""
    folder.mkdir()
    (folder / "experiment.toml").write_text(EXPERIMENT)
    for name, (t, q, u) in runs.items():
        rows = np.column_stack([t, q, u])[::every]
        np.savetxt(folder / f"{name}.csv", rows, delimiter=",", header="t,q,u", comments="")
    return td.load_experiment(folder)


def floors(experiment, learned=0.0):
    """Floor by the sensors, the one that counts in the end, and the fit."""
    prepared = prepare(experiment)
    fit = estimate(Model.from_experiment(experiment), prepared)
    first = noise_floor(fit.model, prepared, np.random.default_rng(0))
    left = fit.check_error
    box = Learnable(left=left, error=(1.0 - learned) * left, alone=1.0)
    return first, floor_between_rows(fit, first, box, prepared, np.random.default_rng(0)), fit


def test_what_a_slow_log_cannot_hold_is_no_missing_physics(runs, tmp_path):
    experiment = logged(tmp_path / "slow", runs)
    first, last, fit = floors(experiment)
    assert fit.check_error > 10 * first.value, "by its sensors alone the model leaves much"
    assert last.source == f"{first.source}, and a command that changes within a row"
    assert last.value == fit.check_error <= 1.3 * last.drawn
    assert fit.model.parameters["device.inertia"].value == pytest.approx(INERTIA, rel=0.02)
    scatter = command_scatter(experiment, {"device"})
    assert scatter["device.actuator_force"] == pytest.approx(SCATTER, rel=0.15)


def test_what_a_black_box_learns_from_the_motion_is_no_scatter(runs, tmp_path):
    experiment = logged(tmp_path / "slow", runs)
    first, last, _ = floors(experiment, learned=1.5 * CRITERIA.repeats)
    assert last is first


def test_a_command_that_is_held_for_its_row_acts_and_is_no_noise(tmp_path):
    """The model lacks a constant force, and the scatter of the command hides none of it."""
    runs = {"fit": simulate(1, held=8), "check": simulate(2, held=8)}
    first, last, fit = floors(logged(tmp_path / "held", runs))
    assert last is first and fit.check_error < 1.8 * first.value
    for name, (t, q, u) in runs.items():
        runs[name] = t, q, u + 0.02
    first, last, fit = floors(logged(tmp_path / "pushed", runs))
    assert last is first and fit.check_error > 1.8 * first.value
    assert abs(fit.model.record_shift["device"].value) < 0.1 * 8e-3


def test_more_than_the_scatter_makes_is_still_missing(runs, tmp_path):
    experiment = logged(tmp_path / "friction", runs)
    prepared = prepare(experiment)
    fit = estimate(Model.from_experiment(experiment), prepared)
    more = replace(fit, check_error=5.0 * fit.check_error)
    first = noise_floor(fit.model, prepared, np.random.default_rng(0))
    box = Learnable(left=more.check_error, error=more.check_error, alone=1.0)
    assert floor_between_rows(more, first, box, prepared, np.random.default_rng(0)) is first
    assert floor_between_rows(fit, first, None, prepared, np.random.default_rng(0)) is first


def test_noise_that_is_stated_stays_as_it_is(runs, tmp_path):
    experiment = logged(tmp_path / "slow", runs)
    stated = with_noise(experiment, {"device.actuator_force": 0.01})
    assert command_scatter(stated, {"device"}) == {}
    assert command_scatter(experiment, set()) == {}


@pytest.mark.parametrize("row", [1e-3, 8e-3, 2.0])
def test_a_command_amid_its_row_is_late_by_three_to_seven_tenths_of_it_and_surely_so(row):
    def amid(late, error=0.0, measured=False):
        return is_amid_a_row(
            RecordShift("device", late * row, error * row, row, False, 1.0, measured)
        )

    assert amid(0.31) and amid(0.5) and amid(0.69)
    assert not amid(0.29) and not amid(0.71) and not amid(-0.5) and not amid(1.5)
    assert amid(0.4, 0.09) and not amid(0.4, 0.11), "it may as well be late by less"
    assert amid(0.6, 0.09) and not amid(0.6, 0.11)
    assert not amid(0.5, measured=True)


@pytest.mark.parametrize("size", [1e-3, 0.5, 20.0])
def test_the_scatter_of_a_command_is_that_of_the_middle_record(runs, tmp_path, size):
    """Each record has noise of its own; a record that is quiet or loud moves it by little."""
    experiment, rng = logged(tmp_path / "slow", runs), np.random.default_rng(0)
    name, still = "device.actuator_force", experiment.records[0]
    n = len(still.signals[name])
    records = tuple(
        replace(still, signals={**still.signals, name: size * by * rng.standard_normal(n)})
        for by in (0.1, 1.0, 30.0)
    )
    (scatter,) = command_scatter(replace(experiment, records=records), {"device"}).items()
    assert scatter == (name, pytest.approx(size, rel=0.1))
    quiet = replace(still, signals={**still.signals, name: np.ones(n)})
    assert command_scatter(replace(experiment, records=(quiet,)), {"device"}) == {}
    assert command_scatter(replace(experiment, records=records), {"slave"}) == {}


def test_only_the_channel_whose_noise_is_stated_has_it(runs, tmp_path):
    experiment = logged(tmp_path / "slow", runs)
    stated = with_noise(experiment, {"device.actuator_force": 0.01})
    assert stated.channels["device.actuator_force"].noise == 0.01
    other = "device.position"
    assert stated.channels[other] == experiment.channels[other]
    assert stated.channels.keys() == experiment.channels.keys()


@pytest.mark.parametrize("size", [0.1, 10.0])
def test_what_does_not_repeat_may_be_learned_to_a_tenth(runs, tmp_path, monkeypatch, size):
    """Of what is left, whatever that is."""
    drawn = NoiseFloor(size, "drawn", size)
    monkeypatch.setattr(module, "noise_floor", lambda *_: drawn)
    monkeypatch.setattr(
        module, "shifts_of", lambda *_: [RecordShift("device", 4e-3, 0, 8e-3, False, 1, False)]
    )
    prepared = prepare(logged(tmp_path / "slow", runs))
    fit = made_fit(0.9 * size)
    first = NoiseFloor(0.01 * size, "first", 0.01 * size)
    for part, is_scatter in [(0.09, True), (0.11, False)]:
        box = Learnable(left=size, error=(1 - part) * size, alone=size)
        last = floor_between_rows(fit, first, box, prepared, None)
        assert (last is not first) == is_scatter
        assert not is_scatter or last.value == 0.9 * size, "no floor lies above what a model leaves"
    box = Learnable(left=size, error=size, alone=size)
    for error, is_scatter in [(1.79 * size, True), (1.81 * size, False)]:
        left = Leaves(**{**vars(fit), "check_error": error})
        last = floor_between_rows(left, first, box, prepared, None)
        assert (last is not first) == is_scatter
    # what is noise by the sensors alone needs no scatter
    louder = NoiseFloor(0.6 * size, "first", 0.6 * size)
    assert floor_between_rows(fit, louder, box, prepared, None) is louder
