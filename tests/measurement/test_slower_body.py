"""Two devices in one table: the readings of the slower one are repeated until its next reading."""

import numpy as np
import pandas as pd
import pytest

import teleopdesign as td
from teleopdesign.measurement.bandwidth import default_bandwidth

RATE, EVERY, STEP = 1000.0, 4, 1e-7
T = np.arange(12000) / RATE


def motion(t, body):
    """A motion of some centimetres; each body has its own."""
    f = {"master": 1.1, "slave": 0.8}[body]
    return 0.05 * np.sin(2 * np.pi * f * t) + 0.01 * np.sin(2 * np.pi * 3.7 * f * t)


def columns(held, commands):
    """The table of both; held, commands: rows for which a body's readings and its command stay."""
    table = {"t": T + 12.5}
    for body, rows in held.items():
        x = motion(T, body)[::rows].repeat(rows)
        force = np.sign(np.gradient(motion(T, body)))[:: commands[body]].repeat(commands[body])
        table |= {f"{body}_x": STEP * np.round(x / STEP), f"{body}_u": force}
    return table


MODEL = """
[model.{0}]
axis = "prismatic"
inertia = 0.2
[model.{0}.effects]
coulomb = {{}}
"""
CHANNELS = """
{0}.position = {{ column = "{0}_x", unit = "m", resolution = 1e-7 }}
{0}.actuator_force = {{ column = "{0}_u", unit = "N" }}
"""


def read(folder, held, commands=None):
    """The experiment of a table, with both bodies."""
    folder.mkdir(exist_ok=True)
    pd.DataFrame(columns(held, commands or held)).to_csv(
        folder / "log.csv", index=False, float_format="%.12g"
    )
    text = "".join(MODEL.format(body) for body in held)
    text += '\n[channels]\ntime = { column = "t", unit = "s" }\n'
    text += "".join(CHANNELS.format(body) for body in held)
    (folder / "experiment.toml").write_text(text + '\n[[records]]\nfile = "log.csv"\nuse = "fit"\n')
    return td.load_experiment(folder)


def test_the_readings_of_a_slower_body_are_interpolated_and_its_commands_held(tmp_path):
    record = read(tmp_path, {"master": 1, "slave": EVERY}).records[0]
    error = {b: record.signals[f"{b}.position"] - motion(T, b) for b in ("master", "slave")}
    # held readings err by up to 1.5e-3; nothing shows when the first one was taken
    assert np.abs(error["slave"][EVERY:-EVERY]).max() < 2e-5
    assert np.abs(error["master"]).max() < STEP
    commands = np.round(record.signals["slave.actuator_force"], 9)
    assert set(np.unique(commands)) <= {-1.0, 0.0, 1.0}
    assert record.rate_of("slave.position") == pytest.approx(RATE / EVERY, rel=1e-3)
    assert record.rate_of("master.position") == pytest.approx(RATE)
    assert any("slave.position has stamps of its own" in s.observed for s in record.reading)


def test_a_slower_sensor_of_one_of_two_bodies_leaves_its_command_as_it_is(tmp_path):
    record = read(tmp_path, {"master": 1, "slave": EVERY}, {"master": 1, "slave": 1}).records[0]
    error = record.signals["slave.position"] - motion(T, "slave")
    assert np.abs(error[EVERY:-EVERY]).max() < 2e-5
    command = np.sign(np.gradient(motion(T, "slave")))
    np.testing.assert_array_equal(record.signals["slave.actuator_force"], command)
    assert record.rate_of("slave.actuator_force") == pytest.approx(RATE)


def test_the_bandwidth_is_that_of_the_slower_body(tmp_path):
    rates = [{"master": 1, "slave": n} for n in (1, EVERY)]
    fast, slow = (default_bandwidth(read(tmp_path, held)) for held in rates)
    assert slow <= 0.1 * RATE / EVERY < fast


def test_a_log_whose_bodies_all_wait_for_one_source_has_fewer_rows(tmp_path):
    record = read(tmp_path, {"master": EVERY, "slave": EVERY}).records[0]
    assert record.sample_time == pytest.approx(EVERY / RATE, rel=1e-3)
    assert not any("stamps of its own" in s.observed for s in record.reading)
