"""Modes that no port shows are shown to decay, or nothing is proved."""

import control as ct
import numpy as np
import pytest
import sympy as sp
from devices import body

from teleopdesign import EFFECTS
from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import ControlLaw, Controller, ControllerState, Stage, from_control
from teleopdesign.derive import transfer
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.passivity import (
    Certificate,
    claim_over_intervals,
    linear_diagrams,
    ports,
    positive_real,
)

CHAIN, APART = [[0.0, 1.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, 0.0]]
SWING = np.array([[0.0, 2.0], [-2.0, 0.0]])
SWINGS = np.block([[SWING, np.eye(2)], [np.zeros((2, 2)), SWING]])
COLUMN, ROW = np.array([[0.0], [0.0]]), np.array([[1.0, 0.0]])


def states(a, b, c, d=100.0):
    return from_control(ct.ss(np.array(a), np.array(b), np.array(c), [[d]]))


def ratio(*sides):
    return from_control(ct.tf(*sides), name="ratio")


def held(*laws, damping=2.0):
    """A mass on what the laws make of its position, one after the other."""
    signals = ["x", *(f"y{k}" for k in range(len(laws)))]
    controls = [
        Control(f"C{k}", law, signals[k], signals[k + 1], "x") for k, law in enumerate(laws)
    ]
    mass = Moving("M", body(0.15, viscous__damping=damping), "x", "u", {"f": 1}, "f")
    force = Junction("u", {signals[-1]: -1})
    return Diagram("held", (mass, *controls), (force,), {"f": "force"}, ())


def multiple(power, *, at=0.0):
    """(s^2 + at^2)^power, or s^power."""
    factor = [1.0, 0.0] if not at else [1.0, 0.0, at**2]
    made = np.ones(1)
    for _ in range(power):
        made = np.polymul(made, factor)
    return made


#: dw/dt = q, dq/dt = 0: the law's output, a spring, sees neither
UNSEEN_CHAIN = ControlLaw(
    law=lambda now, p: 100 * now.input,
    states={
        "w": ControllerState("position", lambda now, p: now.q),
        "q": ControllerState("position", lambda now, p: sp.S(0)),
    },
    linear=True,
    parameters={},
    name="unseen",
)

GROWING = {
    "driven by nothing": [states(CHAIN, COLUMN, ROW)],
    "read by nothing": [states(CHAIN, [[0.0], [1.0]], 0 * ROW)],
    "in one ratio": [ratio([100.0, 0.0, 0.0], [1.0, 0.0, 0.0])],
    "a swing, driven by nothing": [states(SWINGS, np.zeros((4, 1)), np.eye(1, 4))],
    "a swing in one ratio": [ratio(100 * multiple(2, at=2.0), multiple(2, at=2.0))],
    "between two blocks": [ratio([1.0], multiple(2)), ratio([100.0, 0, 0], [1.0, 20.0, 100.0])],
    "within a law of one's own": [Controller((Stage(UNSEEN_CHAIN, {}),))],
    "one of them read": [
        states([[0, 1, 0], [0, 0, 0], [0, 0, -1.0]], [[0], [0], [1.0]], [[1, 0, 5.0]])
    ],
}  # fmt: skip


STAYING = {
    "one pole at 0": [ratio([100.0, 0.0], [1.0, 0.0])],
    "two that do not drive each other": [states(APART, COLUMN, ROW)],
    "in two laws": [ratio([100.0, 0.0], [1.0, 0.0]), ratio([1.0, 0.0], [1.0, 0.0])],
    "a swing": [ratio(100 * multiple(1, at=2.0), multiple(1, at=2.0))],
}

DECAYING = {
    "nothing hidden": [ratio([100.0], [1.0])],
    "read by nothing": [states([[-1.0]], [[1.0]], [[0.0]])],
    "driven by nothing": [states([[-1.0]], [[0.0]], [[1.0]])],
    "in one ratio": [ratio([100.0, 300.0], [1.0, 3.0])],
    "between two laws": [ratio([1.0], [1.0, 3.0]), ratio([100.0, 300.0], [1.0, 1.0])],
}


def status(diagram):
    (one,) = linear_diagrams.linear_claims(diagram, ports(diagram))
    return one.claim.status


