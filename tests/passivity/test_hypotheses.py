"""No theorem claims anything outside of its hypotheses; every one states them for every number."""

import inspect
import random
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from devices import body
from passivity.test_theorems import QUESTIONS

from teleopdesign import passivity
from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import EFFECTS
from teleopdesign.passivity import Search, diagram_claims
from teleopdesign.passivity.theorems import settle
from teleopdesign.passivity.theorems._hypotheses import Positive, require_hypotheses
from teleopdesign.passivity.theorems.velocity_compensation import velocity_compensation
from teleopdesign.simulate import Sampling

PUBLIC = (getattr(passivity, name) for name in passivity.__all__)
FUNCTIONS = [thing for thing in PUBLIC if hasattr(thing, "hypotheses")]
NAMES = [function.__name__ for function in FUNCTIONS]
#: values that violate each condition
NO_NUMBER = (float("nan"), float("inf"), True, 1e-300, 1e300)
OUTSIDE = {
    "a number > 0": (0, -1, Fraction(-1, 10**9), *NO_NUMBER),
    "a number >= 0": (-1, Fraction(-1, 10**9), *NO_NUMBER),
    "a finite number": NO_NUMBER,
    "a whole number >= 0, at most 10000": (-1, 0.5, Fraction(3, 2), 10_001, *NO_NUMBER),
    "1 or 2": (3, 0, 0.5),
    "anything": (),
}
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
    for name in function.hypotheses:
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


@pytest.mark.parametrize("function", FUNCTIONS, ids=NAMES)
def test_a_theorem_states_a_hypothesis_for_each_of_its_numbers(function):
    assert set(function.hypotheses) == set(inspect.signature(function).parameters)


@pytest.mark.parametrize("function", FUNCTIONS, ids=NAMES)
def test_within_its_hypotheses_a_theorem_answers(function):
    rng = random.Random(3)
    statuses = {function(**inside(function, rng)).status for _ in range(2)}
    assert statuses <= {"proved", "refuted", "evidence", "unknown"}


@pytest.mark.parametrize("function", FUNCTIONS, ids=NAMES)
def test_outside_of_its_hypotheses_a_theorem_proves_nothing(function):
    """Each number in turn outside, the others within: refused in one line that names it."""
    rng, count = random.Random(5), 0
    for name, needs in function.hypotheses.items():
        for value in OUTSIDE[needs.text.removesuffix(" or None")]:
            arguments = inside(function, rng) | {name: value}
            with pytest.raises(ModelError) as caught:
                function(**arguments)
            assert "\n" not in str(caught.value)
            assert str(caught.value).startswith(f"{function.__name__}: {name}: ")
            count += 1
    assert count >= 3 * sum(h.text != "anything" for h in function.hypotheses.values())


@pytest.mark.parametrize("rounds", [1, pytest.param(3, marks=pytest.mark.slow)])
@pytest.mark.parametrize("function", FUNCTIONS, ids=NAMES)
def test_a_theorem_answers_or_refuses_numbers_of_any_size(function, rounds):
    """Over sixty decades, each its own, and beyond: no traceback, no warning, no file refused."""
    rng = random.Random(11)
    for k in range(4 if function.__name__ == "free_motion" else 4 * rounds):
        spread = (29, 12, 6, 320)[k % 4]
        numbers = {
            name: 10.0 ** rng.uniform(-spread, min(spread, 300))
            if name not in ARGUMENTS
            else ARGUMENTS[name]
            for name in function.hypotheses
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


def test_no_claim_on_a_wall_passes_over_steps_of_the_encoder():
    for question in QUESTIONS:
        if question.wall is None or question.computer is None:
            continue
        for one in settle(question, simulated=False):
            if "wall" in one.topic:
                assert "steps" in one.claim.statement


@pytest.mark.slow
def test_damping_that_a_theorem_spends_is_taken_from_the_linear_rest():
    """f_D = 0.6 N of 0.5 N with a = 4 mm/s rests on B = 2.5 N s/m; the rest is a mass then."""
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
    assert by_topic.get("all ports, any motion") == "proved"
