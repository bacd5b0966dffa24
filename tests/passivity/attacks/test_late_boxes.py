"""Stability over boxes with dead times against the modes at points of the box.

A mass on a damper and a spring; a law of its position, K + B s/(1 + tau s), that hears it late and
acts late, and at times a second way back without the law.
"""

from collections import Counter

import numpy as np
import pytest
from devices import body
from passivity.attacks.budget import attacked
from passivity.attacks.late_modes import NEAR, rightmost_of_two

from teleopdesign.controllers import controller
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.passivity import claim_over_intervals

LAW = "P.proportional_derivative"


def pick(rng, low, high):
    return float(f"{10 ** rng.uniform(low, high):.3g}")


def random_values(rng):
    return {
        "M.inertia": pick(rng, -2, 1),
        "M.viscous.damping": pick(rng, -1, 1.5),
        "M.spring.stiffness": pick(rng, -1, 2),
        f"{LAW}.stiffness": pick(rng, -1, 2.5),
        f"{LAW}.damping": pick(rng, -2, 1),
        f"{LAW}.bandwidth": pick(rng, -1, 1.5),
        "G.gain.gain": pick(rng, -1, 1.5) * float(rng.choice([-1, 0, 1])),
        "T_1.delay.time": pick(rng, -3, 0.5),
        "T_2.delay.time": pick(rng, -3, 0.5) * (rng.random() < 0.6),
    }


def late_diagram(values):
    def law(name, block, *parameters):
        return controller(name, {p: values[f"{block}.{name}.{p}"] for p in parameters})

    device = body(
        values["M.inertia"],
        viscous__damping=values["M.viscous.damping"],
        spring__stiffness=values["M.spring.stiffness"],
    )
    terms = "stiffness", "damping", "bandwidth"
    blocks = (
        Moving("M", device, "x", "u", {"f": 1}, "f"),
        Control("T_1", law("delay", "T_1", "time"), "x", "heard", analog=True),
        Control("P", law("proportional_derivative", "P", *terms), "heard", "p", analog=True),
        Control("G", law("gain", "G", "gain"), "heard", "g", analog=True),
        Control("T_2", law("delay", "T_2", "time"), "p", "acts", analog=True),
    )
    sums = (Junction("u", {"acts": -1, "g": -1}),)
    return Diagram("late", blocks, sums, {"f": "force"}, ("x",))


def largest(values):
    """The largest real part at these values over the largest pole, by both grids."""
    m, b, k = (values[f"M.{n}"] for n in ("inertia", "viscous.damping", "spring.stiffness"))
    stiff, damp = values[f"{LAW}.stiffness"], values[f"{LAW}.damping"]
    corner = 2 * np.pi * values[f"{LAW}.bandwidth"]
    heard, acts = values["T_1.delay.time"], values["T_2.delay.time"]
    # states x, v, and the law's lag q of what it hears: p = K x + B corner (x - q)
    now = np.array([[0, 1, 0], [-k / m, -b / m, 0], [0, 0, -corner]])
    at_heard = np.array([[0, 0, 0], [-values["G.gain.gain"] / m, 0, 0], [corner, 0, 0]])
    at_acts = np.array([[0, 0, 0], [0, 0, damp * corner / m], [0, 0, 0]])
    at_both = np.array([[0, 0, 0], [-(stiff + damp * corner) / m, 0, 0], [0, 0, 0]])
    late = [(at_heard, heard), (at_acts, acts), (at_both, heard + acts)]
    size = np.abs(np.linalg.eigvals(now)).max()
    return rightmost_of_two(now, late) / size


def random_box(rng, values):
    """One to three values, a dead time always among them."""
    others = [n for n in values if values[n] and not n.endswith("time")]
    names = ["T_1.delay.time", *rng.choice(others, int(rng.integers(0, 3)), replace=False)]
    box = {}
    for n in map(str, names):
        low, high = values[n] * (1 - 0.9 * rng.random()), values[n] * (1 + 2 * rng.random())
        low, high = (float(f"{x:.3g}") for x in sorted((low, high)))
        box[n] = (low, high) if low < high else (low, low + 0.1 * abs(low))
    return box


@pytest.mark.slow
@attacked(4, 8)
def test_no_box_with_dead_times_is_proved_stable_in_which_a_mode_grows(seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for _ in range(number):
        values = random_values(rng)
        box = random_box(rng, values)
        claim = claim_over_intervals(late_diagram(values), box, claim="stable", points=8)
        counts[claim.status] += 1
        if claim.status == "refuted":
            assert (largest({**values, **claim.worst}) > -NEAR).any(), (values, box, claim)
        if claim.status != "proved":
            continue
        for k in range(24):
            share = rng.random(len(box)) if k % 2 else rng.integers(0, 2, len(box))
            ends = zip(box.items(), share, strict=True)
            point = {n: low + (high - low) * u for (n, (low, high)), u in ends}
            assert (largest({**values, **point}) < NEAR).any(), (values, box, point)
    print(dict(counts))
    assert counts["proved"] and counts["refuted"]
