"""Claims about large systems end: with an answer, or unknown after a bounded effort."""

import pytest
from devices import body

from teleopdesign.controllers import controller
from teleopdesign.derive.effort import bounded_effort
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.passivity import claim_over_intervals, diagram_claims


def chain(count, laws):
    """Bodies in a row, coupled by springs with dampers, the first of them behind two low-passes.

    Both ends have ports.
    """
    blocks, junctions = [], []
    for k in range(1, count + 1):
        end = k in (1, count)
        loads = {f"f{k}": 1.0} if end else {}
        loads |= {f"c{k}": -1.0} if k < count else {f"c{k - 1}": 1.0}
        one = body(0.1 + 0.03 * k, viscous__damping=1.0 + 0.37 * k)
        command, driver = (f"u{k}", f"f{k}") if end else (f"c{k - 1}", "f1")
        blocks.append(Moving(f"Z{k}", one, f"x{k}", command, loads, driver))
    for k in range(1, count):
        junctions.append(Junction(f"d{k}", {f"x{k}": 1.0, f"x{k + 1}": -1.0}))
        law = controller("spring_damper", {"stiffness": 300.0 + 71 * k, "damping": 1.3 + 0.11 * k})
        for bandwidth in (50.0 + 13 * k, 83.0 + 7 * k) if k <= laws else ():
            law = law.then(controller("low_pass", {"bandwidth": bandwidth}))
        blocks.append(Control(f"P{k}", law, f"d{k}", f"c{k}", f"d{k}", analog=True))
    outside = {f"{letter}{k}": "force" for letter in "uf" for k in (1, count)}
    return Diagram("chain", tuple(blocks), tuple(junctions), outside, ())


@pytest.mark.slow
def test_eight_intervals_on_four_bodies_are_proved():
    diagram = chain(4, 0)
    names = [f"Z{k}.{n}" for k in range(1, 5) for n in ("inertia", "viscous.damping")]
    intervals = {n: (0.9 * diagram.values[n], 1.1 * diagram.values[n]) for n in names}
    assert claim_over_intervals(diagram, intervals).status == "proved"


@pytest.mark.parametrize(
    ("claim", "most"),
    [
        ("stable", 10),
        ("stable", 1000),
        *(pytest.param(c, 1000, marks=pytest.mark.slow) for c in ("passive", "absolutely stable")),
    ],
)
def test_too_much_effort_is_no_answer_and_no_error(claim, most):
    """Wherever in a proof the bound is reached; what is decided before it stays decided."""
    diagram = chain(3, 1)
    intervals = {n: (0.5, 2.0) for n in ("Z1.inertia", "Z2.viscous.damping", "Z3.inertia")}
    with bounded_effort(most):
        short = claim_over_intervals(diagram, intervals, claim=claim, points=4)
    if short.status not in ("unknown", "evidence"):
        whole = claim_over_intervals(diagram, intervals, claim=claim, points=4)
        assert short.status == whole.status
    with bounded_effort(most):
        claims = diagram_claims(diagram, rng=0).claims
    assert {one.claim.status for one in claims} <= {"unknown", "proved"}
