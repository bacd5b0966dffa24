"""Studies leave no process behind."""

import pytest
from study_processes import children


@pytest.fixture
def no_process_is_left():
    before = children()
    yield
    assert not children() - before
