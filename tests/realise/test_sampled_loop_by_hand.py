"""A sampled loop around a free mass, held against its closed form between all events.

Between two changes of the command the mass moves along a parabola. So the truth is exact, with the
encoder, a computing delay, and a dead time of the computer that is no whole number of samples.
"""

import numpy as np
import pytest
from devices import body

from teleopdesign.controllers import controller
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.simulate import Sampling, simulate

MASS, PERIOD, STEP, SAMPLES = 0.1, 1e-3, 1e-5, 40
GAIN, PUSH, RATE = 300.0, 2.0, 80.0
FIRST, SPEED = 2.34e-4, 0.03


def diagram(dead_time):
    """A mass that the computer pulls towards zero by a late reading and its integral."""
    return Diagram(
        "loop",
        (
            Moving("M", body(MASS), "x", "u", {"f": 1}, "f"),
            Control("T", controller("delay", {"time": dead_time}), "x", "late"),
            Control("P", controller("proportional_integral", {"gain": GAIN, "rate": RATE}),
                    "error", "u"),
        ),
        (Junction("error", {"late": -1}),),
        {"f": "force"},
        measured=("x",),
    )  # fmt: skip


def by_hand(dead_time, lag):
    """Position at the samples, the command that is computed there, and the reading."""
    x, v, acting, integral, readings, rows = FIRST, SPEED, 0.0, 0.0, [], []
    waiting = []  # (time at which it acts, command)
    whole, part = divmod(round(dead_time / PERIOD, 9), 1.0)
    for n in range(SAMPLES + 1):
        # half a step belongs to the step above
        readings.append(np.floor(x / STEP + 0.5) * STEP)
        places = (n - int(whole), n - int(whole) - 1)
        two = [readings[k] if k >= 0 else 0.0 for k in places]
        error = -((1.0 - part) * two[0] + part * two[1])
        command = GAIN * (error + RATE * integral)
        integral += PERIOD * error
        waiting.append((n * PERIOD + lag, command))
        rows.append((x, v, command, error))
        now, end = n * PERIOD, (n + 1) * PERIOD
        while now < end - 1e-12:
            while waiting and waiting[0][0] <= now + 1e-12:
                acting = waiting.pop(0)[1]
            until = min([end, *(t for t, _ in waiting)])
            a, h = (acting + PUSH) / MASS, until - now
            x, v, now = x + v * h + a * h**2 / 2, v + a * h, until
    return np.array(rows).T


@pytest.mark.parametrize(
    ("dead_time", "lag"),
    [(0.0, 0.0), (1e-3, 0.0), (1.3e-3, 3e-4), (2.4e-3, 1.7e-3), (0.0, 1e-3), (3e-3, 2.2e-3)],
)
def test_each_command_is_made_of_the_readings_it_should_be_and_acts_when_it_should(dead_time, lag):
    simulation = simulate(
        diagram(dead_time),
        duration=SAMPLES * PERIOD,
        inputs={"f": PUSH},
        initial={"x": FIRST, "x_velocity": SPEED},
        computer=Sampling(period=PERIOD, delay=lag, encoder_step=STEP),
        step=1e-4,
        jit=False,
    )
    x, v, command, error = by_hand(dead_time, lag)
    for name, known in (("x", x), ("x_velocity", v), ("u", command), ("error", error)):
        size = np.abs(known).max()
        np.testing.assert_allclose(simulation[name].values, known, rtol=0, atol=1e-9 * size)
