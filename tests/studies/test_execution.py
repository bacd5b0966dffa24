"""Where and how often a study is stopped, killed or spread changes its time, never its numbers."""

import _thread
import random
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import study_models as models
import xarray

import teleopdesign as td
from teleopdesign.errors import ExperimentError, ModelError
from teleopdesign.studies import pool, processes, worker_processes
from teleopdesign.studies.chosen_measures import measures_of
from teleopdesign.studies.evaluate import StudyTask
from teleopdesign.studies.frames import receive
from teleopdesign.studies.journal import Journal
from teleopdesign.studies.points import points_of

TESTS = Path(__file__).parents[1]
AXES = {"x": np.arange(6.0), "y": np.linspace(0.1, 1.0, 5)}
EXPECTED = AXES["x"][:, None] * np.sin(AXES["y"])


def in_a_process(code, *, limit="", **options):
    """Start Python with this package and these tests in reach."""
    head = f"import sys; sys.path[:0] = [{str(TESTS)!r}, {str(TESTS.parent)!r}]\n{limit}\n"
    return subprocess.Popen([sys.executable, "-c", head + code], **options)


def study_code(out, model="slow_product", points=300, **more):
    """A study of `points` points that writes into `out`."""
    arguments = "".join(f", {k}={v!r}" for k, v in more.items())
    return (
        "import numpy as np, teleopdesign as td, study_models as models\n"
        f"td.study(models.{model}, {{'x': np.arange({points}.0), 'y': 0.5}}, "
        f"measures=models.value, out={str(out)!r}{arguments})\n"
    )


copied = pytest.mark.usefixtures("copies")


@pytest.fixture
def copies(monkeypatch):
    """Processes of a study are copies of this one, also beside the thread that tests come from."""
    if sys.platform != "linux":
        pytest.skip("processes are copied on Linux only")
    for module in (processes, worker_processes):
        monkeypatch.setattr(module, "can_copy", lambda: True)
    monkeypatch.setattr(worker_processes, "has_hidden_threads", lambda: False)


def anew(monkeypatch):
    """From now on no process is copied."""
    for module in (processes, worker_processes):
        monkeypatch.setattr(module, "can_copy", lambda: False)


def children():
    """Processes that this one started and has not waited for."""
    listed = Path("/proc/self/task").glob("*/children")  # none where there is no such folder
    return {number for file in listed for number in file.read_text().split()}


@pytest.fixture(params=("copies", "anew"))
def start(request, monkeypatch):
    """How the processes of a study start; checked at the end."""
    starts, before = {"copies": 0, "anew": 0}, children()

    def counted(name, function):
        def count(*arguments):
            processes = function(*arguments)
            starts[name] += len(processes) if name == "copies" else 1
            return processes

        return count

    if request.param == "anew":
        anew(monkeypatch)
    else:
        request.getfixturevalue("copies")
    monkeypatch.setattr(pool, "start_copies", counted("copies", pool.start_copies))
    monkeypatch.setattr(pool, "start_anew", counted("anew", pool.start_anew))
    yield request.param
    assert starts["copies"] == (2 if request.param == "copies" else 0)
    assert children() <= before


@pytest.mark.slow
def test_two_processes_give_the_data_set_of_one(start):
    one = td.study(models.product, AXES, measures=models.value, workers=1)
    two = td.study(models.product, AXES, measures=models.value, workers=2)
    xarray.testing.assert_identical(one.data, two.data)
    np.testing.assert_array_equal(
        one["value"].values, [[x * np.sin(y) for y in AXES["y"]] for x in AXES["x"]]
    )


@pytest.mark.slow
def test_functions_without_a_name_go_to_other_processes_too():
    offset = 3.0
    dataset = td.study(lambda x: x + offset, {"x": [1.0, 2.0]}, measures=lambda r: r, workers=2)
    assert list(dataset["measure"].values) == [4.0, 5.0]


@pytest.mark.slow
def test_ctrl_c_while_a_process_still_starts_costs_no_point_and_prints_nothing(monkeypatch, capfd):
    anew(monkeypatch)
    start = subprocess.Popen

    def start_and_interrupt(*arguments, **options):
        process = start(*arguments, **options)
        process.send_signal(signal.SIGINT)  # before Python has read its first line
        return process

    monkeypatch.setattr(subprocess, "Popen", start_and_interrupt)
    dataset = td.study(models.product, AXES, measures=models.value, workers=2)
    np.testing.assert_allclose(dataset["value"].values, EXPECTED, rtol=1e-15)
    assert capfd.readouterr().err == ""


