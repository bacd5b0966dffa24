"""The study of grafts: how large a graft is, and how an answer to it is judged."""

import grafted_effects as study
import numpy as np
import pytest

import teleopdesign as td

ROW = {"graft": "spring", "named": [], "ladder": [], "alike": {}, "before": 1.0}


@pytest.mark.parametrize(
    ("change", "outcome"),
    [
        ({"graft": ""}, "right"),
        ({"graft": "", "named": ["bias"]}, "false name"),
        ({}, "missed"),
        ({"ladder": ["bias"]}, "missed"),
        ({"ladder": ["spring"]}, "leading"),
        ({"named": ["spring"]}, "right"),
        ({"named": ["spring", "bias"]}, "among others"),
        ({"named": ["gravity"]}, "false name"),
        ({"named": ["gravity"], "alike": {"gravity": ["gravity", "spring"]}}, "right"),
    ],
)
def test_right_is_the_graft_and_no_other(change, outcome):
    assert study.outcome({**ROW, **change}) == outcome


def test_a_graft_shows_only_by_what_is_left_beyond_the_rest_of_the_machine():
    assert study.visible_size({**ROW, "before": 0.9}) == 0.0
    np.testing.assert_allclose(study.visible_size({**ROW, "before": np.sqrt(5.0)}), 2.0, rtol=1e-12)


@pytest.fixture(scope="module")
def machine():
    return study.machine_of("rod", td.load_experiment(td.example("rod")), quick=True)


@pytest.mark.slow
@pytest.mark.parametrize("effect", ["spring", "quadratic_drag", "position_dependent_friction"])
def test_a_graft_changes_the_command_alone_and_has_the_size_asked_for(machine, effect):
    experiment = study.grafted(machine, effect, 2.0)
    added = []
    for k, rows, period, _ in machine.parts:
        new, old = (e.records[k].signals for e in (experiment, machine.experiment))
        assert all(new[n] is old[n] for n in old if n != "device.actuator_force")
        change = new["device.actuator_force"][rows] - old["device.actuator_force"][rows]
        added.append(study._low_passed(change, machine.bandwidth, period))
    rms = np.sqrt(np.mean(np.concatenate(added) ** 2))
    np.testing.assert_allclose(rms, 2.0 * machine.left, rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("effect", ["torque_ripple", "load_dependent_friction"])
def test_what_takes_a_share_of_the_command_takes_it_of_the_new_one(machine, effect):
    experiment = study.grafted(machine, effect, 0.5)
    first = []
    for k, rows, period, now in machine.parts:
        new = experiment.records[k].signals["device.actuator_force"][rows]
        share = np.divide(new - now.command, new, np.zeros_like(new), where=new != 0.0)
        assert np.abs(share).max() <= study.MOST_OF_COMMAND
        first.append(study._low_passed(share * now.command, machine.bandwidth, period))
    rms = np.sqrt(np.mean(np.concatenate(first) ** 2))
    np.testing.assert_allclose(rms, 0.5 * machine.left, rtol=1e-9)


@pytest.mark.slow
def test_a_graft_that_would_take_half_of_the_command_is_none(machine):
    assert study.grafted(machine, "torque_ripple", 1e3) is None


@pytest.mark.slow
def test_what_a_model_has_is_not_grafted_nor_what_its_axis_has_not(machine):
    assert machine.takes("spring") and machine.takes("stribeck")
    assert not machine.takes("gravity")  # the rod is prismatic
    (body,) = machine.experiment.bodies
    stiff = td.Model.from_experiment(machine.experiment).with_effect("spring", at=body)
    assert not study.replace(machine, model=stiff).takes("spring")
