import pytest
from security.hostile import Guard


@pytest.fixture
def guard(monkeypatch, tmp_path):
    """What sees whether something ran; the working folder is an empty one."""
    made = Guard(monkeypatch, tmp_path)
    yield made
    made.check()
