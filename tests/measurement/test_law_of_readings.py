"""A controller's law is known by the steps of the readings in the command, and nothing else is."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.signal import lfilter

from teleopdesign.measurement.law_of_readings import law_of_readings

ROWS = 2000
#: mass, damping, stiffness of devices (SI), steps of their readings, rows in a second
DEVICES = {
    "paddle": ((8e-4, 1e-3, 0.0), 7.7e-4, 1000.0),
    "slow log": ((8e-4, 1e-3, 0.0), 1.5e-3, 200.0),
    "stage": ((0.6, 2.0, 0.0), 2e-6, 500.0),
    "on a spring": ((0.05, 0.4, 90.0), 1e-5, 1000.0),
}
DEVICE = pytest.mark.parametrize("device", [pytest.param(d, id=n) for n, d in DEVICES.items()])


def waves(t, seed=0):
    """A smooth motion of five frequencies up to 4 Hz, of size 1."""
    random = np.random.default_rng(seed)
    phases = random.uniform(0.0, 6.0, 5)
    sizes = (0.35, 0.25, 0.2, 0.12, 0.08)
    rates = (0.31, 0.73, 1.3, 2.4, 4.0)
    return sum(a * np.sin(6.28 * f * t + p) for a, f, p in zip(sizes, rates, phases, strict=True))


def moved(device, law, *, hand=1.0, target=None):
    """Time, true position and command of a device under a law of its reading, moved by a hand."""
    (mass, damping, stiffness), step, rate = device
    t = np.arange(ROWS) / rate
    held = hand * 900.0 * mass  # stiffness and damping of the hand, whose goal moves
    stiffness, damping = stiffness + held, damping + hand * 40.0 * mass
    force = held * 1000.0 * step * waves(t)
    a = np.array([[0.0, 1.0, 0.0], [-stiffness / mass, -damping / mass, 1.0 / mass], [0.0] * 3])
    (xx, xv, xf), (vx, vv, vf) = expm(a / rate)[:2].tolist()
    place, speed, compute = 0.0, 0.0, law(device)
    x, u = np.zeros(ROWS), np.zeros(ROWS)
    for k, push in enumerate(force.tolist()):
        x[k] = place
        u[k] = compute(step * round(place / step) - (0.0 if target is None else target[k]))
        both = float(u[k]) + push
        place, speed = (
            xx * place + xv * speed + xf * both,
            vx * place + vv * speed + vf * both,
        )
    return t, x, u


def spring_and_damper(*, cut=None, low=-np.inf, high=np.inf):
    """A law with backward difference; cut: Hz of its filter;  low, high: the force is within."""

    def law(device):
        (mass, damping, _), _, rate = device
        stiffness, damper = 150.0 * mass, 8.0 * mass + damping
        keep = 0.0 if cut is None else np.exp(-6.28 * cut / rate)
        past = [0.0, 0.0]

        def compute(reading):
            past[1] = keep * past[1] + (1.0 - keep) * (reading - past[0]) * rate
            past[0] = reading
            force = -stiffness * reading - damper * past[1]
            size = 1000.0 * device[1] * stiffness
            return float(min(max(force, low * size), high * size))

        return compute

    return law


def known(device, x, u, **more):
    """The law of a command, from readings of the device's own step."""
    readings = device[1] * np.round(x / device[1])
    return law_of_readings(u, readings, [slice(0, len(u))], sample_time=1 / device[2], **more)


def rounded(u, steps=5e4):
    return np.round(u * steps / np.ptp(u)) * np.ptp(u) / steps


@DEVICE
@pytest.mark.parametrize(
    ("law", "partial"),
    [
        pytest.param(spring_and_damper(), False, id="backward difference"),
        pytest.param(spring_and_damper(cut=20.0), False, id="filtered derivative"),
        pytest.param(spring_and_damper(cut=20.0, low=-0.2, high=0.2), None, id="limits"),
        pytest.param(spring_and_damper(high=0.0), None, id="wall on one side"),
        pytest.param(spring_and_damper(cut=40.0, high=0.0), None, id="wall, filtered"),
    ],
)
def test_a_spring_and_a_damper_of_the_controller(device, law, partial):
    _, x, u = moved(device, law)
    (mass, damping, _), _, _ = device
    for command in (u, rounded(u)):
        law_known = known(device, x, command)
        assert law_known is not None and law_known.is_damped
        assert law_known.stiffness == pytest.approx(150.0 * mass, rel=2e-3)
        assert law_known.damping == pytest.approx(8.0 * mass + damping, rel=2e-3)
        assert partial is None or law_known.is_partial == partial


