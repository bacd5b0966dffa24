"""What `verify` names where a compensation or its device differs from the design."""

import numpy as np
import pytest
from design.compensated_joint import PERIOD, record_without
from design.faults_campaign import FAULTS, WAYS, experiment, is_right, named

import teleopdesign as td
from teleopdesign.design.second_recording import SecondRecording

QUICK = ("none", "level", "sign")
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
@pytest.mark.parametrize(("fault", "way"), list(zip(FAULTS, 4 * WAYS[1:], strict=True)))
def test_a_planted_fault_is_in_a_group_where_the_command_was_not_recorded(fault, way):
    assert is_right(fault, named(fault, 1, way))


@pytest.mark.slow
def test_a_recording_with_the_compensation_off_tells_a_changed_device():
    (group,) = named("friction", 1, WAYS[2]).deviations
    assert [f"{one.at}: {one.parameter}" for one in group] == ["Z_M: coulomb.level"]
    (one,) = group
    assert one.value == pytest.approx(1.4 * one.designed, rel=0.03)


def test_a_law_that_reads_the_command_runs_along_a_recording():
    """A ripple is divided out: without force feedback, C commands its friction over the gain."""
    effects = {"coulomb": {"level": 0.2}, "torque_ripple": {"amplitude": 0.3, "period": 0.5}}
    effects["torque_ripple"]["phase"] = 0.0
    body = td.Body("revolute", {"inertia": 0.01})
    for name, values in effects.items():
        body = body.with_effect(td.EFFECTS[name], values)
    diagram = td.haptic_interface(body, cancellation=td.cancel(effects, smoothing_velocity=0.2))
    columns = record_without(0.01, {}, 4, np.random.default_rng(1))
    sampling = td.Sampling(period=PERIOD, delay=0.0, velocity_bandwidth=np.inf)
    on = SecondRecording.of(diagram, sampling, experiment(columns), "device")
    (command,) = on.commands()
    speed = np.diff(columns["q"], prepend=columns["q"][0]) / PERIOD
    gain = 1 + 0.3 * np.sin(2 * np.pi * columns["q"] / 0.5)
    np.testing.assert_allclose(command, 0.2 * speed / (0.2 + abs(speed)) / gain, atol=1e-9)
