"""Theorems are found in their folder and asked of a device; one more is one more file."""

from types import SimpleNamespace

import pytest
from devices import body

from teleopdesign.controllers import controller
from teleopdesign.effects import EFFECTS
from teleopdesign.passivity import Claim, Evidence, Refutation
from teleopdesign.passivity.identified import identify_device
from teleopdesign.passivity.theorems import THEOREMS, Question, Theorem, TopicClaim, Wall, settle
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
    theorem = THEOREMS[name]
    answers = [theorem.claims(question) for question in QUESTIONS]
    assert not all(answers)
    for one in (one for answer in answers for one in answer):
        assert one.topic and one.claim.status in ("proved", "refuted", "evidence", "unknown")


def test_the_question_alone_decides_which_theorems_speak():
    def topics(question):
        return [one.topic for one in settle(question, simulated=False)]

    ideal = ["any law within the level", "the same, with damping"]
    assert topics(Question(IDEAL)) == []
    assert topics(Question(IDEAL, SMOOTHED)) == [*ideal, "law of velocity, with damping"]
    assert topics(Question(IDEAL, DAHL)) == [*ideal, "estimate", "95 % interval"]
    assert topics(Question(GIVING, SMOOTHED)) == ["law of velocity, with damping"]
    assert topics(Question(GIVING, DAHL, computer=COMPUTER)) == [
        "estimate, continuous time",
        "95 % interval, continuous time",
        "small motion, sampled",
        "any motion, sampled",
    ]
    assert topics(Question(IDEAL, wall=Wall(100.0, 0.0), computer=COMPUTER)) == [
        "virtual wall, damping alone",
        "virtual wall, encoder steps",
    ]
    assert topics(Question(IDEAL, DAHL, estimates=False)) == [ideal[0], "95 % interval"]


def test_another_theorem_is_asked_and_its_refutation_simulated():
    """Given as an object with the same fields as a file of the folder states."""
    motion = SimpleNamespace(energy=0.25)
    refuted = Claim(
        "it is passive", Refutation("a motion", SimpleNamespace(energy=0.2, replay=lambda: 0.2))
    )
    holds = Claim("it is lucky", Evidence(True, "nothing", float("nan")))
    another = Theorem(
        mathematics=(),
        claims=lambda question: (
            [TopicClaim("one", refuted), TopicClaim("two", holds)] * bool(question.wall)
        ),
        order=1,
        simulate=lambda counterexample: motion,
    )
    assert settle(Question(IDEAL), theorems=[another]) == []
    one, two = settle(Question(IDEAL, wall=Wall(1.0, 0.0)), theorems=[another])
    assert one.motion is motion and one.replayed == motion.energy
    assert two.motion is None and two.claim == holds
