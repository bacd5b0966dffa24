"""Records with a bias or friction level of their own: found on each, and used for nothing else."""

import json
from dataclasses import replace

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.diagnose.answer import answer
from teleopdesign.diagnose.error import force_error
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.predictions import write_predictions
from teleopdesign.diagnose.record_offsets import offset_groups
from teleopdesign.diagnose.residual import residuals
from teleopdesign.measurement.prepare import prepare
from teleopdesign.show.diagnose.text import ladder_text

BIAS, LEVEL = 0.15, 0.8  # N, and of the rod's friction
STRIBECK = {"extra_static_level": 0.2, "stribeck_velocity": 0.0225}


@pytest.fixture(scope="module")
def rod():
    return td.load_experiment(td.example("rod"))


@pytest.fixture(scope="module")
def model(rod):
    """The rod with what it lacks."""
    model = td.Model.from_experiment(rod).with_effect("stribeck", values=STRIBECK)
    return estimate(model, prepare(rod)).model


def changed(rod, offset_names, *, bias=0.0, factor=1.0, model=None):
    """The rod whose check record has another bias, or another friction level, in its command."""
    (record,) = rod.check_records
    force = record.signals["device.actuator_force"] + bias
    if factor != 1:
        (motion,) = [s.motion for s in prepare(rod).of("check")]
        level = model.parameters["device.coulomb.level"].value
        force = force.copy()
        force[motion.rows] += (factor - 1) * level * motion.direction
    signals = {**record.signals, "device.actuator_force": force}
    changed_record = replace(record, signals=signals, offset_names=frozenset(offset_names))
    return replace(rod, records=(*rod.fit_records, changed_record))


def values(experiment, model):
    prepared = prepare(experiment)
    ((_, groups),) = offset_groups(model, prepared.stretches)
    return groups.values, force_error(model, prepared.of("check"))


def test_a_bias_of_one_record_is_estimated_and_costs_nothing(rod, model):
    offset, error = values(changed(rod, {"bias"}, bias=BIAS), model)
    before, plain = values(changed(rod, {"bias"}), model)
    # a force more in the command is a force that acts against the one that is found
    assert before["bias"] - offset["bias"] == pytest.approx(BIAS, rel=0.02)
    # where the body rests the residual is not linear in a bias
    assert error == pytest.approx(plain, rel=0.05)
    common = changed(rod, (), bias=BIAS)
    assert force_error(model, prepare(common).of("check")) > 3 * plain


def test_a_friction_level_of_one_record_is_estimated(rod, model):
    made = changed(rod, {"friction_level"}, factor=LEVEL, model=model)
    offset, error = values(made, model)
    # where no direction is told the made command keeps the old level
    assert offset["friction_level"] == pytest.approx(LEVEL, rel=0.03)
    common = changed(rod, (), factor=LEVEL, model=model)
    assert error < 0.5 * force_error(model, prepare(common).of("check"))


def test_a_zero_on_which_no_law_depends_changes_nothing(rod, model):
    prepared, plain = prepare(changed(rod, {"position_zero"})), prepare(changed(rod, ()))
    assert not offset_groups(model, prepared.stretches)
    assert force_error(model, prepared.of("check")) == force_error(model, plain.of("check"))
    sprung = model.with_effect("spring", values={"stiffness": 5.0})
    ((_, here),) = offset_groups(sprung, prepared.stretches)
    assert "position_zero" in here.values


def test_what_belongs_to_one_record_is_no_evidence_for_an_effect(rod, model):
    """The columns of a bias and of the level are zero on a record that has its own."""
    biased = model.with_effect("bias", values={"force": 0.01})
    made = changed(rod, {"bias", "friction_level"})
    names = ("device.bias.force", "device.coulomb.level", "device.viscous.damping")
    ((_, tangents),) = residuals(biased, prepare(made).of("check"), names)
    ((_, shared),) = residuals(biased, prepare(rod).of("check"), names)
    sizes = np.linalg.norm(tangents, axis=1) / np.linalg.norm(shared, axis=1)
    # a body at rest balances: what is left of the columns there is not linear
    assert sizes[0] < 0.05 and sizes[1] < 0.05 and sizes[2] > 0.3


@pytest.mark.slow
def test_the_file_says_it_and_the_answer_gives_it_back(rod, tmp_path):
    made = changed(rod, {"bias"}, bias=BIAS)
    known = {n: td.EFFECTS[n] for n in ("coulomb", "viscous", "stribeck")}
    diagnosis = td.find_missing(made, td.Model.from_experiment(made, known))
    assert [c.effect.name for c in diagnosis.missing] == ["stribeck"]
    (offset,) = answer(diagnosis)["own"]
    assert (offset["record"], offset["at"], offset["of"], offset["unit"]) == (
        rod.check_records[0].file,
        "device",
        "bias",
        "N",
    )
    assert f"offset of {offset['record']} alone: bias {offset['value']:.4g} N" in ladder_text(
        diagnosis
    )
    json.dumps(answer(diagnosis))
    write_predictions(diagnosis, tmp_path / "predictions.csv")
    rows = np.genfromtxt(tmp_path / "predictions.csv", delimiter=",", names=True, dtype=None)
    last = rows[rows["record"] == offset["record"]]
    # the bias is part of the model's force: what is left has no mean
    assert abs(last["deviceresidual_after"].mean()) < 0.05 * BIAS
