"""How a computer knows velocity: what each way costs in delay and in noise."""

import numpy as np
import pytest
from devices import body

from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.simulate import Sampling, Trajectory, simulate, sine

PERIOD = 1e-3
ENCODER = 7.2e-6  # m, of the rod that ships with the package
BANDWIDTH = 30.0  # Hz
LEVEL, SMOOTHING = 0.5, 0.005
CANCELLATION = {"level": LEVEL, "smoothing_velocity": SMOOTHING}
#: level and smoothing velocity of 1e9: the force is the velocity, to 1e-9
SPEEDOMETER = {"level": 1e9, "smoothing_velocity": 1e9}
WAYS = {
    "difference": {"velocity": "difference"},
    "filtered": {"velocity": "filtered", "velocity_bandwidth": BANDWIDTH},
    "observer of order 2": {
        "velocity": "observer",
        "velocity_bandwidth": BANDWIDTH,
        "observer_order": 2,
    },
    "observer of order 3": {"velocity": "observer", "velocity_bandwidth": BANDWIDTH},
}


def force(values, motion, duration, **sampling):
    diagram = haptic_interface(body(0.1), cancellation=controller("smoothed_coulomb", values))
    simulation = simulate(
        diagram,
        duration=duration,
        motion={"L": motion},
        computer=Sampling(period=PERIOD, **sampling),
        step=PERIOD,
        jit=False,
    )
    return simulation["time"].values, simulation["R_MBC"].values


@pytest.mark.parametrize(
    ("way", "late"),
    [
        ("difference", 0.5e-3),
        ("filtered", 1 / (2 * np.pi * BANDWIDTH)),
        ("observer of order 2", 2 / (2 * np.pi * BANDWIDTH)),
        ("observer of order 3", 0.0),
    ],
)
def test_delay_in_a_motion_of_constant_acceleration(way, late):
    """Continuous-time values; sampling adds no more than half a sample."""
    bend = 0.3
    motion = Trajectory(lambda t: bend * t**2 / 2, lambda t: bend * t, lambda t: 0 * t + bend)
    time, known = force(SPEEDOMETER, motion, 0.4, **WAYS[way])
    delay = time[-1] - known[-1] / bend
    assert abs(delay - late) <= 0.5 * PERIOD * 1.01
    if way == "observer of order 3":
        assert abs(delay) < 1e-9


@pytest.mark.parametrize("order", [2, 3])
def test_the_poles_of_the_observer_are_at_its_bandwidth(order):
    """From a reading one step off at the first sample it returns as a polynomial times p^n."""
    motion = Trajectory(lambda t: 1.0 * (t < 0.5 * PERIOD), np.zeros_like, np.zeros_like)
    way = WAYS[f"observer of order {order}"]
    _, known = force(SPEEDOMETER, motion, 0.1, **way)
    pole = np.exp(-2 * np.pi * BANDWIDTH * PERIOD)
    n = np.arange(1, 101)
    left = known[1:] / pole**n
    shape = np.polyfit(n, left, order - 1)
    assert np.abs(np.polyval(shape, n) - left).max() < 1e-6 * np.abs(left).max()


def measured(way):
    """Noise (N) of the cancellation at a slow constant speed, and its delay (s) at 4 Hz."""
    slow = Trajectory(lambda t: 3.3e-3 * t, lambda t: 0 * t + 3.3e-3, np.zeros_like)
    _, forces = force(CANCELLATION, slow, 2.0, encoder_step=ENCODER, **WAYS[way])
    noise = np.std(forces[500:])
    moved = sine(amplitude=0.002, frequency=4.0)
    time, forces = force(CANCELLATION, moved, 1.0, **WAYS[way])
    v = moved.velocity(time)
    wave = np.exp(-2j * np.pi * 4 * time[500:-1])
    true = LEVEL * v / (SMOOTHING + abs(v))
    ratio = np.sum(forces[500:-1] * wave) / np.sum(true[500:-1] * wave)
    return noise, -np.angle(ratio) / (2 * np.pi * 4)


def test_an_observer_of_order_three_is_quieter_and_earlier_than_a_filtered_difference():
    """Smoothed Coulomb cancellation, 1 kHz, 7.2 um, 30 Hz. Measured (mN, ms): difference 147, 0.5;
    filtered 14, 5.3; observer of order 2: 2.4, 10; of order 3: 6.6, 0.6.
    """
    (n0, d0), (n1, d1), (n2, d2), (n3, d3) = (measured(way) for way in WAYS)
    assert n2 < 0.5 * n3 and n3 < 0.6 * n1 and n1 < 0.2 * n0
    assert d3 < 0.2 * d1 and d1 < 0.6 * d2 and d0 == pytest.approx(0.5e-3, rel=0.05)
