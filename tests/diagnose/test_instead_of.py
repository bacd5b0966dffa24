"""An effect of the user's model that only imitates another gives way to it, and the answer says so.

Inertia, Coulomb and viscous friction is what nearly everyone starts with. Below break-away a
bristle turns each loop with a force that leads the position, as a damper's does.
"""

import json

import numpy as np
import pytest
from diagnose.made_records import dahl, write_made

from teleopdesign import Model, find_missing, load_experiment
from teleopdesign.diagnose.answer import load_answer, write_answer
from teleopdesign.effects import EFFECTS

pytestmark = pytest.mark.slow  # diagnoses of whole cases

KNOWN = {n: EFFECTS[n] for n in ("coulomb", "viscous", "presliding", "spring", "bias", "stribeck")}
MODEL = """coulomb = { level = { value = 1.0, unit = "N*m" } }
viscous = { damping = { value = 30.0, unit = "N*m*s/rad" } }
"""


def loops(seed):
    """A slow motion within a few bristle lengths (0.2 mrad): sines below 1 Hz, small on large."""
    rng = np.random.default_rng(seed)
    f = rng.uniform(0.15, 0.8, 5)
    a = rng.uniform(0.3, 1.0, 5) * 2.5e-4
    p = rng.uniform(0, 6, 5)

    def position(t):
        return np.sum(a[:, None] * np.sin(2 * np.pi * np.outer(f, t) + p[:, None]), axis=0)

    return position


def write_bristle(folder, viscous=0.0):
    def force(t, x, v):
        return dahl(x, stiffness=4e3, level=0.8) + viscous * v

    return write_made(
        folder,
        {"fit": [(30.0, loops(1))], "check": [(20.0, loops(2))]},
        force,
        effects=MODEL,
        step=2e-6,
        noise=2e-3,
    )


@pytest.fixture(scope="module")
def search(tmp_path_factory):
    folder = write_bristle(tmp_path_factory.mktemp("bristle") / "case")
    experiment = load_experiment(folder)
    return experiment, find_missing(experiment, Model.from_experiment(experiment, KNOWN))


def test_a_damper_that_stood_in_for_hysteresis_gives_way_to_the_bristle(search):
    _, diagnosis = search
    before = diagnosis.before.model.parameters["device.viscous.damping"]
    assert before.value > 5 * before.stderr, "the damper of the user's model is surely there"
    assert [str(c) for c in diagnosis.missing] == ["presliding at device"]
    assert diagnosis.rungs[1].instead_of == "viscous"
    assert not diagnosis.model.body("device").has("viscous")
    assert diagnosis.after.check_error < 0.3 * diagnosis.before.check_error
    stiffness = diagnosis.model.parameters["device.presliding.stiffness"]
    assert stiffness.value == pytest.approx(4e3, rel=0.1)


def test_an_answer_read_back_knows_it_too(search, tmp_path):
    experiment, diagnosis = search
    write_answer(diagnosis, tmp_path / "answer.json")
    back = load_answer(tmp_path / "answer.json", KNOWN, experiment=experiment)
    assert back == diagnosis and repr(back) == repr(diagnosis)
    assert json.loads((tmp_path / "answer.json").read_text())["missing"][0]["instead_of"]


def test_a_damper_that_is_there_stays_beside_the_bristle(tmp_path):
    experiment = load_experiment(write_bristle(tmp_path / "case", viscous=300.0))
    diagnosis = find_missing(experiment, Model.from_experiment(experiment, KNOWN))
    assert [str(c) for c in diagnosis.missing] == ["presliding at device"]
    assert diagnosis.rungs[1].instead_of is None
    damping = diagnosis.model.parameters["device.viscous.damping"]
    assert damping.value == pytest.approx(300.0, rel=0.1)
