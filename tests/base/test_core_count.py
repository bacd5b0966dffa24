"""Cores and workers of this process, on systems that do not tell which cores it may use, too."""

import os

import pytest

from teleopdesign.base.core_count import count_cores, count_workers


def test_cores_are_counted_where_the_system_tells_none_for_the_process(monkeypatch):
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    assert count_cores() == (os.cpu_count() or 1)


@pytest.mark.parametrize(("allowed", "count"), [("1", 1), ("3", 3), ("0", None), ("x", None)])
def test_workers_are_as_many_as_numba_may_have_threads(allowed, count, monkeypatch):
    monkeypatch.setenv("NUMBA_NUM_THREADS", allowed)
    assert count_workers() == (count or count_cores())
