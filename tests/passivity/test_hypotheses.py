"""No theorem claims anything outside of its hypotheses; every one states them for every number."""

import inspect
import random
import re
from dataclasses import replace

import numpy as np
import pytest
from devices import body
from passivity.test_theorems import GIVING, IDEAL, QUESTIONS, SMOOTHED

from teleopdesign.base.errors import ModelError
from teleopdesign.blocks import Body
from teleopdesign.controllers import CONTROLLERS, controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import EFFECTS
from teleopdesign.passivity import Search, diagram_claims
from teleopdesign.passivity.identified import identify_device
from teleopdesign.passivity.theorems import THEOREMS, Question, Wall, settle
from teleopdesign.passivity.theorems._hypotheses import Positive, hypotheses_of, require_hypotheses
from teleopdesign.passivity.theorems.compliant_transmission import free_motion
from teleopdesign.passivity.theorems.velocity_compensation import velocity_compensation
from teleopdesign.simulate import Sampling

FUNCTIONS = [
    (name, function) for name, theorem in THEOREMS.items() for function in theorem.mathematics
]
NAMES = [function.__name__ for _, function in FUNCTIONS]
#: arguments that no number describes
ARGUMENTS = {
    "controller": 100,
    "coupling": 100,
    "rng": np.random.default_rng(0),
    "paths": 5,
    "order": 2,
}
NARROW = {"late": 1, "paths": 5}


def inside(function, rng):
    """Arguments within all hypotheses, of sizes that meet in these laws."""
    samples = {}
    for name in hypotheses_of(function):
        if name in ARGUMENTS | NARROW:
            samples[name] = (ARGUMENTS | NARROW)[name]
        elif "stiffness" in name:
            samples[name] = round(10 ** rng.uniform(1, 3), 3)
        elif name in ("sample_time", "delay", "time_constant", "step", "smoothing_velocity"):
            samples[name] = round(10 ** rng.uniform(-4, -2), 6)
        else:
            samples[name] = round(rng.uniform(0.1, 2.0), 3)
    low = samples.get("coulomb_level")
    for name in ("highest_level", "static_level"):
        if name in samples:
            samples[name] = low + samples[name]
    return samples


def test_every_file_of_theorems_states_one_with_its_mathematics():
    assert all(theorem.mathematics for theorem in THEOREMS.values())
    assert {"velocity_compensation", "delayed_spring", "any_environment"} <= set(NAMES)


@pytest.mark.parametrize(("theorem", "function"), FUNCTIONS, ids=NAMES)
def test_a_theorem_states_a_hypothesis_for_each_of_its_numbers(theorem, function):
    assert set(hypotheses_of(function)) == set(inspect.signature(function).parameters)


@pytest.mark.parametrize(("theorem", "function"), FUNCTIONS, ids=NAMES)
def test_within_its_hypotheses_a_theorem_answers(theorem, function):
    rng = random.Random(3)
    statuses = {function(**inside(function, rng)).status for _ in range(2)}
    assert statuses <= {"proved", "refuted", "evidence", "unknown"}


@pytest.mark.parametrize(("theorem", "function"), FUNCTIONS, ids=NAMES)
def test_outside_of_its_hypotheses_a_theorem_proves_nothing(theorem, function):
    """Each number in turn outside, the others within: refused in one line that names it."""
    rng, count = random.Random(5), 0
    for name, needs in hypotheses_of(function).items():
        for value in needs.outside:
            arguments = inside(function, rng) | {name: value}
            with pytest.raises(ModelError) as caught:
                function(**arguments)
            assert "\n" not in str(caught.value)
            assert str(caught.value).startswith(f"{function.__name__}: {name}: ")
            count += 1
    assert count >= 3 * sum(bool(h.outside) for h in hypotheses_of(function).values())


