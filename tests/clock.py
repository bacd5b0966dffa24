"""Bounds of time that hold on slower machines too: processor time, in units of this machine's pace.

A bound in seconds that holds here fails by chance on a machine that is three times slower.
"""

import os
import signal
import time
from contextlib import contextmanager

#: s of processor time that `_work` took on the machine on which the bounds were measured
_REFERENCE = 0.0095


def _work():
    total = 0.0
    for k in range(200_000):
        total += k % 7 * 0.5
    return total


def slowness():
    """How many times slower than that machine this one computes now; at least 1."""
    times = []
    for _ in range(5):
        start = time.process_time()
        _work()
        times.append(time.process_time() - start)
    return max(1.0, min(times) / _REFERENCE)


@contextmanager
def takes_less_than(seconds):
    """Fails what takes more processor time than that, on a machine of the reference's pace."""
    start = sum(os.times()[:4])  # with copies of this process
    yield
    duration = sum(os.times()[:4]) - start
    if duration >= seconds:
        allowed = seconds * slowness()
        assert duration < allowed, (
            f"took {duration:.3g} s of processor time, allowed {allowed:.3g} s"
        )


@contextmanager
def in_time(seconds=30):
    """Fails what hangs: it takes more processor time than that, whatever else the machine does."""

    def late(*_):
        raise AssertionError(f"took more than {seconds} s of processor time")

    before = signal.signal(signal.SIGPROF, late)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)
