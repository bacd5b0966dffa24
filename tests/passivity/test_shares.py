"""A cancellation counts in a proof only if its force acts unchanged on the body, and only there."""

from dataclasses import replace

import pytest
from devices import body

from teleopdesign.controllers import controller
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.passivity import ports
from teleopdesign.passivity.diagram_claims import composed_claim
from teleopdesign.passivity.friction_pairs import friction_pairs

RUBBING = body(0.3, viscous__damping=2.0, coulomb__level=0.4)
PLAIN = body(0.3, viscous__damping=2.0)
A = Moving("A", RUBBING, "x", "u", {"f": 1.0}, "f")
B = Moving("B", PLAIN, "y", "w", {"g": 1.0}, "g")
C = Control("C", controller("dahl", {"level": 0.3, "stiffness": 1e4}), "x", "F_C", "x")
PLUS = Junction("u", {"F_C": 1.0})


def wired(*blocks, sums=(PLUS,)):
    made = {s for b in blocks for s in b.outputs} | {j.output for j in sums}
    outside = {s: "force" for b in blocks for s in b.inputs if s not in made}
    outside |= {b.driver: "force" for b in blocks if isinstance(b, Moving)}
    return Diagram("pair", blocks, sums, outside, ())


FALSELY_PAIRED = {
    "one command of two bodies": wired(A, replace(B, command="u"), C),
    "the command loads another body": wired(A, replace(B, loads={"g": 1.0, "u": 1.0}), C),
    "a second sum takes the command": wired(
        A, replace(B, command="v"), C, sums=(PLUS, Junction("v", {"u": 0.5}))
    ),
    "twice, as command and as load": wired(replace(A, loads={"f": 1.0, "u": 1.0}), C),
    "twice, by a loop of sums": wired(
        A, C, sums=(Junction("u", {"F_C": 1.0, "v": 0.5}), Junction("v", {"u": 1.0}))
    ),
    "against itself": wired(replace(A, loads={"f": 1.0, "u": -2.0}), C),
    "a law sees the command": wired(
        A, B, C, Control("D", controller("gain", {"gain": 1.0}), "u", "F_D"),
        sums=(PLUS, Junction("w", {"F_D": 1.0})),
    ),
}  # fmt: skip


@pytest.mark.parametrize("diagram", FALSELY_PAIRED.values(), ids=FALSELY_PAIRED)
def test_a_cancellation_whose_force_reaches_more_is_no_part_of_a_proof(diagram):
    pairs = friction_pairs(diagram)
    assert all(pair.cancellation is None for pair in pairs)
    assert composed_claim(diagram, ports(diagram), pairs) is None


@pytest.mark.parametrize(
    "diagram",
    [
        wired(A, C),
        wired(replace(A, command="F_C"), C, sums=()),
        wired(replace(A, loads={"f": 1.0, "u": 1.0}), C, sums=(Junction("u", {"F_C": 0.5}),)),
        wired(A, B, C, sums=(Junction("u", {"v": 1.0}), Junction("v", {"F_C": 1.0}))),
    ],
)
def test_a_cancellation_that_acts_on_its_body_alone_is_proved_with_it(diagram):
    claim = composed_claim(diagram, ports(diagram), friction_pairs(diagram))
    assert claim is not None
    assert claim.claim.status == "proved"
