"""The exact motions hold against what else is known of them: energy, limits, other solvers."""

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from exact.machines import Belt, Bristle, Gap, LateSpring, Relay, Stroke
from scipy.integrate import solve_ivp

TIMES = 1e-3 * np.arange(301)


def test_the_dahl_loop_solves_its_differential_equation():
    m = Stroke()

    def rate(t, y):
        v = m.velocity(t)
        return [m.stiffness * (v - abs(v) * y[0] / m.level)]

    solved = solve_ivp(rate, (0, 0.3), [0.0], "Radau", TIMES, rtol=1e-10, atol=1e-12, max_step=2e-4)
    assert np.abs(m.motion(TIMES)["friction"] - solved.y[0]).max() < 1e-6  # kinks of abs(v)


@pytest.mark.slow
@pytest.mark.parametrize("machine", [Bristle(bristle_damping=20.0, extra=0.3), Belt()])
def test_a_mass_on_a_bristle_moves_as_another_solver_says(machine):
    b = machine if isinstance(machine, Bristle) else machine.body
    spring = getattr(machine, "spring", 0.0)

    def rate(t, y):
        x, v, z = y
        friction, bristle_rate = b.friction(v, z, np.sign(v))
        return [
            v,
            (machine.force(t) - spring * x - friction - b.viscous * v) / b.mass,
            bristle_rate,
        ]

    solved = solve_ivp(
        rate, (0, 0.3), [0.0] * 3, "Radau", TIMES, rtol=1e-9, atol=1e-13, max_step=2e-4
    )
    x = machine.motion(TIMES)["x"]
    assert np.abs(x - solved.y[0]).max() < 1e-6 * np.ptp(x)


def test_a_mass_sticks_and_slips_on_the_belt():
    m = Belt()
    v = m.motion(1e-3 * np.arange(1001))["v"]
    stuck = np.abs(v) < 1e-3
    assert 0.2 < stuck.mean() < 0.9 and np.count_nonzero(np.diff(stuck.astype(int)) == 1) >= 3


@pytest.mark.slow
def test_energy_between_two_masses_without_losses_is_kept():
    """Work of the drive = kinetic energy and that of the contact spring; velocities by spline."""
    from scipy.interpolate import make_interp_spline

    m = replace(Gap(), viscous=0.0)
    t = 1e-4 * np.arange(3001)
    y = m.motion(t)
    v, v_t = (make_interp_spline(t, y[n], 3).derivative()(t) for n in ("x", "tip"))
    kinetic = m.first * v**2 / 2 + m.second * v_t**2 / 2 + y["force"] ** 2 / (2 * m.stiffness)
    work = make_interp_spline(t, m.drive(t) * v, 3).antiderivative()(t)
    assert np.abs(kinetic - work).max() < 1e-6 * work.max()


def test_the_late_spring_is_exact_in_thirty_digits():
    """The method of steps in rational numbers, for the first twenty delays."""
    m = LateSpring()
    mp.mp.dps = 30
    x, v, last = mp.mpf(0), mp.mpf(0), None
    for _ in range(20):
        force = [mp.mpf(0)] if last is None else [-m.stiffness * c for c in last]
        if last is not None:
            force[0] += mp.mpf(m.stiffness) * mp.mpf(m.step)
        d = mp.mpf(m.delay)
        here = [x, v * d]
        here += [f * d**2 / mp.mpf(m.mass) / ((k + 1) * (k + 2)) for k, f in enumerate(force)]
        x, v, last = mp.fsum(here), mp.fsum(k * c for k, c in enumerate(here)) / d, here
    position = m.motion(np.array([0.0, 19.5 * m.delay, 20 * m.delay]))["x"][-1]
    assert abs(position - float(x)) < 1e-14


def test_the_relay_cycles_and_no_reading_is_within_rounding_of_a_flip():
    y = Relay().motion(1000)
    assert y["margin"][1:].min() > 1e-6  # in encoder steps; rounding is 1e-10 of one
    last = np.abs(y["x"][-300:]).max()
    assert last > 10 * Relay().encoder_step and set(np.unique(y["command"])) == {-0.3, 0.0, 0.3}
