"""Modes that no port shows are shown to decay, or nothing is proved."""

import control as ct
import numpy as np
import pytest
import sympy as sp
from devices import body

from teleopdesign.controllers import (
    ControlLaw,
    Controller,
    ControllerState,
    Stage,
    controller,
)
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.effects import Effect, Parameter, State
from teleopdesign.passivity import (
    absolutely_stable,
    damping_excess,
    impedance,
    passive,
    ports,
    positive_real,
    teleoperator_two_port,
    two_port,
    wave_teleoperator,
)
from teleopdesign.passivity.linear.family import family_at
from teleopdesign.passivity.linear_diagrams import linear_claims
from teleopdesign.realise.lti import S

#: (s + 2)/(s + 1) from rest, with a state that nothing shows
GROWS, DECAYS = (
    ct.ss([[-1.0, 0.0], [0.0, a]], [[1.0], [0.0]], [[1.0, 0.0]], [[1.0]]) for a in (1.0, -3.0)
)
#: claims in which such a system is a part
WHOLE = {
    "its impedance": lambda one: positive_real(impedance(one)),
    "one entry": lambda one: absolutely_stable(two_port([[impedance(one), 0], [0, 1]])),
    "a teleoperator": lambda one: passive(
        teleoperator_two_port(master=1, slave=one, stiffness=2.0, damping=1.0)
    ),
    "waves": lambda one: wave_teleoperator(
        master=impedance(one), slave=1, coupling=1, wave_impedance=1
    ),
}


@pytest.mark.parametrize("whole", WHOLE)
def test_a_state_that_a_part_hides_counts_in_the_whole(whole):
    assert WHOLE[whole](DECAYS).status == "proved"
    assert WHOLE[whole](GROWS).status == "unknown"
    assert float(damping_excess(DECAYS)) == 1 and float(damping_excess(GROWS)) == -np.inf


UNBOUNDED = {"lower": -float("inf"), "upper": float("inf")}
#: z' = input + a z; the output, a spring, does not see it
UNSEEN = ControlLaw(
    law=lambda now, p: p.k * now.input,
    states={"z": ControllerState("dimensionless", lambda now, p: now.input + p.a * now.z)},
    parameters={n: Parameter("dimensionless", "any", **UNBOUNDED) for n in "ak"},
    linear=True,
    name="unseen",
)


def loop(law, weight=-1):
    made = Controller((Stage(law, {"a": -1.0, "k": 1.0}),))
    parts = (
        Moving("M", body(0.15, viscous__damping=4.0), "x", "u", {"f": 1.0}, "f"),
        Control("C", made, "x", "y", "x"),
    )
    return Diagram("loop", parts, (Junction("u", {"y": weight}),), {"f": "force"}, ("x",))


def test_weights_that_are_decimals_sum_up_as_they_are_written():
    """0.1 + 0.2 - 0.3 is 0 here, and 0.1 + 0.2 is not the float 0.30000000000000004."""
    for last, left in ((-0.3, 0), (-0.30000000000000004, sp.Rational("-4e-17"))):
        diagram = loop(UNSEEN)
        sums = (
            Junction("w", {"y": 0.1}),
            Junction("w2", {"y": 0.2, "w": 1.0}),
            Junction("u", {"w2": -1.0, "y": -last}),
        )
        wired = Diagram("sums", diagram.blocks, sums, {"f": "force"}, ("x",))
        z = family_at(wired, ports(wired)).z[0]
        assert sp.expand(sp.cancel(z * S)).coeff(S, 0) == left


def effect(name, law, rate):
    known = {n: Parameter("dimensionless", "any", **UNBOUNDED) for n in "ak"}
    return Effect(
        role="force",
        energy="supplies",
        law=law,
        states={"z": State("dimensionless", rate)},
        linear=True,
        parameters=known,
        absent={"k": 0.0},
        source="none",
    ).named(name, "")


def driven(now, p):
    return p.a * now.z + now.velocity


#: one that its force does not show; two that take each other's force away
UNFELT = [effect("damper", lambda now, p: p.k * now.velocity, driven)]
AGAINST = [
    effect("push", lambda now, p: p.k * now.z, driven),
    effect("pull", lambda now, p: -p.k * now.z, driven),
]


def alone(effects, a):
    device = body(0.15, viscous__damping=4.0, spring__stiffness=5.0)
    for one in effects:
        device = device.with_effect(one, {"a": a, "k": 2.0})
    moving = Moving("M", device, "x", "u", {"f": 1.0}, "f")
    return Diagram("alone", (moving,), (Junction("u", {}),), {"f": "force"}, ("x",))


@pytest.mark.parametrize("effects", [UNFELT, AGAINST], ids=["unfelt", "against each other"])
def test_a_state_of_effects_that_grows_and_that_no_force_shows_is_not_proved(effects):
    diagram = alone(effects, 0.5)
    claims = linear_claims(diagram, ports(diagram))
    assert [one.claim.status for one in claims] == ["unknown"]


@pytest.mark.parametrize(
    ("wired", "delay"), [("a gain of 0", 0.1), ("nothing", 0.0), ("what cancels", 0.1)]
)
def test_what_grows_before_a_delay_that_no_port_hears_is_not_proved(delay, wired):
    """The delay is in no impedance, and the law before it grows all the same."""
    grows = Controller((Stage(UNSEEN, {"a": 0.5, "k": 0.0}),))
    late = controller("delay", {"time": delay})
    body_alone = loop(UNSEEN).blocks[0]
    terms = {"a gain of 0": {"y": 0.0}, "nothing": {}, "what cancels": {"y": 1.0, "z": -1.0}}[wired]
    again = [Control("E", late, "d", "z")] if wired == "what cancels" else []
    blocks = (body_alone, Control("C", grows, "x", "d"), Control("D", late, "d", "y"), *again)
    diagram = Diagram("late", blocks, (Junction("u", terms),), {"f": "force"}, ("x",))
    claims = linear_claims(diagram, ports(diagram))
    assert {one.claim.status for one in claims} == {"unknown"}
