"""Worker processes that are copies of the calling process leave it, and each other, as they are."""

import _thread
import subprocess
import threading
import time

import numpy as np
import pytest
import study_models as models
import xarray
from study_processes import AXES, children, in_a_process, study_code, wait_for_points

import teleopdesign as td
from teleopdesign.studies import pool, worker_processes
from teleopdesign.studies.chosen_measures import measures_of
from teleopdesign.studies.evaluate import StudyTask
from teleopdesign.studies.journal import Journal
from teleopdesign.studies.points import points_of
from teleopdesign.studies.worker_processes import receive

copied = pytest.mark.usefixtures("copies")


def task_of(model, axes=AXES):
    return StudyTask(model, {}, points_of(axes), measures_of(models.value))


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
    copies = []
    start_copies = pool.start_copies

    def keep(*arguments):
        copies.extend(start_copies(*arguments))
        return copies

    def kill_all(progress):
        for copy in copies:
            copy.process.kill()

    monkeypatch.setattr(pool, "start_copies", keep)
    monkeypatch.setattr("teleopdesign.studies.outcomes._BETWEEN", 0.05)
    axes = {"x": np.arange(300.0), "y": 0.5}
    arguments = {"measures": models.value, "workers": 2, "progress": kill_all}
    dataset = td.study(models.slow_product, axes, **arguments)
    assert len(copies) == 2 and not dataset.failures
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
from teleopdesign.studies import pool
pool.start_anew = None
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


@copied
def test_a_copy_ends_when_its_pipe_ends_whatever_the_others_hold():
    first, second = worker_processes.start_copies(task_of(models.product), 2)
    first.questions.close()
    assert first.process.wait() == 0
    second.questions.close()
    assert second.process.wait() == 0
    first.close()
    second.close()


@copied
def test_a_copy_holds_no_lock_of_a_file(tmp_path):
    part = tmp_path / "s.nc.part"
    journal = Journal(part, "study", 1)
    (copy,) = worker_processes.start_copies(task_of(models.product), 1)
    assert receive(copy.answers) is None  # it is ready
    journal.close()
    Journal(part, "study", 1).close()  # where the copy had it, it would be in use
    copy.questions.close()
    assert copy.process.wait() == 0
    copy.close()


@pytest.mark.parametrize("begin", [_thread.start_new_thread, threading.Thread])
def test_a_process_with_another_thread_is_not_copied(begin):
    """Python counts threads of its module `threading`, but not those of libraries."""
    stay, is_over, before = threading.Event(), threading.Event(), children()

    def work():
        stay.wait()
        is_over.set()

    if begin is threading.Thread:
        begin(target=work).start()
    else:
        begin(work, ())
    try:
        assert worker_processes.start_copies(task_of(models.product), 2) == []
    finally:
        stay.set()
        is_over.wait(60)
    assert children() <= before


@pytest.mark.slow
def test_a_study_beside_another_thread_takes_processes_started_anew(monkeypatch):
    stay, started = threading.Event(), []
    start_anew = pool.start_anew
    monkeypatch.setattr(pool, "start_anew", lambda: started.append(start_anew()) or started[-1])
    other = threading.Thread(target=stay.wait)
    other.start()
    try:
        td.study(models.product, AXES, measures=models.value, workers=2)
    finally:
        stay.set()
        other.join()
    assert len(started) == 2


@copied
def test_copies_draw_different_numbers_without_a_seed():
    axes = {"number": np.arange(40.0)}
    drawn = td.study(models.drawn, axes, measures=models.value, workers=2)["value"].values
    assert len(set(drawn)) == 40


@copied
def test_a_worker_of_a_study_is_not_copied():
    dataset = td.study(models.can_be_copied, {"x": [1, 2]}, measures=models.value, workers=2)
    assert list(dataset["value"].values) == [0.0, 0.0]


@copied
def test_a_model_that_cannot_be_sent_needs_no_sending_to_a_copy():
    lock = threading.Lock()

    def locked(x):
        with lock:
            return x

    dataset = td.study(locked, {"x": [1.0, 2.0]}, measures=models.value, workers=2)
    assert list(dataset["value"].values) == [1.0, 2.0]
