"""Passivity of late loops, at points and over boxes, against hands that make a mode grow.

A hand of damper, mass and spring adds to the numbers of the body at a port. So what a hand makes of
the loop is the same loop with other numbers, whose growing modes are counted by the turns of f. A
port that holds grows with no hand: neither what its impedance shows nor what it hides.
"""

from collections import Counter

import control as ct
import numpy as np
import pytest
from passivity.attacks.budget import attacked
from passivity.attacks.late_modes import count_growing
from passivity.attacks.test_late_families import (
    FAMILIES,
    TIME,
    delay,
    device,
    impedance,
    mass,
    pick,
    points,
    random_box,
    times,
)

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.passivity import claim_over_intervals

#: relative to the mode of the body: a hand that holds it almost free, to almost fixed
_SIZES = (-4.0, 4.0)
HANDS = 20


class Apart:
    """Beside a damped mass z' = -p z - k z(t - T), which it drives and which it does not feel."""

    names = ("M.inertia", "M.viscous.damping", "K.gain.gain")

    def draw(self, rng):
        return {**mass(rng), "p": pick(rng, -1, 1), "K.gain.gain": pick(rng, -1, 1.5),
                TIME: pick(rng, -2.5, 0.3)}  # fmt: skip

    def diagram(self, v):
        law = from_control(ct.tf([1.0], [1, v["p"]]), name="own")
        blocks = (
            Moving("M", device(v), "x", "u", {"f": 1}, "f"),
            Control("C", law, "e", "z", analog=True),
            delay("T_1", v, ("z", "late")),
            Control("K", controller("gain", {"gain": v["K.gain.gain"]}), "late", "k", analog=True),
        )
        sums = (Junction("u", {}), Junction("e", {"x": 1.0, "k": -1.0}))
        return Diagram("apart", blocks, sums, {"f": "force"}, ("x",))

    def terms(self, v):
        z = impedance(v)
        return [(times(z, [1, v["p"]]), 0.0), (times(z, [v["K.gain.gain"]]), v[TIME])]


def with_hands(rng, values):
    """The numbers with a hand at each body: parts of it are absent, or of any size."""
    held = dict(values)
    for name in ("M", "S"):
        m = values.get(f"{name}.inertia")
        if m is None:
            continue
        rate = 10 ** rng.uniform(-2, 3)
        for part, power in (("inertia", 0), ("viscous.damping", 1), ("spring.stiffness", 2)):
            if rng.random() < 0.6:
                held[f"{name}.{part}"] += m * rate**power * 10 ** rng.uniform(*_SIZES)
    return held


def beaten_by(rng, family, values):
    """Numbers with hands with which a mode grows; None where no hand makes one grow."""
    for _ in range(HANDS):
        held = with_hands(rng, values)
        # at a body that no spring holds a mode rests at 0, which count_growing cannot tell
        if count_growing(family.terms(held)):
            return held
    return None


@pytest.mark.slow
@pytest.mark.parametrize("family", [*FAMILIES, Apart()], ids=lambda f: type(f).__name__.lower())
@attacked(0, 4)
def test_no_hand_makes_a_late_loop_grow_that_is_called_passive(family, seed, number):
    rng, counts = np.random.default_rng(seed), Counter()
    for k in range(number):
        values = family.draw(rng)
        for name in ("M", "S"):  # a port that is passive at all needs damping
            damping = f"{name}.viscous.damping"
            if damping in values and rng.random() < 0.7:
                values[damping] *= pick(rng, 0, 2)
        box = random_box(rng, family, values) if k % 2 else {}
        two = type(family).__name__ == "Coupled" and rng.random() < 0.5
        claim = "absolutely stable" if two else "passive"
        try:
            made = claim_over_intervals(family.diagram(values), box, claim=claim, points=4)
        except ModelError:
            counts["refused"] += 1
            continue
        counts[claim, "box" if box else "point", made.status] += 1
        if made.holds:
            for point in points(rng, box) if box else ({},):
                held = beaten_by(rng, family, {**values, **point})
                assert held is None, (claim, values, box, held, made)
        elif made.status == "refuted" and beaten_by(rng, family, {**values, **made.worst}):
            counts[claim, "refuted, and beaten by a hand"] += 1
    print(type(family).__name__, dict(counts))
