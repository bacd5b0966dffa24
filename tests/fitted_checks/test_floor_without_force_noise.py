"""A noise floor without noise of the force says so where it is far below what is left."""

import pytest

from teleopdesign.diagnose.criteria import CRITERIA
from teleopdesign.fitted_checks.excitation import _describe_floor


@pytest.mark.parametrize(("floors", "lacks"), [(1.01, True), (0.99, False)])
def test_limits_above_a_floor_of_nearly_nothing_ask_for_the_noise_of_the_force(floors, lacks):
    """ "Can show bias (force from 1.4e-08 N*m)" stood beside a force of 1 N*m, 34 % of it left."""
    sentence = _describe_floor(0.34, 0.34 / (floors * CRITERIA.countable))
    assert ("contains no noise of the force: state `noise` at the channel" in sentence) == lacks
    assert "34 % of the force is unexplained" in sentence