@pytest.mark.parametrize("rounds", [1, pytest.param(3, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("theorem", "function"), FUNCTIONS, ids=NAMES)
def test_a_theorem_answers_or_refuses_numbers_of_any_size(theorem, function, rounds):
    """Over sixty decades, each its own, and beyond: no traceback, no warning, no file refused."""
    rng = random.Random(11)
    for k in range(4 if function is free_motion else 4 * rounds):
        spread = (29, 12, 6, 320)[k % 4]
        numbers = {
            name: 10.0 ** rng.uniform(-spread, min(spread, 300))
            if name not in ARGUMENTS
            else ARGUMENTS[name]
            for name in hypotheses_of(function)
        }
        for name in {"late", "paths"} & {*numbers}:
            numbers[name] = rng.choice([0, 1, 9])
        try:
            claim = function(**numbers)
        except ModelError as problem:
            assert "\n" not in str(problem)
            continue
        assert all(c.check() for c in getattr(claim.verdict, "certificates", ()))


def test_a_function_without_a_hypothesis_for_an_argument_is_refused_where_it_is_defined():
    with pytest.raises(ModelError, match="other"):

        @require_hypotheses
        def half(level: Positive, other):
            return level


@pytest.mark.parametrize("delay", [0.5e-3, 1.49e-3, 1e-6])
def test_a_delay_of_no_whole_number_of_samples_is_proved_nothing(delay):
    """Held forces that change between samples are in no theorem of this folder."""
    late = Sampling(1e-3, delay, 0.0)
    with pytest.raises(ModelError, match="late: .*expected a whole number"):
        velocity_compensation(
            coulomb_level=0.5, compensator_level=0.4, sample_time=1e-3, late=delay / 1e-3
        )
    for question in QUESTIONS:
        if question.computer is None:
            continue
        claims = settle(replace(question, computer=late), simulated=False)
        # what needs nothing but a bound holds whatever the computer does
        proved = {one.topic for one in claims if one.claim.status == "proved"}
        bounded = {"any law within the level", "estimate", "95 % interval"}
        assert proved <= bounded | {f"{t}, continuous time" for t in bounded}


def test_a_law_of_velocity_is_asked_about_devices_and_spends_their_damping():
    """sqrt(f_D) <= sqrt(f_0) + sqrt(a B): f_D = 0.4 N, a = 0.01 m/s, B = 1 N s/m."""
    topic = "law of velocity, with damping"
    for device, status in ((IDEAL, "proved"), (GIVING, "refuted")):
        claims = {one.topic: one for one in settle(Question(device, SMOOTHED), simulated=False)}
        assert claims[topic].claim.status == status and claims[topic].spends_damping


def test_no_claim_on_a_wall_passes_over_steps_of_the_encoder():
    for question in QUESTIONS:
        if question.wall is None or question.computer is None:
            continue
        for one in settle(question, simulated=False):
            if "wall" in one.topic:
                assert "steps" in one.claim.statement


@pytest.mark.slow
def test_damping_that_a_theorem_spends_is_not_spent_again_by_the_linear_rest():
    """f_D = 0.6 N of 0.5 N with a = 4 mm/s rests on B = 2.5 N s/m, which the rest has, too."""
    device = body(0.15).with_effect(EFFECTS["coulomb"], {"level": 0.5})
    device = device.with_effect(EFFECTS["viscous"], {"damping": 2.5})
    law = controller("smoothed_coulomb", {"level": 0.6, "smoothing_velocity": 4e-3})
    whole = diagram_claims(
        haptic_interface(device, cancellation=law),
        rng=np.random.default_rng(0),
        search=Search(tries=1),
    )
    by_topic = {one.topic: one.claim.status for one in whole.claims}
    assert "proved" in [s for t, s in by_topic.items() if t.startswith("friction of Z_M with C")]
    assert by_topic.get("all ports, any motion") != "proved"


@pytest.mark.parametrize("name", ["dahl", "smoothed_coulomb", "coulomb"])
def test_claims_on_a_revolute_axis_have_its_units(name):
    values = {"level": 0.4, "stiffness": 1e3, "smoothing_velocity": 0.1}
    law = controller(name, {n: values[n] for n in CONTROLLERS[name].parameters})
    for wall in (None, Wall(10.0, 0.1)):
        for effects in ({}, {"presliding": {"stiffness": 2e3, "bristle_damping": 0.0}}):
            made = Body("revolute", {"inertia": 0.01})
            made = made.with_effect(EFFECTS["coulomb"], {"level": 0.5})
            made = made.with_effect(EFFECTS["viscous"], {"damping": 0.1})
            for effect, parameters in effects.items():
                made = made.with_effect(EFFECTS[effect], parameters)
            for computer in (None, Sampling(1e-3, 0.0, 1e-4)):
                question = Question(identify_device(made), law.stages[0], wall, computer)
                for one in settle(question, simulated=False):
                    text = f"{one.claim.statement} {one.claim.verdict}"
                    assert not re.search(r"\d N(?! m\b)|N s/m|\d m/s|\d kg(?! m)|\d m\b", text)


@pytest.mark.slow
def test_proved_in_continuous_time_says_so_in_its_heading():
    """Not where a computer is in the theorem, nor where it holds for both."""
    for question in QUESTIONS:
        for one in settle(question, simulated=False):
            if one.claim.status == "proved":
                assert one.heading == "proved" + " (in continuous time)" * (
                    one.time == "continuous"
                )
                if question.computer is not None and one.time == "sampled":
                    assert "(in continuous time)" not in one.heading
    law = controller("lead", {"gain": 30.0, "zero": 1.0, "pole": 10.0})
    device = body(0.15).with_effect(EFFECTS["viscous"], {"damping": 5.0})
    for diagram, sampled in (
        (haptic_interface(device, cancellation=law), True),
        (haptic_interface(device, cancellation=law, analog=("C",)), False),
    ):
        text = repr(diagram_claims(diagram, rng=np.random.default_rng(0), search=Search(tries=1)))
        assert ("proved (in continuous time)" in text) is (sampled and "proved" in text)
