"""A law that reads one signal and acts along the velocity of a motion is one system in all forms.

The velocity is that of the motion that the block is wired along, whatever its input is.
"""

from dataclasses import replace

import control
import numpy as np
import pytest
from devices import body

from teleopdesign.controllers import (
    CONTROLLERS,
    ControlLaw,
    Controller,
    ControllerState,
    Stage,
    controller,
    from_control,
)
from teleopdesign.derive import as_text, transfer, transfer_function
from teleopdesign.derive.transfer_functions import with_values
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.effects import Parameter
from teleopdesign.frequency import delay_margin, loop_gain, matrix_response
from teleopdesign.frequency.impedance_map import quasi_linear_impedance
from teleopdesign.passivity import claim_over_intervals, diagram_claims, ports
from teleopdesign.passivity.linear.family import family_at
from teleopdesign.passivity.linear_diagrams import linear_claims
from teleopdesign.realise.iosystem import to_iosystem
from teleopdesign.realise.lti import numerical
from teleopdesign.simulate import simulate, sine


def probe(law):
    """The law with 10, 13, 16 ... for its parameters, or the nearest within bounds; 20 ms late."""
    steps = enumerate(law.parameters.items())
    values = {n: min(max(10.0 + 3.0 * i, p.lower), p.upper) for i, (n, p) in steps}
    if law.dead_time:
        values[law.dead_time] = 0.02
    return Controller((Stage(law, values),))


#: a user's own: a share of a force, and a damper on the motion
FORCE_AND_DAMPER = ControlLaw(
    law=lambda now, p: p.share * now.input - p.damping * now.velocity,
    linear=True,
    parameters={
        "share": Parameter("dimensionless", "of the input"),
        "damping": Parameter("damping", "against the motion"),
    },
    name="force_and_damper",
)
FREQUENCY = 3.0  # Hz
SPRING = controller("spring_damper", {"stiffness": 300.0, "damping": 5.0})
LAWS = {name: probe(law) for name, law in CONTROLLERS.items() if law.linear} | {
    "spring_damper": SPRING,
    # its transients are as fast as those of the others
    "virtual_admittance": controller(
        "virtual_admittance", {"inertia": 0.1, "damping": 5.0, "stiffness": 100.0}
    ),
    "spring behind a low-pass": controller("low_pass", {"bandwidth": 9.0}).then(SPRING),
    "low-pass behind a spring": SPRING.then(controller("low_pass", {"bandwidth": 9.0})),
    "a user's own": Controller((Stage(FORCE_AND_DAMPER, {"share": 0.4, "damping": 3.0}),)),
    "from_control": from_control(control.tf([3.0, 80.0], [1.0, 40.0])),
}
FRONTS = {
    "delayed": controller("delay", {"time": 0.015}),
    "low-passed": controller("low_pass", {"bandwidth": 4.0}),
    "scaled": controller("gain", {"gain": -0.7}),
}


def behind(front, law, motion="x"):
    """A rod whose position comes to the law through a front; the law pulls the rod."""
    return Diagram(
        "behind a front",
        (
            Moving("M", body(0.2, viscous__damping=4.0), "x", "u", {"f": 1}, "f"),
            Control("T", front, "x", "x_read", "x", analog=True),
            Control("K", law, "x_read", "F_K", motion, analog=True),
        ),
        (Junction("u", {"F_K": -1}),),
        {"f": "force"},
        measured=("x",),
    )


#: every law behind one front, the fronts in turn
BEHIND = [(name, list(FRONTS)[i % len(FRONTS)]) for i, name in enumerate(LAWS)]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "front"), BEHIND)
def test_the_derived_response_is_that_of_a_simulated_sine(name, front):
    """1e-5: order four at 1 ms and 3 Hz. The rod is led, so little that abs(v) freezes no gain.

    The sine is fitted over the second second: transients, 16 rad/s and faster, are 1e-7 then.
    """
    diagram, w, amplitude = behind(FRONTS[front], LAWS[name]), 2 * np.pi * FREQUENCY, 1e-8
    expression, linear = with_values(diagram, output="F_K", input="x", given="x")
    assert linear.left_out == ()
    expected = complex(numerical(expression)(np.array([1j * w]))[0])
    motion = {"x": sine(amplitude=amplitude, frequency=FREQUENCY)}
    run = simulate(
        diagram, duration=2.0, motion=motion, computer="continuous", step=1e-3, jit=False
    )
    last = run["time"].values > 1.0
    phase = w * run["time"].values[last]
    columns = np.stack([np.sin(phase), np.cos(phase)], axis=1)
    share, *_ = np.linalg.lstsq(columns, run["F_K"].values[last] / amplitude, rcond=None)
    assert complex(*share) == pytest.approx(expected, rel=1e-5)