@pytest.mark.slow
@pytest.mark.parametrize("number", [0, 1])
def test_a_process_that_is_killed_before_its_first_point_is_replaced(monkeypatch, number):
    anew(monkeypatch)
    start, processes = subprocess.Popen, []

    def start_and_kill_one(*arguments, **options):
        processes.append(start(*arguments, **options))
        if len(processes) == number + 1:
            processes[number].kill()
        return processes[-1]

    monkeypatch.setattr(subprocess, "Popen", start_and_kill_one)
    dataset = td.study(models.product, AXES, measures=models.value, workers=2)
    assert len(processes) == 3 and not dataset.failures
    np.testing.assert_allclose(dataset["value"].values, EXPECTED, rtol=1e-15)


@pytest.mark.slow
def test_processes_that_all_end_before_their_first_point_are_one_line(monkeypatch):
    anew(monkeypatch)
    monkeypatch.setattr(sys, "executable", "/bin/false")
    with pytest.raises(ModelError, match="ended before its first point, with status 1"):
        td.study(models.product, AXES, measures=models.value, workers=2)


@pytest.mark.slow
def test_a_point_whose_process_is_killed_is_computed_again(start, tmp_path):
    axes = {**AXES, "folder": str(tmp_path)}
    dataset = td.study(models.deadly_product, axes, measures=models.value, workers=2)
    assert (tmp_path / "killed").exists()
    np.testing.assert_allclose(dataset["value"].values, EXPECTED, rtol=1e-15)


@pytest.mark.slow
def test_a_point_that_kills_its_process_every_time_is_a_failure_and_no_other_is(start):
    dataset = td.study(models.lethal_product, AXES, measures=models.value, workers=2)
    assert dataset.failures == {"its process ended twice, by signal 9": 1}
    expected = EXPECTED.copy()
    expected[3, 0] = np.nan
    np.testing.assert_allclose(dataset["value"].values, expected, rtol=1e-15)


def test_progress_says_how_many_are_done_and_ends_with_all():
    reports = []
    td.study(models.product, AXES, measures=models.value, progress=reports.append, workers=1)
    assert reports[-1].done == reports[-1].total == 30
    assert str(reports[-1]).startswith("30 of 30 points")


def test_a_file_that_holds_the_study_is_not_computed_again(tmp_path):
    out = tmp_path / "s.nc"
    first = td.study(models.product, AXES, measures=models.value, out=out)
    written = out.stat().st_mtime_ns
    again = td.study(models.product, AXES, measures=models.value, out=out)
    assert out.stat().st_mtime_ns == written
    np.testing.assert_array_equal(first["value"].values, again["value"].values)
    assert [p.name for p in tmp_path.iterdir()] == ["s.nc"]


@pytest.mark.slow
def test_another_study_never_takes_the_place_of_one(tmp_path):
    out = tmp_path / "s.nc"
    td.study(models.product, AXES, measures=models.value, out=out)
    with pytest.raises(ExperimentError, match="holds another study"):
        td.study(models.product, {**AXES, "x": [1.0]}, measures=models.value, out=out)
    with pytest.raises(ExperimentError, match="holds another study"):
        td.study(models.slow_product, AXES, measures=models.value, out=out)


def test_what_an_interrupted_study_has_finished_is_not_computed_again(tmp_path):
    """Every point leaves a mark when it is computed: none leaves two."""
    out, count = tmp_path / "s.nc", [0]

    def marked(x):
        count[0] += 1
        if count[0] == 7:
            raise KeyboardInterrupt
        return x

    # the same study: what the function encloses is its own, and counted before it changes
    axes = {"x": np.arange(10.0)}
    with pytest.raises(KeyboardInterrupt):
        td.study(marked, axes, measures=models.value, out=out, workers=1)
    lines = (tmp_path / "s.nc.part").read_text().splitlines()
    assert sum('"point"' in line for line in lines) == 6
    count[0] = 0
    dataset = td.study(marked, axes, measures=models.value, out=out, workers=1)
    assert count[0] == 4
    np.testing.assert_array_equal(dataset["value"].values, np.arange(10.0))
    assert [p.name for p in tmp_path.iterdir()] == ["s.nc"]


