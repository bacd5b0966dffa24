"""The force feedback loop: gain, delay margin."""

import numpy as np
import pytest
from devices import CANCELLATION, FEEDBACK, body

from teleopdesign.diagrams import haptic_interface
from teleopdesign.errors import ModelError
from teleopdesign.frequency import delay_margin, loop_gain
from teleopdesign.simulate import Sampling, simulate


def interface(**arguments):
    return haptic_interface(body(0.15), hand=body(0.5), force_feedback=FEEDBACK, **arguments)


def test_the_loop_of_two_masses_divides_the_gain_by_their_share():
    """k m_H/(m + m_H)/(tau s + 1), for P11 and the schedule at rest."""
    loop = loop_gain(interface())
    share = 0.5 / 0.65
    assert complex(loop(0)) == pytest.approx(5.0 * share)
    assert abs(complex(loop(2j * np.pi * 20.0))) == pytest.approx(5.0 * share / np.sqrt(2))


def test_the_schedule_lowers_the_loop_gain_at_speed():
    ratio = complex(loop_gain(interface(), speed=0.08)(0)) / complex(loop_gain(interface())(0))
    assert ratio == pytest.approx(0.5)


def test_the_delay_margin_has_its_closed_form():
    g, tau = 5.0 * 0.5 / 0.65, 1 / (2 * np.pi * 20.0)
    crossing = np.sqrt(g**2 - 1) / tau
    expected = (np.pi - np.arctan(crossing * tau)) / crossing
    assert delay_margin(loop_gain(interface())) == pytest.approx(expected, rel=1e-6)


def test_a_gain_below_one_bears_any_delay():
    weak = interface().with_values({"H.velocity_schedule.gain": 1.2})
    assert delay_margin(loop_gain(weak)) == float("inf")


@pytest.mark.parametrize(("share", "grows"), [(0.8, False), (1.2, True)])
def test_simulated_feedback_oscillates_just_beyond_its_delay_margin(share, grows):
    """After a push, a fifth below and above the margin of 3.93 ms."""
    delay = share * delay_margin(loop_gain(interface()))
    period = 1e-4  # a hold of half of it is 1 % of the delay
    found = simulate(
        interface(),
        duration=0.4,
        inputs={"R_V": lambda t: 1e-3 * (t < 0.01)},
        computer=Sampling(period=period, delay=round(delay / period) * period),
        jit=False,
    )
    error = np.abs(found["E"].values)
    early, late = error[200:1000].max(), error[-1000:].max()
    assert bool(late > early) is grows


def test_a_loop_that_needs_no_delay_to_oscillate_is_refused():
    """Cancellation at rest is a negative damper, and Coulomb friction has no linear form."""
    with pytest.raises(ModelError, match="unstable without delay"):
        delay_margin(loop_gain(interface(cancellation=CANCELLATION)))


def test_only_a_controller_has_a_loop():
    with pytest.raises(ModelError, match="Z_M is a body"):
        loop_gain(interface(), controller="Z_M")
    with pytest.raises(ModelError, match='no block "G"'):
        loop_gain(interface(), controller="G")
