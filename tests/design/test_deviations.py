"""What `verify` names where a compensation or its device differs from the design."""

import pytest
from design.faults_campaign import FAULTS, WAYS, is_right, named

QUICK = ("none", "level")
EACH = [n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in FAULTS]


@pytest.mark.parametrize("fault", EACH)
def test_a_planted_fault_is_named_alone_where_the_command_was_recorded(fault):
    verified = named(fault, 0, "command")
    assert is_right(fault, verified)
    assert all(len({one.at for one in group}) == 1 for group in verified.deviations)


@pytest.mark.slow
def test_without_the_command_the_compensator_and_the_device_are_listed_together():
    verified = named("friction", 0, "no command")
    (group,) = verified.deviations
    assert {one.at for one in group} == {"C", "Z_M"}
    assert "to tell these apart" in str(verified)


@pytest.mark.slow
@pytest.mark.parametrize("way", WAYS[1:])
@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_in_a_group_where_the_command_was_not_recorded(fault, way):
    assert is_right(fault, named(fault, 1, way))


@pytest.mark.slow
def test_a_recording_with_the_compensation_off_tells_a_changed_device():
    (group,) = named("friction", 1, WAYS[2]).deviations
    assert [f"{one.at}: {one.parameter}" for one in group] == ["Z_M: coulomb.level"]
    (one,) = group
    assert one.value == pytest.approx(1.4 * one.designed, rel=0.03)
