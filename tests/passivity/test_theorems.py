"""Theorems are found in their folder and asked of a device; one more is one more file."""

import pytest
from devices import body

from teleopdesign.controllers import controller
from teleopdesign.effects import EFFECTS
from teleopdesign.passivity.identified import identify_device
from teleopdesign.passivity.theorems import THEOREMS, Question, Wall
from teleopdesign.simulate import Sampling

COMPUTER = Sampling(1e-3, 0.0, 1e-5)


def device(**effects):
    made = body(0.1)
    for name, values in effects.items():
        made = made.with_effect(EFFECTS[name], values)
    return identify_device(made)


IDEAL = device(coulomb={"level": 0.5}, viscous={"damping": 1.0})
GIVING = device(
    coulomb={"level": 0.5},
    viscous={"damping": 1.0},
    presliding={"stiffness": 2e4, "bristle_damping": 0.0},
)


def stage(name, **values):
    return controller(name, values).stages[0]


DAHL = stage("dahl", level=0.4, stiffness=1e4)
SMOOTHED = stage("smoothed_coulomb", level=0.4, smoothing_velocity=0.01)
QUESTIONS = [
    Question(made, law, wall, computer)
    for made in (IDEAL, GIVING)
    for law in (None, DAHL, SMOOTHED)
    for wall in (None, Wall(100.0, 0.0), Wall(100.0, 1.0))
    for computer in (None, COMPUTER)
]


@pytest.mark.parametrize("name", THEOREMS)
def test_a_theorem_answers_some_question_and_leaves_others(name):
    """One that applies has a verdict, one that does not has nothing to say."""
    answers = [THEOREMS[name](question) for question in QUESTIONS]
    assert not all(answers)
    for one in (one for answer in answers for one in answer):
        assert one.topic and one.claim.status in ("proved", "refuted", "evidence", "unknown")
