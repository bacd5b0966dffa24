"""Growing modes of two-ports between passive terminations: motions of the closed loop."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import quad

from teleopdesign.passivity import two_port
from teleopdesign.passivity.two_port import growing_mode as modes
from teleopdesign.passivity.two_port.growing_mode import growing_mode
from teleopdesign.passivity.two_port.termination import CLAMPED, Termination
from teleopdesign.realise.lti import S

R = sp.Rational
#: two-ports that some passive terminations unsettle
UNSETTLED = {
    "an active first port": [[S + 1 - 9 * S / (S**2 + S + 4), 0], [0, S + 1]],
    "an active second port": [[S + 1, R(1, 10)], [R(1, 10), 2 - 7 / (S + 1)]],
    "a loop that is too strong": [[S + 1, 4 / (S + 1)], [-4 / (S + 1), S + 1]],
    "a loop by one hair": [[1, 1], [R(101, 100) * S / (S + 1), 1]],
    "a loop by the finest hair": [[1, 1], [R(10**12 + 1, 10**12) * S / (S + 1), 1]],
    "a spring that is none": [[1 + 1 / S, 2 / S], [2 / S, 1 + 1 / S]],
    "residues by one hair": [[1 + 1 / S, R(1001, 1000) / S], [R(1001, 1000) / S, 1 + 1 / S]],
    "residues of a resonance by one hair": [
        [1 + S / (S**2 + 4), R(10**12 + 1, 10**12) * S / (S**2 + 4)],
        [R(10**12 + 1, 10**12) * S / (S**2 + 4), 1 + S / (S**2 + 4)],
    ],
    "masses by one hair": [[1 + S, R(10**12 + 1, 10**12) * S], [R(10**12 + 1, 10**12) * S, 1 + S]],
    "a resonance that is none": [[1 + S / (S**2 + 9), 2 * S / (S**2 + 9)],
                                 [2 * S / (S**2 + 9), 1 + S / (S**2 + 9)]],
    "one direction that grows": [[S + 1, 3 / (S - 2)], [0, S + 1]],
    "the other direction": [[S + 1, 0], [3 / (S**2 - S + 5), S + 1]],
}  # fmt: skip
DECAYING = {
    "dampers": [[1, R(1, 2)], [R(1, 2), 1]],
    "a gyrator": [[1, 5], [-5, 1]],
    "a coupling of masses": [[S + 1 + 9 / S, -9 / S], [-9 / S, 2 * S + 1 + 9 / S]],
    "one direction that decays": [[S + 1, 100 / (S + 2)], [0, S + 1]],
    "a loop at its limit": [[1, 1], [S / (S + 1), 1]],
}


def matrix(entries, s):
    return np.array(
        [[complex(sp.N(sp.sympify(e).subs(S, s))) for e in row] for row in entries], dtype=complex
    )


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("name", UNSETTLED)
def test_a_growing_mode_moves_the_closed_loop_by_itself(name, turned):
    """(Z + terminations) V is zero at its s, and the terminations take the energy that it says."""
    entries = UNSETTLED[name]
    if turned:
        entries = [row[::-1] for row in entries[::-1]]
    mode = growing_mode(two_port(entries).family)
    assert mode is not None and mode.rate > 0 and mode.frequency >= 0
    assert mode.energy > 0 and mode.is_confirmed()
    s, v = mode.s, np.array(mode.velocity)
    assert max(abs(v)) == pytest.approx(1.0)
    if "direction" not in name:
        force = matrix(entries, sp.Float(s.real, 30) + sp.I * sp.Float(s.imag, 30)) @ v
        size = np.abs(matrix(entries, s)).max()
        for held, f, moved in zip(mode.terminations, force, v, strict=True):
            if held.clamped:
                assert moved == 0
            else:
                assert abs(f + held.at(s) * moved) < 1e-5 * (size + abs(held.at(s)))
    for held in mode.terminations:
        assert held.clamped or min(held.damping, held.inertia, held.stiffness) >= 0
    if mode.rate > mode.frequency / 1000:
        assert mode.replay() == pytest.approx(mode.energy, rel=1e-3)


@pytest.mark.parametrize("name", DECAYING)
def test_a_two_port_that_is_stable_between_all_terminations_has_no_growing_mode(name):
    assert growing_mode(two_port(DECAYING[name]).family) is None


@pytest.mark.parametrize("frequency", [Fraction(0), Fraction(3)])
def test_the_energy_of_a_mode_is_that_of_force_and_velocity_over_time(frequency):
    """At each port force times velocity of the wave, from rest to now, by quadrature."""
    held = Termination(Fraction(2), Fraction(1, 2), Fraction(5)), Termination(Fraction(1, 3))
    z = two_port([[1, 0], [0, 1]]).z
    v = (0.6 + 0.3j, -1.0 + 0.1j) if frequency else (0.6, -1.0)
    mode = modes.GrowingMode(z, held, Fraction(1, 2), frequency, tuple(map(complex, v)))

    def power(t):
        wave = np.exp(mode.s * t)
        moved = [(h.at(mode.s) * x * wave, x * wave) for h, x in zip(held, v, strict=True)]
        return sum(f.real * u.real for f, u in moved)

    expected, _ = quad(power, -60.0, 0.0, limit=400)
    assert mode.energy == pytest.approx(expected, rel=1e-9)
    assert mode.replay() == pytest.approx(expected, rel=1e-4)
    alone = replace(mode, terminations=(held[0], CLAMPED), velocity=(v[0], 0j))
    part, _ = quad(lambda t: (held[0].at(mode.s) * v[0] * np.exp(mode.s * t)).real
                   * (v[0] * np.exp(mode.s * t)).real, -60.0, 0.0, limit=400)  # fmt: skip
    assert alone.energy == pytest.approx(part, rel=1e-9)
    assert alone.replay() == pytest.approx(part, rel=1e-4)


def test_a_slow_growth_is_replayed_over_its_last_periods_alone():
    z = two_port([[1, 0], [0, 1]]).z
    free = Termination(Fraction(1))
    mode = modes.GrowingMode(z, (free, free), Fraction(1, 10**5), Fraction(2), (1 + 0j, 0j))
    span = modes.LONGEST * np.pi  # of periods of pi seconds
    # the mean power is exp(2 rate t)/2
    assert mode.replay() == pytest.approx(span / 2 * (1 - 1e-5 * span), rel=0.01)
    assert mode.replay() < 0.9 * mode.energy


@pytest.mark.parametrize(("damping", "confirmed"), [(Fraction(1), True), (Fraction(4), False)])
def test_a_mode_is_confirmed_where_the_closed_loop_grows_and_only_there(damping, confirmed):
    """A mass with a damper of -3: held by less it grows, by more it does not."""
    z = two_port([[S - 3, 0], [0, S + 1]]).z
    held = Termination(damping)
    for pair in ((held, CLAMPED), (held, Termination(Fraction(1)))):
        mode = modes.GrowingMode(z, pair, Fraction(1), Fraction(0), (1 + 0j, 0j))
        assert mode.is_confirmed() is confirmed
    mode = modes.GrowingMode(z, (CLAMPED, held), Fraction(1), Fraction(0), (0j, 1 + 0j))
    assert not mode.is_confirmed()
    mode = modes.GrowingMode(z, (CLAMPED, CLAMPED), Fraction(1), Fraction(0), (0j, 0j))
    assert not mode.is_confirmed()
    assert mode.as_dict()["terminations"] == ["clamped", "clamped"]