def follow(force):
    """A law that reads nothing: the command is a list of numbers."""
    numbers = iter(force)
    return lambda device: lambda reading: next(numbers)


def all_devices(test):
    """A test for each device, in plain runs for one whose true motion is that of a spring."""
    rare = ["paddle", "stage"]
    params = [pytest.param(DEVICES["on a spring"], id="on a spring")]
    params += [pytest.param(DEVICES[n], id=n, marks=pytest.mark.slow) for n in rare]
    return pytest.mark.parametrize("device", params)(test)


OPEN = {
    "waves": lambda t, random: waves(t, 1),
    "one sine": lambda t, random: np.sin(10.7 * t),
    "fast sine": lambda t, random: np.sin(0.7 * np.arange(len(t))),
    "random levels": lambda t, random: random.choice([-1.0, 0.3, 1.0], ROWS // 10).repeat(10),
    "staircase": lambda t, random: np.round(3.0 * waves(t, 1)),
    "noise": lambda t, random: random.standard_normal(len(t)),
    "release": lambda t, random: np.exp(-3.0 * t),
    "filtered noise": lambda t, random: lfilter([0.1], [1, -0.9], random.standard_normal(len(t))),
}


@all_devices
@pytest.mark.parametrize("force", [pytest.param(f, id=n) for n, f in OPEN.items()])
@pytest.mark.parametrize("hand", [0.0, 1.0])
def test_an_open_loop_command_is_no_law_of_the_readings(device, force, hand):
    """Nor is it one in a log without noise, whose true motion is exactly linear in past rows."""
    (mass, damping, stiffness), step, rate = device
    t = np.arange(ROWS) / rate
    force = 1000.0 * step * (900.0 * mass + stiffness) * force(t, np.random.default_rng(4))
    _, x, u = moved(device, follow(force), hand=hand)
    for command in (u, np.append(0.0, rounded(u)[:-1])):
        assert known(device, x, command) is None
        assert law_of_readings(command, x, [slice(0, ROWS)], sample_time=1.0 / rate) is None
        fine = device[0], 1e-3 * step, rate
        assert known(fine, x, command) is None


TARGETS = {
    "sine": lambda t: np.sin(6.9 * t),
    "slow sine": lambda t: np.sin(1.2 * t),
    "waves": lambda t: waves(t, 2),
    "ramp": lambda t: t / t[-1],
    "triangle": lambda t: np.abs(t % 1.0 - 0.5),
}


@all_devices
@pytest.mark.parametrize("target", [pytest.param(g, id=n) for n, g in TARGETS.items()])
@pytest.mark.parametrize(("cut", "hand"), [(None, 0.5), (20.0, 0.0)])
def test_a_controller_with_a_moving_set_point_computes_no_law_of_the_readings(
    device, target, cut, hand
):
    """A sine is linear in its two last values, as a filter that does not forget."""
    _, step, rate = device
    goal = 200.0 * step * target(np.arange(ROWS) / rate)
    _, x, u = moved(device, spring_and_damper(cut=cut), target=goal, hand=hand)
    for command in (u, rounded(u)):
        assert known(device, x, command) is None
        assert law_of_readings(command, x, [slice(0, ROWS)], sample_time=1.0 / rate) is None


@DEVICE
def test_a_measured_force_is_no_law_of_the_readings(device):
    _, x, u = moved(device, spring_and_damper())
    noise = np.random.default_rng(5).standard_normal(ROWS)
    assert known(device, x, u + 2e-3 * np.ptp(u) * noise) is None
    (mass, _, stiffness), _, rate = device
    spring = (150.0 * mass + stiffness) * x  # the true spring, read by a sensor
    assert known(device, x, rounded(spring, 2000)) is None
    assert known(device, x, rounded(spring + 1e-3 * np.ptp(spring) * noise)) is None
