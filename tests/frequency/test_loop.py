"""The force feedback loop: gain, delay margin."""

import control
import numpy as np
import pytest
import sympy as sp
from devices import CANCELLATION, FEEDBACK, body

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import CONTROLLERS, Controller, Stage, controller, from_control
from teleopdesign.diagrams import haptic_interface
from teleopdesign.frequency import LoopGain, bode, delay_margin, loop_gain
from teleopdesign.realise.lti import S
from teleopdesign.simulate import Sampling, simulate


def probe_values(law):
    """A value of 2, or the nearest within its bounds, for every parameter."""
    return {n: min(max(2.0, p.lower), p.upper) for n, p in law.parameters.items()}


def interface(**arguments):
    return haptic_interface(body(0.15), hand=body(0.5), force_feedback=FEEDBACK, **arguments)


@pytest.mark.parametrize(("share", "grows"), [(0.8, False), (1.2, True)])
def test_simulated_feedback_oscillates_just_beyond_its_delay_margin(share, grows):
    """After a push, a fifth below and above the margin of 3.93 ms."""
    delay = share * delay_margin(loop_gain(interface()))
    period = 1e-4  # a hold of half of it is 1 % of the delay
    simulation = simulate(
        interface(),
        duration=0.4,
        inputs={"R_V": lambda t: 1e-3 * (t < 0.01)},
        computer=Sampling(period=period, delay=round(delay / period) * period),
        jit=False,
    )
    error = np.abs(simulation["E"].values)
    early, late = error[200:1000].max(), error[-1000:].max()
    assert bool(late > early) is grows


def test_a_loop_that_needs_no_delay_to_oscillate_is_refused():
    """Cancellation at rest is a negative damper, and Coulomb friction has no linear form."""
    with pytest.raises(ModelError, match="unstable without delay"):
        delay_margin(loop_gain(interface(cancellation=CANCELLATION)))


def test_a_controller_in_discrete_time_is_in_the_loop_as_it_samples_and_holds():
    """python-control's value at e^(j w T), times the hold; before, the loop had gain 0."""
    period = 1e-3
    system = control.sample_system(control.tf([40.0, 900.0], [1.0, 300.0]), period)
    diagram = haptic_interface(body(0.15), hand=body(0.5), force_feedback=from_control(system))
    loop = loop_gain(diagram)
    for f in (0.1, 3.0, 80.0, 400.0):
        s = 2j * np.pi * f
        hold = (1 - np.exp(-s * period)) / (s * period)
        expected = complex(system(np.exp(s * period))) * hold * 0.5 / 0.65
        assert loop(s) == pytest.approx(expected, rel=1e-9)
    assert loop.held == ("H",) and "sampled and held: H" in repr(loop)
    response = bode(diagram, output="R_FF", input="R_D", frequency=np.array([3.0, 80.0]))
    assert np.abs(response.values()).min() > 0 and response.left_out == {"haptic interface": ()}


@pytest.mark.parametrize("law", ["dahl", "coulomb"])
def test_a_law_without_linear_form_has_no_loop_gain_of_zero(law):
    values = {"level": 0.4} | ({"stiffness": 1e4} if law == "dahl" else {})
    diagram = interface(cancellation=controller(law, values))
    with pytest.raises(ModelError, match=f"C \\({law}\\) has no linear form"):
        loop_gain(diagram, controller="C")
    loop = loop_gain(diagram)
    assert loop.left_out == ("C",) and "left out: C" in repr(loop)
    with pytest.raises(ModelError, match="C has no linear form and is not in the gain"):
        delay_margin(loop)
    assert delay_margin(loop_gain(diagram.without("C"))) > 0


@pytest.mark.parametrize("name", sorted(CONTROLLERS))
def test_no_law_of_the_catalogue_vanishes_from_a_loop_without_a_word(name):
    """Its own loop is refused or has a gain; in another's it is named or changes the gain."""
    made = Controller((Stage(CONTROLLERS[name], probe_values(CONTROLLERS[name])),))
    diagram = haptic_interface(body(0.15), hand=body(0.5), force_feedback=made)
    try:
        assert loop_gain(diagram)(3j) != 0
    except ModelError as refused:
        assert "H (" in str(refused) and "no linear form" in str(refused)


@pytest.mark.parametrize(
    ("above", "below"),
    [([2, 1], [1, 1]), ([2.0], [1]), ([3, 1], [1, 0]), ([1, 2], [1, 1]), ([1, 3, 1], [1, 1, 1]),
     ([1.8, -0.9], [1, 1])],
)  # fmt: skip
def test_a_loop_that_lets_all_high_frequencies_pass_bears_no_delay(above, below):
    """The least dead time T makes it grow, at ln(abs(L))/T; no frequency has a gain of 1 there."""
    assert delay_margin(control.tf(above, below)) == 0


def late(above, below, time):
    """above/below, late, as the gain of a loop."""
    p, q = (sp.Poly([sp.Rational(repr(c)) for c in side], S).as_expr() for side in (above, below))
    return LoopGain(p / q * sp.exp(-S * sp.Rational(repr(time))), "H", (), (), float("inf"))


def narrow(time):
    """A gain of 10 over a width of 1e-8 of 7 rad/s; elsewhere it is far below 1."""
    width, w = 1e-8, 7.0
    return late([10 * 2 * width * w, 0.0], [1, 2 * width * w, w * w], time)


@pytest.mark.parametrize("time", [0.0, 1e-6, 0.1])
def test_a_resonance_is_detected_though_it_is_narrower_than_a_grid(time):
    """Above it the gain is 1 at a phase of -arccos(1/10)."""
    expected = (np.pi - np.arccos(0.1)) / 7.0
    assert delay_margin(narrow(time)) == pytest.approx(expected - time, rel=1e-4)
