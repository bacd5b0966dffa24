"""A simulated tip behind a gap follows the machine; the force that leads it explains nothing."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose.simulated_cases import truth_of, write_simulated

from teleopdesign import Model, find_missing, load_experiment
from teleopdesign.diagnose.error import force_error
from teleopdesign.diagnose.noise_floor import noise_floor
from teleopdesign.effects import EFFECTS
from teleopdesign.measurement.prepare import prepare

BACKLASH = EFFECTS["backlash"]


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    """Prepared records, the user's model, the true model with its gap, and the truth."""
    folder = write_simulated(tmp_path_factory.mktemp("backlash") / "case", "backlash", seed=3)
    experiment, truth = load_experiment(folder), truth_of(folder)
    stated = Model.from_experiment(experiment)
    true = stated.with_values(truth["model_parameters"])
    (hidden,) = truth["effects"]
    values = {n: hidden["parameters"][n]["value"] for n in BACKLASH.parameters}
    true = true.with_effect(BACKLASH, at="device")
    true = true.with_values({f"device.backlash.{n}": v for n, v in values.items()})
    return experiment, prepare(experiment), stated, true


def free_running(model):
    """The model with a tip that nothing leads back."""
    states = {n: replace(s, correction=None) for n, s in BACKLASH.states.items()}
    free = replace(BACKLASH, states=states, led=None)
    body = model.body("device")
    effects = tuple(free if e.name == "backlash" else e for e in body.effects)
    return model._with_body("device", replace(body, effects=effects))


def test_a_true_model_leaves_what_its_sensors_leave(case):
    _, prepared, _, true = case
    left = force_error(true, prepared.of("check"))
    floor = noise_floor(true, prepared, np.random.default_rng(0)).value
    # measured on ten machines: 0.9 to 1.5 floors
    assert left < 2.0 * floor
    # its meetings last: without correction it falls out of step
    assert left < 0.5 * force_error(free_running(true), prepared.of("check"))


@pytest.mark.slow
def test_a_gap_is_detected_with_its_width(case):
    experiment, _, stated, true = case
    known = {n: EFFECTS[n] for n in ("backlash", "transmission_compliance", "added_inertia")}
    known |= {n: EFFECTS[n] for n, _ in stated.effects}
    diagnosis = find_missing(experiment, Model.from_experiment(experiment, known))
    assert [c.effect.name for c in diagnosis.missing] == ["backlash"]
    for name in ("tip_inertia", "stiffness", "gap"):
        full = f"device.backlash.{name}"
        expected = true.parameters[full].value
        assert diagnosis.model.parameters[full].value == pytest.approx(expected, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("effect", ["transmission_compliance", None])
def test_no_gap_is_named_where_there_is_none(effect, tmp_path):
    """Beside noise a gap may look determined; what counts is that no record supports it."""
    experiment = load_experiment(write_simulated(tmp_path / "case", effect, seed=5))
    stated = Model.from_experiment(experiment)
    known = {n: EFFECTS[n] for n in ("backlash", "transmission_compliance")}
    known |= {n: EFFECTS[n] for n, _ in stated.effects}
    diagnosis = find_missing(experiment, Model.from_experiment(experiment, known))
    assert [c.effect.name for c in diagnosis.missing] == [effect] * (effect is not None)
    assert not any("backlash" in (c.effect.name for c in group) for group in diagnosis.groups)
