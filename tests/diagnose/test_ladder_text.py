"""What a diagnosis says of an error in noise floors."""

import pytest

from teleopdesign.diagnose.ladder_text import say_floors
from teleopdesign.report.words import _floors


@pytest.mark.parametrize(("left", "said"), [(0.94, "0.9"), (45.34, "45.3"), (1000.0, "1000.0")])
def test_an_error_is_a_number_of_noise_floors(left, said):
    assert say_floors(left) == said


@pytest.mark.parametrize("left", [1000.1, 744440815.1, float("inf")])
def test_a_floor_next_to_zero_is_no_measure(left):
    """Where the force has no stated noise, the floor is that of the position alone."""
    assert say_floors(left) == _floors(left) == "more than 1000"
