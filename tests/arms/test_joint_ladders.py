"""What the ladder of an arm asks of an effect at a joint beyond what one body asks."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from arms.arm_simulator import random_arm, write_experiment

import teleopdesign as td
from teleopdesign.diagnose.arms import ladder
from teleopdesign.diagnose.arms.ladder import NO_HELP, NO_MORE_THAN_NOISE
from teleopdesign.diagnose.criteria import CRITERIA
from teleopdesign.diagnose.search_plan import PLAN
from teleopdesign.effects import EFFECTS


def test_only_an_inertia_is_taken_up_by_base_parameters_at_every_joint():
    taken = set(EFFECTS) - set(ladder._select_beyond_links(EFFECTS))
    assert taken == {"added_inertia"}


def refusal(monkeypatch, errors, floors):
    """Of an effect: (before, after) of the joint's error and of what its sensors leave."""
    joint = SimpleNamespace(
        name="joint1",
        search=SimpleNamespace(criteria=CRITERIA, prepared=None, generator=lambda: None),
    )
    fits = [
        SimpleNamespace(
            check_error=error,
            check_errors={"joint1": error},
            fits={"joint1": SimpleNamespace(model=floor)},
        )
        for error, floor in zip(errors, floors, strict=True)
    ]
    monkeypatch.setattr(
        ladder, "noise_floor", lambda model, *_: SimpleNamespace(drawn=model), raising=True
    )
    return ladder._refusal(joint, *fits)


@pytest.mark.parametrize("noise", [1e-4, 3.5e-3, 0.2])
def test_an_effect_that_only_weakens_the_noise_of_the_sensors_is_set_aside(monkeypatch, noise):
    assert refusal(monkeypatch, (1.05 * noise, 0.84 * noise), (noise, 0.8 * noise)) == (
        NO_MORE_THAN_NOISE
    )
    # what explains far more than it weakens stays, and what weakens nothing
    assert refusal(monkeypatch, (9.0 * noise, 1.0 * noise), (noise, 0.8 * noise)) == ""
    assert refusal(monkeypatch, (1.3 * noise, 1.2 * noise), (noise, noise)) == ""
    assert refusal(monkeypatch, (1.3 * noise, 1.4 * noise), (noise, noise)) == NO_HELP


def test_records_without_sensor_noise_refuse_nothing(monkeypatch):
    assert refusal(monkeypatch, (0.02, 0.01), (0.0, 0.0)) == ""


def test_joints_of_larger_arms_seek_pairs_and_exchanges_too():
    for count in (2, 3, 6, 7):
        plan = PLAN.for_joints(count)
        assert plan.exchanges == PLAN.exchanges and plan.trials > 0
    assert PLAN.for_joints(3).omissions() == ()
    assert len(PLAN.for_joints(6).omissions()) == 1


@pytest.mark.slow
def test_a_log_that_is_early_by_a_row_makes_no_delay_beside_what_is_hidden(tmp_path):
    """The links had stood for a spring that took nine tenths of the force of its joint."""
    generator = np.random.default_rng([77, 3, 1])
    arm = random_arm(generator, 2)
    folder = write_experiment(tmp_path, arm, generator, ("spring", 1, 1.35), late=-1.0)
    among = ("spring", "actuation_delay", "actuator_lag")
    diagnosis = td.find_missing_in_arm(td.load_experiment(folder), among=among)
    assert {c.key for c in diagnosis.missing} == {("spring", "joint2")}
    (late,) = (v.value for v in diagnosis.joints["joint2"].model.record_shift.values())
    assert late == pytest.approx(-0.01, abs=0.002)  # a row; joint 1 hardly tells it
