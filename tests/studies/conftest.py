"""How the processes of a study start: as copies of this one, or anew."""

import sys

import pytest
from study_processes import anew, children

from teleopdesign.studies import pool, processes, worker_processes


@pytest.fixture
def copies(monkeypatch):
    """Processes of a study are copies of this one, also beside the thread that tests come from."""
    if sys.platform != "linux":
        pytest.skip("processes are copied on Linux only")
    for module in (processes, worker_processes):
        monkeypatch.setattr(module, "can_copy", lambda: True)
    monkeypatch.setattr(worker_processes, "has_hidden_threads", lambda: False)


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