def damaged_journal(tmp_path, damage):
    """A study of 10 points, of which 6 stand in a journal whose last line is damaged."""
    out = tmp_path / "s.nc"

    def stopped(progress):
        if progress.done >= 6:
            raise KeyboardInterrupt

    axes = {"x": np.arange(10.0), "y": 0.5}
    from teleopdesign.studies import progress as module

    module._BETWEEN, before = -1.0, module._BETWEEN
    try:
        with pytest.raises(KeyboardInterrupt):
            td.study(
                models.product, axes, measures=models.value, out=out, workers=1, progress=stopped
            )
    finally:
        module._BETWEEN = before
    part = tmp_path / "s.nc.part"
    part.write_bytes(damage(part.read_bytes()))
    first = []
    dataset = td.study(
        models.product, axes, measures=models.value, out=out, workers=1, progress=first.append
    )
    return first[-1].kept, dataset


@pytest.mark.parametrize(
    ("damage", "kept"),
    [
        (lambda data: data, 6),
        (lambda data: data[:-1], 5),  # the last line has no end
        (lambda data: data[:-9], 5),
        (lambda data: data[:-3] + b"9" + data[-2:], 5),  # a digit of the last line is another
        (lambda data: data + b"0000", 6),
        (lambda data: data + b"\0" * 4096, 6),  # a system that crashed leaves zeros
        (lambda data: b"", 0),
    ],
)
def test_a_broken_end_of_the_kept_points_is_cut_off_and_computed_again(tmp_path, damage, kept):
    kept_points, dataset = damaged_journal(tmp_path, damage)
    assert kept_points == kept
    np.testing.assert_array_equal(
        dataset["value"].values, [models.product(x, 0.5) for x in np.arange(10.0)]
    )


@pytest.mark.slow
def test_points_of_another_study_are_not_taken_up(tmp_path):
    out = tmp_path / "s.nc"
    out.with_name("s.nc.part").write_text("")
    with in_a_process(study_code(out, points=100_000), stderr=subprocess.DEVNULL) as process:
        wait_for_points(out, 5)
        process.kill()
    with pytest.raises(ExperimentError, match="holds points of another study"):
        td.study(models.product, AXES, measures=models.value, out=out)


def wait_for_points(out, count, limit=300.0):
    """Wait until that many points are kept."""
    part, end = out.with_name(f"{out.name}.part"), time.monotonic() + limit
    while time.monotonic() < end:
        if out.exists() or (part.exists() and part.read_bytes().count(b'"point":') >= count):
            return
        time.sleep(0.01)
    raise AssertionError(f"no point within {limit:.0f} s")


@pytest.mark.slow
def test_two_processes_do_not_write_into_one_file(tmp_path):
    out = tmp_path / "s.nc"
    with in_a_process(study_code(out, points=100_000), stderr=subprocess.DEVNULL) as process:
        wait_for_points(out, 1)
        try:
            axes = {"x": np.arange(100_000.0), "y": 0.5}
            with pytest.raises(ExperimentError, match="another process computes this study"):
                td.study(models.slow_product, axes, measures=models.value, out=out)
        finally:
            process.kill()


@pytest.mark.slow
def test_a_full_disk_ends_in_one_line_and_keeps_every_finished_point(tmp_path):
    """The system refuses files over 4 kB, as a full disk refuses more: in the middle of a line."""
    out = tmp_path / "s.nc"
    limit = (
        "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))\n"
        "sys.dont_write_bytecode = True"  # Python 3.11 would leave it half, for all who follow
    )
    code = (
        "from teleopdesign.errors import TeleopDesignError\n"
        "try:\n    " + "\n    ".join(study_code(out, "product", 500).splitlines()) + "\n"
        "except TeleopDesignError as error:\n    print(error)\n"
    )
    with in_a_process(code, limit=limit, stdout=subprocess.PIPE, text=True) as process:
        output, _ = process.communicate(timeout=300)
    assert "cannot be written" in output and output.count("\n") == 1
    kept = int(output.split(" of 500 points are kept")[0].split()[-1])
    assert kept > 10
    first = []
    dataset = td.study(
        models.product,
        {"x": np.arange(500.0), "y": 0.5},
        measures=models.value,
        out=out,
        progress=first.append,
    )
    assert first[-1].kept == kept
    np.testing.assert_array_equal(
        dataset["value"].values, [models.product(x, 0.5) for x in np.arange(500.0)]
    )


