"""Work on all cores: results as on one core, whatever happens to a copy of the process."""

import os
import signal
import sys
import time

import pytest

from teleopdesign.diagnose import cores
from teleopdesign.diagnose.cores import map_in_threads, map_on_cores

copied = pytest.mark.skipif(sys.platform != "linux", reason="processes are copied on Linux only")


@pytest.fixture(params=("copies", "alone"))
def work(request, monkeypatch):
    """How the parts are computed."""
    if request.param == "copies" and sys.platform != "linux":
        pytest.skip("processes are copied on Linux only")
    monkeypatch.setattr(cores, "can_copy", lambda: request.param == "copies")
    monkeypatch.setattr(cores, "count_workers", lambda: 3)
    return request.param


def test_results_keep_the_order_of_the_arguments(work):
    assert map_in_threads(lambda x, y: x - y, range(50), [1] * 50) == [x - 1 for x in range(50)]
    assert map_on_cores(lambda x: x - 1, range(50)) == [x - 1 for x in range(50)]


def test_this_process_raises_the_error_of_a_part(work):
    def fail_at_three(x):
        if x == 3:
            raise ZeroDivisionError("part 3")
        return x

    with pytest.raises(ZeroDivisionError, match="part 3"):
        map_on_cores(fail_at_three, range(6))


@copied
def test_a_copy_that_is_killed_loses_nothing(monkeypatch):
    here = os.getpid()
    monkeypatch.setattr(cores, "can_copy", lambda: True)
    monkeypatch.setattr(cores, "count_workers", lambda: 2)

    def die_at_two(x):
        if x == 2 and os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        return 10 * x

    assert map_on_cores(die_at_two, range(5)) == [0, 10, 20, 30, 40]


@copied
def test_an_interrupt_ends_the_copies(monkeypatch):
    monkeypatch.setattr(cores, "can_copy", lambda: True)
    monkeypatch.setattr(cores, "count_workers", lambda: 2)

    def interrupt(_):
        raise KeyboardInterrupt

    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        map_on_cores(lambda _: time.sleep(60), range(4), begun=interrupt)
    assert time.monotonic() - begin < 30
    with pytest.raises(ChildProcessError):  # none is left
        os.waitpid(-1, os.WNOHANG)


def test_a_part_makes_no_copies_itself(work):
    def inner(x):
        return map_on_cores(lambda y: (os.getpid(), x + y), range(3)), os.getpid()

    for x, (pairs, outer) in enumerate(map_on_cores(inner, range(4))):
        assert work == "alone" or {pid for pid, _ in pairs} == {outer}
        assert [value for _, value in pairs] == [x, x + 1, x + 2]