#: a low-pass in front: python-control holds it, so that its linearisation is another witness
RATIONAL = [n for n in LAWS if not CONTROLLERS.get(n, FORCE_AND_DAMPER).dead_time]


@pytest.mark.slow
@pytest.mark.parametrize("name", RATIONAL)
def test_the_closed_loop_is_that_which_python_control_linearises(name):
    """Bode, matrix response and loop gain; 1e-5: differences of python-control's linearisation."""
    diagram = behind(FRONTS["low-passed"], LAWS[name])
    whole = to_iosystem(diagram)
    system, at = control.linearize(whole, 0.0, 0.0, eps=1e-7), whole.output_labels.index("x")
    s = 2j * np.pi * FREQUENCY
    theirs = complex(system(s)[at, 0])
    derived, _ = transfer_function(diagram, output="x", input="f")
    ours = matrix_response(diagram, ["x"], ["f"], np.array([FREQUENCY])).data.values.item()
    assert complex(derived(s)) == pytest.approx(theirs, rel=1e-5)
    assert ours == pytest.approx(theirs, rel=1e-5)
    alone, _ = transfer_function(diagram.without("K", "T"), output="x", input="f")
    gain = loop_gain(diagram, controller="K")(s)
    assert complex(alone(s)) / (1 + gain) == pytest.approx(theirs, rel=1e-5)


def test_a_spring_on_a_delayed_position_damps_the_motion_that_it_is_wired_along():
    """F = k x(t - T) + d v: by symbols, in the loop's gain, and in the delay that it bears."""
    diagram = behind(FRONTS["delayed"], SPRING)
    assert loop_gain(diagram, controller="K")(1j) == pytest.approx(
        (300.0 * np.exp(-0.015j) + 5.0j) / (0.2 * (1j) ** 2 + 4.0j), rel=1e-12
    )
    assert as_text(transfer(diagram, "x")["f"]) == "(M + V_K + exp(-s T) K)^-1"
    response = delay_margin(loop_gain(diagram, controller="K"))
    assert 0 < response < np.inf


def test_describing_functions_take_both_inputs_of_a_law():
    """A law without friction: the describing functions are the linear forms, 1e-9 of rounding."""
    law = LAWS["a user's own"]
    diagram = behind(FRONTS["low-passed"], law)
    response = quasi_linear_impedance(
        diagram, amplitude=0.01, frequency=[FREQUENCY], motion="x", force="f"
    )
    expression, _ = with_values(diagram, output="f", input="x", given="x")
    expected = numerical(expression)(np.array([2j * np.pi * FREQUENCY]))
    np.testing.assert_allclose(response.data["impedance"].values.ravel(), expected, rtol=1e-4)


#: dw/dt = w + e - v: from e = x and v = dx/dt together it gives -x, and its own mode grows
HIDDEN = ControlLaw(
    law=lambda now, p: now.memory,
    states={
        "memory": ControllerState("position", lambda now, p: now.memory + now.input - now.velocity)
    },
    linear=True,
    parameters={},
    name="hidden",
)


@pytest.mark.parametrize("front", ["", "scaled"])
def test_a_mode_that_input_and_velocity_cancel_still_grows(front):
    """On the motion itself the sum of its two forms is -1; beside a gain both are there."""
    diagram = behind(FRONTS["scaled"], Controller((Stage(HIDDEN, {}),)))
    if not front:
        blocks = [replace(b, input="x") if b.name == "K" else b for b in diagram.blocks]
        diagram = replace(diagram, blocks=tuple(blocks))
    assert max(m.real for m in family_at(diagram, ports(diagram)).undecayed) > 0.5
    claims = diagram_claims(diagram, rng=np.random.default_rng(1))
    assert not [one for one in claims.claims if one.claim.status == "proved"]


def test_a_claim_over_an_interval_of_a_law_with_two_inputs_has_its_closed_form():
    """The damper of the law acts at once and adds to that of the body."""
    diagram = behind(FRONTS["low-passed"], SPRING)
    box = {"K.spring_damper.damping": (0.0, 1.0)}
    claims = [claim_over_intervals(diagram, box, claim=c, points=2) for c in ("passive", "stable")]
    for at in (0.0, 1.0):
        there = diagram.with_values({"K.spring_damper.damping": at})
        (one,) = linear_claims(there, ports(there))
        poles = to_iosystem(there).linearize(0, 0).poles()
        assert (claims[0].status == "proved") <= (one.claim.status == "proved")
        assert (claims[1].status == "proved") <= (max(poles.real) < 0)
    assert {c.status for c in claims} <= {"proved", "refuted"}
