"""Diagrams that no generator draws: modes that no port shows, borders within a box, late loops.

As in `test_borders_of_theorems`: each with what is true of it, and nothing false is said.
"""

import control as ct
import numpy as np
import pytest
from devices import body
from passivity.test_borders_of_theorems import contradicts

from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.passivity import Search, claim_over_intervals, diagram_claims

HELD = body(0.15, viscous__damping=2.0, spring__stiffness=10.0)
TIME, GAIN = "T.delay.time", "K.gain.gain"


def gain(k):
    return controller("gain", {"gain": k})


def law(above, below, name="law"):
    return from_control(ct.tf(above, below), name=name)


def one_body(device, *laws, sums=None, more=()):
    """laws: (controller, input, output), the outputs of which act against the body's motion."""
    blocks = (
        Moving("M", device, "x", "u", {"f": 1}, "f"),
        *(Control("KCDE"[i], made, of, to, analog=True) for i, (made, of, to) in enumerate(laws)),
    )
    acts = Junction("u", dict.fromkeys(sums or [to for *_, to in laws], -1))
    return Diagram("d", blocks, (acts, *more), {"f": "force"}, ("x",))


SPRING = gain(1.0), "x", "p"
GROWS, CANCELS = law([1], [1, -1], "grows"), law([1, -1], [1, 2], "cancels")
PORTS = {
    "plain": (one_body(HELD, SPRING), True),
    "cancelled within a controller": (one_body(HELD, (CANCELS.then(GROWS), "x", "p")), False),
    "cancelled between two": (one_body(HELD, (CANCELS, "x", "c"), (GROWS, "c", "p"), sums=["p"]),
                              False),
    "cancelled by a twin": (one_body(HELD, (GROWS, "x", "c"), (law([-1], [1, -1]), "x", "e")),
                            False),
    "heard by nothing": (one_body(HELD, SPRING, (law([1], [1, -1e-9]), "x", "e"), sums=["p"]),
                         False),
    "heard with a gain of 0": (one_body(HELD, (GROWS, "x", "c"), (gain(0.0), "c", "p"),
                                        sums=["p"]), False),
    "double integrator": (one_body(HELD, SPRING, (law([1], [1, 0, 0]), "x", "e"), sums=["p"]),
                          False),
    "two oscillators in series": (one_body(HELD, SPRING, (law([1], [1, 0, 1]), "x", "e"),
                                           (law([1], [1, 0, 1]), "e", "h"), sums=["p"]), False),
    "a loop of its own": (one_body(HELD, SPRING, (law([1], [1, 1]), "q", "h"), sums=["p"],
                                   more=(Junction("q", {"h": 2.0, "x": 1.0}),)), False),
    "spring exactly taken off": (one_body(HELD, (gain(-10.0), "x", "p")), True),
    "a hair more of it": (one_body(HELD, (gain(-10.000000000000002), "x", "p")), False),
    "hardly a mass": (one_body(body(1e-30, viscous__damping=1e-30), SPRING), True),
    "no mass": (one_body(body(0.0, viscous__damping=1.0), SPRING), True),
    "scales from 1e-12 to 1e12": (
        one_body(body(1e-12, viscous__damping=1e-12, spring__stiffness=1e12),
                 (gain(1e12), "x", "p")), True),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", PORTS)
def test_no_false_claim_is_made_on_a_port_with_modes_inside(name):
    diagram, truth = PORTS[name]
    rng = np.random.default_rng(0)

    def ask():
        return diagram_claims(diagram, rng=rng, search=Search(tries=1)).claims[0].claim

    assert not contradicts(ask, truth)


DAMPED = one_body(body(0.15, viscous__damping=1.0, spring__stiffness=10.0), SPRING)
FREE = DAMPED.with_values({GAIN: 0.0})
INSIDE = one_body(HELD, (CANCELS.then(GROWS), "x", "p"))
LAG = one_body(HELD, (law([1.0], [1, 1]), "x", "p"))
BOXES = {
    "damping from 0": (DAMPED, {"M.viscous.damping": (0.0, 1.0)},
                       {"stable": False, "passive": True}),
    "damping from 1e-9": (DAMPED, {"M.viscous.damping": (1e-9, 1.0)}, {"stable": True}),
    "spring down to 0": (FREE, {"M.spring.stiffness": (0.0, 10.0)}, {"stable": False}),
    "gain to minus the spring": (DAMPED, {GAIN: (-10.0, 1.0)}, {"stable": False, "passive": True}),
    "gain a hair beyond": (DAMPED, {GAIN: (-10.000000000001, 1.0)},
                           {"stable": False, "passive": False}),
    "a mode inside": (INSIDE, {"M.viscous.damping": (1.0, 3.0)},
                      {"stable": False, "passive": False}),
    "a pole through 0": (LAG, {"K.law.denominator_0": (-1e-6, 1.0)}, {"passive": False}),
    "a leading coefficient through 0": (LAG, {"K.law.denominator_1": (-1e-3, 1.0)},
                                        {"stable": False, "passive": False}),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", BOXES)
def test_no_false_claim_is_made_on_a_box_that_touches_a_border(name):
    diagram, box, truths = BOXES[name]
    for claim, truth in truths.items():
        assert not contradicts(
            lambda claim=claim: claim_over_intervals(diagram, box, claim=claim, points=4), truth
        )


def late(k, time, *, mass=1.0, damping=1.0, spring=1.0):
    terms = {"viscous__damping": damping, "spring__stiffness": spring}
    device = body(mass, **{n: v for n, v in terms.items() if v})
    blocks = (
        Moving("M", device, "x", "u", {"f": 1}, "f"),
        Control("T", controller("delay", {"time": time}), "x", "h", analog=True),
        Control("K", gain(k), "h", "p", analog=True),
    )
    return Diagram("late", blocks, (Junction("u", {"p": -1}),), {"f": "force"}, ("x",))


def neutral(a):
    """What acts comes back late, a times."""
    blocks = (
        Moving(
            "M", body(1.0, viscous__damping=1.0, spring__stiffness=1.0), "x", "u", {"f": 1}, "f"
        ),
        Control("T", controller("delay", {"time": 0.1}), "u", "h", analog=True),
        Control("K", gain(a), "h", "e", analog=True),
    )
    return Diagram("neutral", blocks, (Junction("u", {"e": -1}),), {"f": "force"}, ("x",))


LATE = {
    "a pole at 0": (late(-1.0, 0.1), {TIME: (0.0, 0.2)}, False),
    "a pole a hair left of 0": (late(-0.999999999, 0.1), {TIME: (0.0, 0.2)}, True),
    "a pole a hair right of 0": (late(-1.000000000000001, 0.1), {TIME: (0.0, 0.2)}, False),
    "no dead time": (late(0.5, 0.0), {GAIN: (0.1, 0.5)}, True),
    "hardly a dead time": (late(0.5, 0.1), {TIME: (0.0, 1e-12)}, True),
    # (1 - w^2)^2 + 4 w^2 >= 1 > 1/4: whatever the dead time
    "any dead time": (late(0.5, 0.1, damping=2.0), {TIME: (0.0, 50.0)}, True),
    "undamped": (late(0.5, 0.1, damping=0.0), {TIME: (0.0, 0.2)}, False),
    "fast": (late(1e3, 1e-7, mass=1e-6, spring=1e6), {TIME: (0.0, 1e-7)}, True),
    "feeble": (late(1e-13, 0.1, mass=1e-12, damping=1e-12, spring=1e-12), {TIME: (0.0, 0.2)}, True),
    "as strong as itself": (neutral(1.0), {TIME: (0.0, 0.2)}, False),
    "up to as strong": (neutral(0.95), {GAIN: (0.9, 1.0), TIME: (0.0, 0.1)}, False),
    "nearly as strong": (neutral(-0.99), {TIME: (0.0, 0.1)}, True),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", LATE)
def test_no_false_claim_is_made_on_a_late_loop_on_a_border(name):
    diagram, box, truth = LATE[name]
    assert not contradicts(
        lambda: claim_over_intervals(diagram, box, claim="stable", points=4), truth
    )
