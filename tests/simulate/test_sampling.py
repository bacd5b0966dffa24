"""How a computer samples: what is refused, and how long a command is held."""

import numpy as np
import pytest
from devices import body

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.simulate import Sampling, simulate, sine

PERIOD = 1e-3


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"period": 0.0}, "period > 0 s"),
        ({"period": float("inf")}, "period > 0 s"),
        ({"delay": -1e-3}, "delay and encoder_step >= 0"),
        ({"encoder_step": -1e-6}, "delay and encoder_step >= 0"),
        ({"velocity": "difference", "velocity_bandwidth": 50.0}, "has no bandwidth"),
        ({"velocity": "observer"}, "needs a velocity_bandwidth"),
    ],
)
def test_a_computer_that_cannot_be_is_refused(options, message):
    with pytest.raises(ModelError, match=message):
        Sampling(**options)


def test_an_observer_has_its_order_and_other_estimates_have_none():
    assert Sampling(velocity="observer", velocity_bandwidth=50.0, observer_order=2).observer == 2
    assert Sampling(velocity_bandwidth=50.0).observer == 0


def test_a_command_is_held_for_a_period():
    """A spring as the position loop of a device that is led: each command is the spring's force at
    the last sample.
    """
    law = controller("gain", {"gain": 1000.0})
    diagram = haptic_interface(body(), position_loop=law)
    motion = sine(amplitude=0.01, frequency=2.0)
    simulation = simulate(
        diagram,
        duration=0.1,
        motion={"L": motion},
        computer=Sampling(period=PERIOD),
        every_step=True,
        jit=False,
    )
    time = simulation["time"].values
    middles = (time / PERIOD) % 1.0
    rows = (middles > 0.2) & (middles < 0.8) & (time > 3 * PERIOD)  # away from the changes
    sample = np.floor(time[rows] / PERIOD) * PERIOD
    expected = -1000.0 * motion.position(sample)
    assert rows.sum() > 100
    # the held command is exact; what remains is the rounding of times
    assert simulation["R_D"].values[rows] == pytest.approx(expected, abs=1e-9)