@pytest.mark.slow
def test_after_kills_at_random_times_no_finished_point_is_lost_and_none_is_wrong(tmp_path):
    out, choose = tmp_path / "s.nc", random.Random(1)
    part, points, kept = tmp_path / "s.nc.part", 40_000, 0
    for run in range(2):  # with one process and with two
        process = in_a_process(
            study_code(out, points=points, workers=1 + run % 2), stderr=subprocess.DEVNULL
        )
        with process:
            wait_for_points(out, kept + 1)
            time.sleep(choose.uniform(0.0, 0.3))
            assert process.poll() is None
            process.send_signal(signal.SIGKILL)
        now = part.read_bytes().count(b'"point":')
        assert now > kept  # what was there stays, and each run adds to it
        kept = now
    values = _kept_values(part)
    assert len(values) >= kept - 1  # the last line may be broken
    assert all(v == models.product(i, 0.5) for i, v in values.items())
    assert len(values) == len(set(values))


def _kept_values(part):
    import json

    values = {}
    for line in part.read_bytes().splitlines(keepends=True):
        if b'"point":' in line and line.endswith(b"\n"):
            content = json.loads(line.split(b" ", 1)[1])
            assert content["point"] not in values
            values[content["point"]] = content["values"][0]
    return values


# ---- copies of the calling process ----------------------------------------------------------


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
    monkeypatch.setattr("teleopdesign.studies.progress._BETWEEN", 0.05)
    axes = {"x": np.arange(300.0), "y": 0.5}
    arguments = {"measures": models.value, "workers": 2, "progress": kill_all}
    dataset = td.study(models.slow_product, axes, **arguments)
    assert len(copies) == 2 and not dataset.failures
    expected = [models.product(x, 0.5) for x in axes["x"]]
    np.testing.assert_array_equal(dataset["value"].values, expected)


def test_an_interrupt_ends_all_processes(start, monkeypatch):
    def interrupt(progress):
        raise KeyboardInterrupt

    monkeypatch.setattr("teleopdesign.studies.progress._BETWEEN", 0.05)
    axes, begin = {"x": np.arange(1e5), "y": 0.5}, time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        arguments = {"measures": models.value, "workers": 2, "progress": interrupt}
        td.study(models.slow_product, axes, **arguments)
    assert time.monotonic() - begin < 60


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


# ---- a cluster ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def cluster():
    """A scheduler and two workers, each a process of its own."""
    distributed = pytest.importorskip("distributed")
    made = distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=True,
        dashboard_address=None,
        host="127.0.0.1",
        silence_logs=50,
    )
    yield made
    made.close(timeout=20)


@pytest.mark.slow
def test_a_cluster_gives_the_data_set_of_one_process(cluster):
    axes = {"C.dahl.level": np.linspace(0.2, 1.2, 4), "computer.delay": [0, 1.5e-4, 1e-3]}
    arguments = {"measures": ["force_error", "energy_drawn"], **models.SIMULATED}
    one = td.study(models.interface(), axes, workers=1, **arguments)
    two = td.study(models.interface(), axes, workers=2, **arguments)
    spread = td.study(models.interface(), axes, scheduler=cluster.scheduler_address, **arguments)
    xarray.testing.assert_identical(one.data, two.data)
    xarray.testing.assert_identical(one.data, spread.data)
    assert sum(one.failures.values()) == 4


@pytest.mark.slow
def test_a_worker_of_a_cluster_that_is_killed_costs_no_point(cluster, tmp_path):
    axes = {"x": np.arange(500.0), "y": 0.5, "folder": str(tmp_path)}
    arguments = {"measures": models.value, "scheduler": cluster.scheduler_address}
    dataset = td.study(models.deadly_product, axes, **arguments)
    assert (tmp_path / "killed").exists()
    np.testing.assert_array_equal(
        dataset["value"].values, [models.product(x, 0.5) for x in axes["x"]]
    )


@pytest.mark.slow
def test_a_cluster_that_does_not_answer_is_one_line():
    pytest.importorskip("distributed")
    with pytest.raises(ExperimentError, match="no scheduler answers at tcp://127.0.0.1:1"):
        td.study(models.product, AXES, measures=models.value, scheduler="tcp://127.0.0.1:1")


def test_workers_and_a_cluster_are_one_or_the_other():
    with pytest.raises(ModelError, match="a cluster has its own workers"):
        td.study(models.product, AXES, measures=models.value, scheduler="tcp://a:1", workers=2)
    with pytest.raises(ModelError, match="expected 1 or more"):
        td.study(models.product, AXES, measures=models.value, workers=0)
