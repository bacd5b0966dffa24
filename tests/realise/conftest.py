"""Here the compiled loop is tested."""

import pytest


@pytest.fixture(autouse=True)
def short_simulations(compiled_simulations):
    """No step of a simulation runs in plain Python."""
