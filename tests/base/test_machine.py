"""Cores and workers of this process, and machine code that is kept on disk."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from teleopdesign.base.machine import count_cores, count_workers, hash_files, list_files_of_callees
from teleopdesign.measurement import zero_phase, zero_phase_spans
from teleopdesign.realise import compiled, friction_along, lane_exp


def test_cores_are_counted_where_the_system_tells_none_for_the_process(monkeypatch):
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    assert count_cores() == (os.cpu_count() or 1)


@pytest.mark.parametrize(("allowed", "count"), [("1", 1), ("3", 3), ("0", None), ("x", None)])
def test_workers_are_as_many_as_numba_may_have_threads(allowed, count, monkeypatch):
    monkeypatch.setenv("NUMBA_NUM_THREADS", allowed)
    assert count_workers() == (count or count_cores())


def test_what_a_compiled_function_calls_in_other_files_counts_for_it():
    called = Path(zero_phase.__file__)
    assert called in list_files_of_callees(friction_along._balance)
    assert called in list_files_of_callees(zero_phase_spans.filter_spans)


def test_generated_source_is_compiled_anew_where_what_it_imports_has_changed(monkeypatch):
    source = "from teleopdesign.realise.lane_exp import exp\n\n\ndef f(x):\n    return exp(x)\n"
    calls = []

    def hashed(files):
        calls.append([Path(f) for f in files])
        return f"state {len(calls)}"

    monkeypatch.setattr(compiled, "hash_files", hashed)
    monkeypatch.setattr(compiled, "cache_folder", lambda: None)
    make = compiled.compiled_module.__wrapped__
    names = [make(source, "f")["__name__"] for _ in range(2)]
    assert names[0] != names[1]
    assert calls == [[Path(lane_exp.__file__)]] * 2


def test_a_file_that_is_gone_counts_as_empty(tmp_path):
    there = tmp_path / "a.py"
    assert hash_files([there]) == hash_files([])
    there.write_text("x = 1")
    assert hash_files([there]) != hash_files([])


INNER = """from teleopdesign.base.machine import compile_and_keep


@compile_and_keep
def inner(x):
    return {factor} * x
"""
OUTER = """from inner import inner
from teleopdesign.base.machine import compile_and_keep


@compile_and_keep
def outer(x):
    return inner(x) + 1.0


print(outer(1.0))
"""


@pytest.mark.slow
def test_a_caller_does_not_go_on_with_what_an_old_callee_did(tmp_path):
    (tmp_path / "outer.py").write_text(OUTER)
    outputs = []
    for factor in ("2.0", "30.0"):
        (tmp_path / "inner.py").write_text(INNER.format(factor=factor))
        command = [sys.executable, "outer.py"]
        run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
        outputs.append(run.stdout.strip())
    assert outputs == ["3.0", "31.0"]
