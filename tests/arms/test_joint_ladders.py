"""What the ladder of an arm asks of an effect at a joint beyond what one body asks."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from arms.arm_simulator import random_arm, write_experiment

import teleopdesign as td
from teleopdesign.diagnose import held_against_others as refusal
from teleopdesign.diagnose import parts_ladder as ladder
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.criteria import CRITERIA
from teleopdesign.diagnose.held_against_others import NO_HELP, NO_MORE_THAN_NOISE
from teleopdesign.diagnose.ladder_state import LadderState
from teleopdesign.diagnose.part_search import PartSearch
from teleopdesign.diagnose.parts_fit import PartsRung
from teleopdesign.diagnose.rung import Rung
from teleopdesign.effects import EFFECTS


def test_only_an_inertia_is_taken_up_by_base_parameters_at_every_joint():
    effects = set(EFFECTS) - set(ladder._select_beyond_links(EFFECTS))
    assert effects == {"added_inertia"}


def refused(monkeypatch, errors, floors):
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
        refusal, "noise_floor", lambda model, *_: SimpleNamespace(drawn=model), raising=True
    )
    return refusal.refusal(joint, *fits)


@pytest.mark.parametrize("noise", [1e-4, 3.5e-3, 0.2])
def test_an_effect_that_only_weakens_the_noise_of_the_sensors_is_set_aside(monkeypatch, noise):
    assert refused(monkeypatch, (1.05 * noise, 0.84 * noise), (noise, 0.8 * noise)) == (
        NO_MORE_THAN_NOISE
    )
    # what explains far more than it weakens stays, and what weakens nothing
    assert refused(monkeypatch, (9.0 * noise, 1.0 * noise), (noise, 0.8 * noise)) == ""
    assert refused(monkeypatch, (1.6 * noise, 0.9 * noise), (noise, 0.85 * noise)) == ""
    assert refused(monkeypatch, (1.3 * noise, 1.2 * noise), (noise, noise)) == ""
    assert refused(monkeypatch, (1.3 * noise, 1.4 * noise), (noise, noise)) == NO_HELP


def test_where_readings_explain_what_is_left_an_effect_must_leave_surely_fewer_floors(monkeypatch):
    """Tips that are none left 1.16 of 1.21 and 1.23 of 1.37 noise floors, and were named."""
    assert refused(monkeypatch, (1.21, 0.97), (1.0, 0.84)) == NO_MORE_THAN_NOISE
    assert refused(monkeypatch, (1.37, 0.97), (1.0, 0.79)) == NO_MORE_THAN_NOISE
    assert refused(monkeypatch, (2.45, 1.13), (1.0, 0.9)) == ""


def test_records_without_sensor_noise_refuse_nothing(monkeypatch):
    assert refused(monkeypatch, (0.02, 0.01), (0.0, 0.0)) == ""


def climbed(monkeypatch, ladders, refused, why="no"):
    """The ladder of an arm whose joint climbs these ladders in turn; what was estimated.

    ladders: names of the effects of each climb;  refused: effects that the whole arm refuses
    returns: names of the rungs and of what was set aside, what was estimated, the joint
    """
    estimated, climbs = [], iter(ladders)

    def fit_of(name):
        return SimpleNamespace(name=name, model=name, check_errors={"joint1": 0.1})

    def arm_fit_of(name):
        return SimpleNamespace(
            name=name, fits={"joint1": fit_of(name)}, check_errors={"joint1": 0.1}
        )

    def climb(search, state):
        effects = [Candidate(EFFECTS[name], "joint1") for name in next(climbs)]
        rungs = [Rung(one, fit_of(one.effect.name)) for one in effects]
        return state.with_rungs((state.rungs[0], *rungs)), ()

    def estimate_parts(models, _):
        estimated.append(models["joint1"])
        return arm_fit_of(models["joint1"])

    monkeypatch.setattr(ladder, "climb", climb)
    monkeypatch.setattr(refusal, "estimate_parts", estimate_parts)
    monkeypatch.setattr(refusal, "look", lambda search, rungs, state: state)
    monkeypatch.setattr(refusal, "is_better", lambda *_, **__: True)
    monkeypatch.setattr(
        refusal, "refusal", lambda joint, before, after: why if after.name in refused else ""
    )
    first = PartsRung(None, arm_fit_of("user's"))
    nothing = dict(floor=None, ranking=None, tone=None, supported=())
    state = LadderState(rungs=(Rung(None, fit_of("user's")),), **nothing)
    joint = PartSearch("joint1", SimpleNamespace(criteria=CRITERIA), state)
    prepared = SimpleNamespace(joints={"joint1": None})
    joint, rungs = ladder._climb_part(joint, (first,), prepared, lambda _: None)
    aside = [one.candidate.effect.name for one in joint.state.set_aside]
    return [r.added.effect.name for r in rungs[1:]], aside, estimated, joint


def test_a_joint_climbs_again_without_what_the_whole_arm_refuses(monkeypatch):
    first = ("stribeck", "transmission_compliance", "spring")
    rungs, aside, estimated, _ = climbed(
        monkeypatch, [first, ("stribeck", "spring")], {"transmission_compliance"}
    )
    assert rungs == ["stribeck", "spring"]
    assert aside == ["transmission_compliance"]
    # what was held against the arm before is not estimated again
    assert estimated == ["stribeck", "transmission_compliance", "spring"]


def test_what_a_second_climb_changes_is_estimated_with_all_joints_again(monkeypatch):
    rungs, aside, estimated, _ = climbed(
        monkeypatch, [("stribeck", "presliding"), ("spring", "cogging")], {"presliding"}
    )
    assert (rungs, aside) == (["spring", "cogging"], ["presliding"])
    assert estimated == ["stribeck", "presliding", "spring", "cogging"]


def test_a_joint_that_comes_back_to_what_was_refused_ends_without_it(monkeypatch):
    rungs, aside, *_ = climbed(monkeypatch, [("stribeck", "spring")] * 2, {"spring"})
    assert rungs == ["stribeck"]
    assert set(aside) == {"spring"}


def test_what_only_weakens_noise_does_not_limit_the_noise_floor(monkeypatch):
    """A right model would leave more floors than noise does, if the floor were that of the tip."""
    ladders, tip = [("transmission_compliance",), ()], {"transmission_compliance"}
    *_, joint = climbed(monkeypatch, ladders, tip, NO_MORE_THAN_NOISE)
    assert joint.state.weakening == {("transmission_compliance", "joint1")}
    *_, joint = climbed(monkeypatch, ladders, tip, NO_HELP)
    assert not joint.state.weakening


@pytest.mark.slow
def test_a_log_that_is_early_by_a_row_makes_no_delay_beside_what_is_hidden(tmp_path):
    """The links had stood for a spring that took nine tenths of the force of its joint."""
    generator = np.random.default_rng([77, 3, 1])
    arm = random_arm(generator, 2)
    folder = write_experiment(tmp_path, arm, generator, ("spring", 1, 1.35), late=-1.0)
    among = ("spring", "actuation_delay", "actuator_lag")
    diagnosis = td.find_missing(td.load_experiment(folder), among=among)
    assert {c.key for c in diagnosis.missing} == {("spring", "joint2")}
    (late,) = (v.value for v in diagnosis.joints["joint2"].model.record_shift.values())
    assert late == pytest.approx(-0.01, abs=0.002)  # a row; joint 1 hardly tells it
