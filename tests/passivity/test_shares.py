"""A cancellation counts in a proof only if its force acts unchanged on the body, and only there."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from devices import body
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.diagrams import Attached, Control, Diagram, Junction, Moving, position_symbol
from teleopdesign.passivity import ports
from teleopdesign.passivity.diagram_claims import composed_claim, friction_pairs
from teleopdesign.passivity.ports import shares_of

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


def test_a_port_counts_a_force_as_often_as_a_loop_of_sums_does():
    loop = (Junction("l", {"f": 1.0, "m": 0.5}), Junction("m", {"l": 1.0}))
    (port,) = ports(wired(replace(A, loads={"l": 1.0}), sums=loop))
    assert port.weights == {"x": 2.0}
    with pytest.raises(ModelError, match="a loop of sums has no solution"):
        ports(wired(replace(A, loads={"l": 1.0}), sums=(loop[0], Junction("m", {"l": 2.0}))))


def test_a_share_is_exact_and_keeps_the_positions_of_a_lever_arm():
    q = position_symbol("x")
    sums = (Junction("t", {"f": 0.1}), Junction("r", {"t": 3 * sp.sin(q)}))
    diagram = wired(replace(A, loads={"r": 1.0}), sums=sums)
    assert shares_of(diagram, "f")["r"] == sp.Rational(3, 10) * sp.sin(q)


@given(st.lists(st.integers(-3, 3), min_size=16, max_size=16))
def test_shares_solve_the_equations_of_the_sums(weights):
    names = ["a", "b", "c", "d"]
    grid = np.array(weights).reshape(4, 4)
    sums = tuple(
        Junction(n, {**{m: float(w) for m, w in zip(names, row, strict=True) if w}, "f": 1.0})
        for n, row in zip(names, grid, strict=True)
    )
    diagram = wired(replace(A, loads={"f": 1.0}), sums=sums)
    system = np.eye(4) - grid
    if round(np.linalg.det(system)) == 0:
        with pytest.raises(ModelError, match="no solution"):
            shares_of(diagram, "f")
        return
    shares = [float(shares_of(diagram, "f").get(n, 0)) for n in names]
    # determinants are whole numbers of at most some thousand: far above double rounding
    assert np.allclose(system @ shares, 1.0, atol=1e-9)


def test_an_attached_body_takes_no_forces():
    held = Attached("Z_K", PLAIN, "x", "F_K")
    assert friction_pairs(wired(A, C, held))[0].cancellation is C
