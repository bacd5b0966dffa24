"""Long work beside a page."""

import threading

from teleopdesign.app.task import BackgroundTask, stop_running
from teleopdesign.base.errors import ModelError


def test_the_result_is_there_once_the_work_is_done():
    task = BackgroundTask("counting", lambda say: sum(range(10)))
    task.wait(10)
    assert task.done and task.result == 45 and task.error == ""


def test_work_stops_at_its_next_line_of_progress_once_cancelled():
    begun, go_on = threading.Event(), threading.Event()

    def work(say):
        say("one")
        begun.set()
        go_on.wait(10)
        say("two")
        raise AssertionError("went on")

    task = BackgroundTask("long", work)
    begun.wait(10)
    assert task.progress == "one" and not task.done
    task.cancel()
    go_on.set()
    task.wait(10)
    assert task.done and task.error == "cancelled" and task.result is None


def test_bad_input_becomes_one_line():
    def work(say):
        raise ModelError("model: no parameter")

    task = BackgroundTask("bad", work)
    task.wait(10)
    assert task.error == "model: no parameter"


def test_a_second_click_on_cancel_finds_nothing_to_stop():
    released = threading.Event()
    task = BackgroundTask("long", lambda say: (released.wait(), say("on")))
    assert stop_running(task) == "long: cancelled"
    released.set()
    task.wait(5.0)
    assert task.done and task.error == "cancelled"
    assert stop_running(None) == ""
