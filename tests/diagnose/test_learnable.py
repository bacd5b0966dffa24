"""What a black box learns from the motion: a law that the model lacks, and no noise."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.base.codec import from_data, to_data
from teleopdesign.diagnose import learnable as module
from teleopdesign.diagnose.answer import answer, load_answer, write_answer
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.learnable import (
    Learnable,
    error_near_reversals,
    learnable,
)
from teleopdesign.diagnose.tree_inputs import inputs_along
from teleopdesign.measurement.prepare import prepare
from teleopdesign.measurement.reversals import mark_reversals
from teleopdesign.show.diagnose.text import ladder_text


@pytest.fixture(scope="module", autouse=True)
def whole_black_box(all_trees):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "TREES", all_trees)
        yield


@pytest.fixture(scope="module")
def prepared(experiment):
    return prepare(experiment)


def of_fit_records(prepared):
    """The same without check records."""
    kept = tuple(replace(s, use="fit") for s in prepared.stretches)
    return replace(prepared, stretches=kept)


@pytest.mark.parametrize(
    "records", ["check records", pytest.param("blocks of fit records", marks=pytest.mark.slow)]
)
def test_a_law_that_the_model_lacks_could_be_learned(records, diagnosis, prepared):
    prepared = prepared if records == "check records" else of_fit_records(prepared)
    model = diagnosis.before.model
    learned = learnable(model, prepared)
    # the missing Stribeck effect is most of what is left, and its record repeats it
    assert learned.error < 0.6 * learned.left
    # the error that the diagnosis would say, of these records
    assert learned.left == pytest.approx(estimate(model, prepared).check_error, rel=0.02)
    assert f"{100 * learned.part:.2g} % follows from the motion" in str(learned)


@pytest.mark.slow
def test_of_what_a_right_model_leaves_next_to_nothing_could_be_learned(diagnosis, prepared):
    learned = learnable(diagnosis.after.model, prepared)
    assert learned.left == pytest.approx(diagnosis.after.check_error, rel=0.1)
    # a tenth: trees follow some of the noise of the records that they learn from
    assert learned.error > 0.9 * learned.left


@pytest.mark.slow
def test_a_force_that_does_not_repeat_is_not_learned(diagnosis, prepared):
    rng = np.random.default_rng(0)

    def noisy(s):
        noise = s.motion.lowpassed(rng.normal(0.0, 1.0, len(s.motion.time)))
        force = s.motion.interaction + noise * np.sqrt(s.measured / s.weight / len(s.keep))
        return replace(s, motion=replace(s.motion, interaction=force))

    stretches = tuple(map(noisy, prepared.stretches))
    learned = learnable(diagnosis.after.model, replace(prepared, stretches=stretches))
    assert learned.part < 0.1 * learned.left


def test_a_run_that_never_comes_back_tells_the_trees_no_clock(prepared):
    motion = prepared.stretches[0].motion
    n = len(motion.time)
    way = np.linspace(0.0, 1.0, n)
    once = replace(motion, position=way, direction=np.ones(n, dtype=np.int8))
    # velocity, acceleration and direction are left: place and time since a start tell the time
    assert inputs_along([once])[0].shape == (n, 3)
    assert inputs_along([motion])[0].shape == (n, 6)


@pytest.mark.slow
def test_the_same_seed_gives_the_same_figure(diagnosis, prepared):
    model = diagnosis.before.model
    assert learnable(model, prepared, seed=3) == learnable(model, prepared, seed=3)


def test_without_the_extra_the_answer_has_null(monkeypatch, diagnosis, prepared):
    monkeypatch.setattr(module, "find_spec", lambda name: None)
    assert learnable(diagnosis.after.model, prepared) is None
    data = answer(replace(diagnosis, learnable=None))
    assert data["learnable"] is None and data["black_box"] is None


def test_an_answer_holds_what_could_be_learned_and_gives_it_back(diagnosis, experiment, tmp_path):
    write_answer(diagnosis, tmp_path / "answer.json")
    data = json.loads((tmp_path / "answer.json").read_text())
    assert data["learnable"] == pytest.approx(diagnosis.learnable.error)
    assert data["near_reversals"]["check_error"] == pytest.approx(diagnosis.near_reversals.error)
    back = load_answer(tmp_path / "answer.json", experiment=experiment)
    assert back.learnable == diagnosis.learnable
    assert back.near_reversals == diagnosis.near_reversals
    assert str(diagnosis.learnable) in ladder_text(back)


def test_the_shares_of_the_sentence_add_up():
    learned = Learnable(left=0.094, error=0.054, alone=0.2, where="below 0.005 m/s")
    sentence = "9.4 % left; 4 % follows from the motion, below 0.005 m/s; 5.4 % was not learned"
    assert str(learned) == sentence
    nothing = Learnable(left=0.05, error=0.06, alone=0.2)
    assert nothing.part == 0.0 and "nothing was learned" in str(nothing)
    assert from_data(Learnable, to_data(learned, {}), "", {}) == learned


def test_the_error_near_reversals_is_that_of_the_rows_there(diagnosis, prepared):
    near = error_near_reversals(diagnosis.before.model, prepared)
    assert 0.0 < near.share < 1.0 and near.error > 0.0
    still = tuple(
        replace(s, motion=replace(s.motion, direction=np.ones_like(s.motion.direction)))
        for s in prepared.stretches
    )
    assert error_near_reversals(diagnosis.before.model, replace(prepared, stretches=still)) is None


@given(st.lists(st.sampled_from([-1, 0, 1]), min_size=1, max_size=60), st.integers(0, 8))
def test_samples_near_a_reversal_are_those_that_have_one_within_reach(direction, within):
    reversals = mark_reversals(np.array(direction, dtype=np.int8), within=within)
    last, turned = 0, []
    for i, d in enumerate(direction):
        if d and last and d != last:
            turned.append(i)
        last = d or last
    expected = [any(abs(i - t) <= within for t in turned) for i in range(len(direction))]
    assert reversals.tolist() == expected


def test_the_black_box_learns_from_a_motion_of_which_one_signal_or_every_signal_is_constant():
    """A body that stands still or is always driven one way; the trees find no border there."""
    rng = np.random.default_rng(3)
    x = rng.normal(size=400)
    target = np.sin(x)
    still = np.stack([np.ones(400), x, np.zeros(400)], axis=1)
    assert np.mean((module._trees(still, target, 0)(still) - target) ** 2) < 0.1 * target.var()
    constant = np.ones((400, 3))
    assert module._trees(constant, target, 0)(constant) == pytest.approx(target.mean())
