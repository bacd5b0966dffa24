"""Worker processes that are copies of the calling process leave it, and each other, as they are."""

import _thread
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import study_models as models
import xarray
from study_processes import children, in_a_process, study_code, wait_for_points

import teleopdesign as td
from teleopdesign.studies import processes
from teleopdesign.studies.journal import Journal

copied = pytest.mark.usefixtures("copies")


@pytest.mark.slow
def test_simulations_in_processes_give_the_data_set_of_one(start):
    """Of 512 points side by side; the measure of a user needs each simulation by itself."""
    side_by_side = {"C.dahl.level": np.linspace(0.2, 1.2, 600), "C.dahl.stiffness": [1e4, 2e4]}
    arguments = {"measures": ["force_error", "energy_drawn"], **models.SIMULATED}
    one = td.study(models.interface(), side_by_side, workers=1, **arguments)
    two = td.study(models.interface(), side_by_side, workers=2, **arguments)
    xarray.testing.assert_identical(one.data, two.data)


@pytest.mark.slow
@copied
def test_every_copy_killed_in_the_middle_costs_no_point(monkeypatch):
    before, killed = children(), set()

    def kill_all(progress):
        if not killed:
            killed.update(children() - before)
            for number in killed:
                os.kill(int(number), signal.SIGKILL)

    monkeypatch.setattr("teleopdesign.studies.outcomes._BETWEEN", 0.05)
    axes = {"x": np.arange(300.0), "y": 0.5}
    arguments = {"measures": models.value, "workers": 2, "progress": kill_all}
    dataset = td.study(models.slow_product, axes, **arguments)
    assert len(killed) == 2 and not dataset.failures
    expected = [models.product(x, 0.5) for x in axes["x"]]
    np.testing.assert_array_equal(dataset["value"].values, expected)


@pytest.mark.slow
def test_an_interrupt_ends_all_processes(start, monkeypatch):
    def interrupt(progress):
        raise KeyboardInterrupt

    monkeypatch.setattr("teleopdesign.studies.outcomes._BETWEEN", 0.05)
    axes, begin = {"x": np.arange(1e5), "y": 0.5}, time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        arguments = {"measures": models.value, "workers": 2, "progress": interrupt}
        td.study(models.slow_product, axes, **arguments)
    assert time.monotonic() - begin < 60


@pytest.mark.slow
@copied
def test_copies_write_and_end_nothing_of_the_calling_process(tmp_path):
    """Text that waits to be written, functions for the exit, and handlers of signals are its."""
    code = """
import atexit, signal
print("before", end=" ")
atexit.register(print, "exit")
signal.signal(signal.SIGTERM, lambda *_: print("terminated", flush=True))
from teleopdesign.studies import processes
processes._started_anew = None
""" + study_code(tmp_path / "s.nc", "terminated_product", points=9, workers=2)
    with in_a_process(code, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.communicate(timeout=300) == ("before exit\n", "")
    assert td.read_study(tmp_path / "s.nc").failures == {}


@copied
@pytest.mark.slow
def test_copies_end_with_a_process_that_is_killed(tmp_path):
    out = tmp_path / "s.nc"
    code = study_code(out, points=100_000, workers=2)
    with in_a_process(code, stderr=subprocess.PIPE) as process:
        wait_for_points(out, 1)
        process.kill()
        begin = time.monotonic()
        assert process.stderr.read() == b""  # until the last process that may write has ended
        assert time.monotonic() - begin < 30


@pytest.mark.slow
@copied
def test_a_copy_holds_no_lock_of_a_file(tmp_path, monkeypatch):
    """A copy that outlives its study does not keep the study's file in use."""
    part, journal = tmp_path / "s.nc.part", []

    def close_and_open(progress):
        journal[0].close()
        Journal(part, "study", 1).close()  # where a copy had it, it would be in use

    journal.append(Journal(part, "study", 1))
    monkeypatch.setattr("teleopdesign.studies.outcomes._BETWEEN", -1.0)
    arguments = {"measures": models.value, "workers": 2, "progress": close_and_open}
    td.study(models.slow_product, {"x": np.arange(9.0), "y": 0.5}, **arguments)


@pytest.mark.slow
@pytest.mark.parametrize("begin", [None, _thread.start_new_thread, threading.Thread])
def test_only_a_process_without_other_threads_is_copied(begin, monkeypatch):
    """Python counts threads of its module `threading`, but not those of libraries."""
    stay, is_over = threading.Event(), threading.Event()

    def work():
        stay.wait()
        is_over.set()

    if begin is threading.Thread:
        begin(target=work).start()
    elif begin is not None:
        monkeypatch.setattr(processes, "can_copy", lambda: sys.platform == "linux")
        begin(work, ())
    else:
        monkeypatch.setattr(processes, "can_copy", lambda: sys.platform == "linux")
        monkeypatch.setattr(processes, "has_hidden_threads", lambda: False)
    monkeypatch.setattr(models, "mark", 1.0)
    try:
        dataset = td.study(models.has_mark, {"x": [1, 2, 3]}, measures=models.value, workers=2)
    finally:
        stay.set()
        if begin is not None:
            is_over.wait(60)
    expected = float(begin is None and sys.platform == "linux")
    assert list(dataset["value"].values) == [expected] * 3


@pytest.mark.slow
@copied
def test_copies_draw_different_numbers_without_a_seed():
    axes = {"number": np.arange(40.0)}
    drawn = td.study(models.drawn, axes, measures=models.value, workers=2)["value"].values
    assert len(set(drawn)) == 40


@pytest.mark.slow
@copied
def test_a_model_that_cannot_be_sent_needs_no_sending_to_a_copy():
    lock = threading.Lock()

    def locked(x):
        with lock:
            return x

    dataset = td.study(locked, {"x": [1.0, 2.0]}, measures=models.value, workers=2)
    assert list(dataset["value"].values) == [1.0, 2.0]
