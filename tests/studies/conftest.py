"""How the processes of a study start: as copies of this one, or anew."""

import sys

import pytest
from study_processes import anew, children

from teleopdesign.studies import processes


@pytest.fixture
def copies(monkeypatch):
    """Processes of a study are copies of this one, also beside the thread that tests come from."""
    if sys.platform != "linux":
        pytest.skip("processes are copied on Linux only")
    monkeypatch.setattr(processes, "can_copy", lambda: True)
    monkeypatch.setattr(processes, "has_hidden_threads", lambda: False)


@pytest.fixture(params=("copies", "anew"))
def start(request, monkeypatch):
    """How the processes of a study start; none of them is left at the end."""
    if request.param == "anew":
        anew(monkeypatch)
    else:
        request.getfixturevalue("copies")
    before = children()
    yield request.param
    assert not children() - before