@pytest.mark.parametrize("laws", [*GROWING.values(), *STAYING.values()])
def test_beside_a_mode_that_no_port_shows_and_that_does_not_decay_nothing_is_proved(laws):
    """One that keeps its size counts too: driven by nothing, it may push the port for ever."""
    diagram = held(*laws)
    alone = positive_real(ports_impedance(diagram)).status
    assert status(diagram) == ("unknown" if alone == "proved" else alone) != "proved"


@pytest.mark.parametrize("laws", DECAYING.values(), ids=DECAYING)
def test_modes_that_decay_need_no_port(laws):
    claim = status(held(*laws))
    impedance = positive_real(ports_impedance(held(*laws)))
    assert claim == impedance.status and impedance.status in ("proved", "refuted")


def ports_impedance(diagram):
    from teleopdesign.passivity.linear.family import family_at

    return family_at(diagram, ports(diagram)).z[0, 0]


def test_a_free_mass_drifts_where_its_port_shows_it():
    assert status(held(ratio([0.0], [1.0]), damping=0.0)) == "proved"


@pytest.mark.parametrize(
    ("system", "status"),
    [
        (ct.ss(CHAIN, COLUMN, ROW, [[2.0]]), "unknown"),
        (ct.ss(APART, COLUMN, ROW, [[2.0]]), "unknown"),
        (ct.tf([2.0, 0.0, 0.0], [1.0, 0.0, 0.0]), "unknown"),
        (ct.tf([2.0, 0.0], [1.0, 0.0]), "unknown"),
        (ct.tf([2.0, 2.0], [1.0, 1.0]), "proved"),
        (ct.ss(CHAIN, [[1.0], [0.0]], ROW, [[2.0]]), "unknown"),  # 2 + 1/s, and what drives 1/s
    ],
)
def test_an_impedance_of_python_control_is_proved_only_where_its_states_decay(system, status):
    assert positive_real(system).status == status


@pytest.mark.parametrize("laws", [GROWING["in one ratio"], STAYING["one pole at 0"]])
def test_a_hidden_pole_on_the_axis_is_proved_nothing_over_an_interval(laws):
    damping = {"M.viscous.damping": (1.0, 3.0)}
    assert claim_over_intervals(held(*laws), damping).status != "proved"
    for law in ("nothing hidden", "read by nothing"):
        assert claim_over_intervals(held(*DECAYING[law]), damping).status == "proved"


def test_a_mode_that_no_port_shows_decays_in_the_whole_interval_or_is_proved_nothing():
    """dx/dt = -a x + q, dq/dt = -q: x decays for a > 0."""

    def driven(a):
        return held(states([[-a, 1.0], [0.0, -1.0]], [[0.0], [0.0]], ROW))

    name = "C0.state_space.a_0_0"
    assert claim_over_intervals(driven(0.5), {name: (-1.0, 0.0)}).status != "proved"
    assert claim_over_intervals(driven(0.5), {name: (-1.0, -0.1)}).status == "proved"


def test_a_block_of_the_name_of_an_actuator_is_refused():
    """Under one symbol its stiffness of 100 N/m was taken for the actuator's gain of 0.5."""
    diagram = held(ratio([100.0], [1.0]))
    mass, law = diagram.blocks
    driven = mass.body.with_effect(EFFECTS["actuator_gain"], {"gain": 0.5})
    blocks = (
        Moving("M", driven, "x", "u", {"f": 1}, "f"),
        Control("A_M", law.controller, "x", "y0", "x"),
    )
    doubled = Diagram("named", blocks, diagram.junctions, {"f": "force"}, ())
    with pytest.raises(ModelError, match="A_M is the actuator of M, and the name of a block"):
        transfer(doubled, "x")


def test_evidence_beside_a_hidden_mode_is_none(monkeypatch):
    """Where a certificate would ask for too much work, the exact answer is evidence: it counts."""

    def too_much(*_):
        raise ModelError("more work than a certificate may ask for")

    monkeypatch.setattr(Certificate, "check", too_much)
    for laws, holds in ((GROWING["in one ratio"], None), (DECAYING["in one ratio"], True)):
        diagram = held(*laws)
        (one,) = linear_diagrams.linear_claims(diagram, ports(diagram))
        assert one.claim.holds is holds and one.claim.status != "proved"
