"""Where a two-port gives energy out: exact places on the axis and on the real line."""

import numpy as np
import pytest
import sympy as sp

from teleopdesign.passivity import two_port
from teleopdesign.passivity.two_port.claims import _find_active_points
from teleopdesign.passivity.two_port.resonances import resonances
from teleopdesign.passivity.two_port.waves import find_wave_at
from teleopdesign.realise.lti import S

R = sp.Rational
NARROW = 1 - R(1001, 1000) * S / 10**4 / (S**2 + S / 10**4 + 25)
#: two-port, and whether it shows on the axis and at real rates
ACTIVE = {
    "a dip between two grid points": ([[NARROW, 0], [0, 1]], True, False),
    "the other port": ([[1, 0], [0, NARROW]], True, False),
    "a loop with a lag": ([[1, 3 / (S + 1)], [0, 1]], True, True),
    "a loop one way": ([[S + 1, 0], [-5 * S / (S + 1), S + 1]], True, False),
    "a negative damper": ([[S - 1, R(1, 3)], [R(1, 3), S + 1]], True, True),
    "a resonance out of phase": ([[1 - S / (S**2 + S / 2 + 4), 0], [0, 2]], True, False),
    "springs that are none": ([[1 + 1 / S, 3 / S], [3 / S, 1 + 1 / S]], False, True),
}
PASSIVE = {
    "dampers": [[2, 1], [1, 2]],
    "masses on a spring": [[S + 1 + 9 / S, -9 / S], [-9 / S, S + 1 + 9 / S]],
    "a gyrator": [[1, 7], [-7, 1]],
}


def least(z, s):
    """Least eigenvalue of Z(s) + Z(s)^H."""
    at = np.array([[complex(sp.N(sp.sympify(e).subs(S, s), 30)) for e in row] for row in z])
    return np.linalg.eigvalsh(at + at.conj().T).min()


@pytest.mark.parametrize("name", ACTIVE)
def test_energy_comes_out_at_every_place_of_the_search(name):
    z, on_axis, at_rates = ACTIVE[name]
    axis, rates = _find_active_points(two_port(z))
    assert bool(axis) is on_axis and bool(rates) is at_rates
    for f in axis:
        assert least(z, 2 * sp.pi * sp.I * sp.Float(f, 30)) < 0
    for rate in rates:
        assert rate > 0 and least(z, sp.Float(rate, 30)) < 0


@pytest.mark.parametrize("name", PASSIVE)
def test_a_passive_two_port_has_no_such_place(name):
    assert _find_active_points(two_port(PASSIVE[name])) == ([], [])


@pytest.mark.parametrize("damping", [R(1, 10), R(1, 10**4)])
def test_frequencies_crowd_about_each_resonance_in_hertz(damping):
    """Of a late pole at 5 rad/s: within a tenth of its width from it, and to either side of it."""
    late = sp.exp(-S / 100) * S * damping / (S**2 + S * damping + 25)
    z = two_port([[1 - late, 0], [0, 1]])
    near = 2 * np.pi * resonances(z) - 5.0
    width = float(damping) / 2
    assert np.abs(near).min() < 0.1 * width
    assert (np.abs(near) < 3 * width).sum() >= 5 and near.min() < -width and near.max() > width


@pytest.mark.parametrize("size", [1, R(1, 10**9)])
def test_the_search_notices_a_wave_however_little_energy_it_takes_out(size):
    """The same two-port in another unit of force."""
    z = [[size * e for e in row] for row in ACTIVE["a negative damper"][0]]
    wave = find_wave_at(two_port(z).z, 0.05)
    assert wave is not None and 0 < wave.energy < 10 * float(size)
