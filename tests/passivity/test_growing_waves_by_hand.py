"""Growing waves that take energy out: their energy over time, their phase, and where they are."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from teleopdesign.passivity.linear.impedance import impedance
from teleopdesign.passivity.search import growing_wave as waves
from teleopdesign.passivity.search.growing_wave import growing_wave, wave_of
from teleopdesign.realise.lti import S

R = sp.Rational
RELEASING = {
    "a driving damper": S - 1,
    "a late resonance": 1 + S - 3 * S / (S**2 + S / 10 + 4),
    "a narrow dip": 1 - R(1001, 1000) * S / 10**4 / (S**2 + S / 10**4 + 25),
    "a dip at high frequency": 1 + 1 / S - R(11, 10) * S * 10**3 / (S**2 + S * 10**3 + 10**12),
    "a pole that grows": 1 / (S - 2),
    "a negative spring": S + 1 - 3 / S,
    "two poles at zero": 1 + 1 / S**2,
    "a zero that grows": (S - 1) * (S - 1) / (S + 1) ** 2 + R(1, 2),
}
PASSIVE = {"a mass": S, "a spring and a damper": 1 + 5 / S, "a lag": (S + 3) / (S + 1),
           "a dip to zero": 1 - S / (S**2 + S + 4)}  # fmt: skip


def energy_out(wave, z, v):
    """Minus the integral of force times velocity of the wave with these velocities, up to now."""
    s = wave.s
    span = -40.0 / s.real
    matrix = np.array([[complex(sp.N(e.subs(S, s))) for e in row] for row in z.tolist()])

    def power(t):
        x = np.array(v) * np.exp(s * t)
        return float(-((matrix @ x).real * x.real).sum())

    return quad(power, span, 0.0, limit=2000)[0]


@pytest.mark.parametrize("name", RELEASING)
def test_a_wave_takes_out_of_an_impedance_what_it_says(name):
    z = impedance(RELEASING[name])
    wave = growing_wave(z)
    assert wave is not None and wave.rate > 0 and wave.frequency >= 0 and wave.energy > 0
    value = z.at(wave.rate, wave.frequency)
    assert value[0] < 0
    assert wave.value[0, 0] == pytest.approx(complex(*map(float, value)), rel=1e-9)
    assert abs(wave.velocity[0]) == pytest.approx(1.0)
    if wave.rate * 1000 > wave.frequency:
        assert energy_out(wave, wave.impedance, wave.velocity) == pytest.approx(
            wave.energy, rel=1e-3
        )
        assert wave.replay() == pytest.approx(wave.energy, rel=1e-3)
    t, v, f = wave.samples(501)
    np.testing.assert_allclose(v[-1], np.real(wave.velocity), rtol=1e-9)
    np.testing.assert_allclose(f[-1], (wave.value @ wave.velocity).real, rtol=1e-9)
    assert t[-1] == 0 and np.ptp(np.diff(t)) < 1e-9 * abs(t[0])


@pytest.mark.parametrize("name", PASSIVE)
def test_no_wave_takes_energy_out_of_a_passive_impedance(name):
    assert growing_wave(impedance(PASSIVE[name])) is None


NUMBER = st.integers(-5, 5)


@settings(max_examples=25)
@given(st.lists(NUMBER, min_size=4, max_size=4), NUMBER, st.sampled_from([0, 1, 3]))
def test_a_wave_of_several_ports_has_the_velocities_and_the_phase_that_release_most(
    entries, spring, frequency
):
    a, b, c, d = entries
    z = sp.ImmutableMatrix([[a + S, b + R(spring) / S], [c, d + S]])
    rate = Fraction(1, 2)
    wave = wave_of(z, rate, Fraction(frequency))
    s = complex(0.5, frequency)
    matrix = np.array([[a + s, b + spring / s], [c, d + s]])
    real = (matrix + matrix.conj().T) / 2
    least, vectors = np.linalg.eigh(real)
    if wave is None:
        assert least[0] >= -1e-12
        return
    assert least[0] < 0
    v = np.array(wave.velocity)
    assert (v.conj() @ real @ v).real == pytest.approx(least[0], rel=1e-9, abs=1e-12)
    assert np.linalg.norm(v) == pytest.approx(1.0)
    if frequency:
        assert wave.energy == pytest.approx(energy_out(wave, z, wave.velocity), rel=1e-6, abs=1e-9)
        for turn in np.exp(1j * np.linspace(0, np.pi, 13)):
            turned = replace(wave, velocity=tuple(turn * v))
            assert turned.energy <= wave.energy + 1e-9


def test_a_slow_wave_is_sampled_over_its_last_periods_alone():
    z = sp.ImmutableMatrix([[R(-1)]])
    wave = waves.GrowingWave(z, Fraction(1, 10**6), Fraction(2), (1 + 0j,))
    t, _, _ = wave.samples(11)
    assert t[0] == pytest.approx(-waves.LONGEST * np.pi)
    assert wave.replay() == pytest.approx(waves.LONGEST * np.pi / 2, rel=0.01)
    fast = replace(wave, rate=Fraction(3))
    assert fast.samples(11)[0][0] == pytest.approx(-4.0)
    still = replace(wave, rate=Fraction(3), frequency=Fraction(0))
    assert still.samples(11)[0][0] == pytest.approx(-4.0)
    assert still.replay() == pytest.approx(1 / 6, rel=1e-4) == still.energy


def test_a_value_that_digits_decide_is_exact_or_is_no_number():
    """(1 + s)^40 - 1 - 40 s near zero: all sixteen digits of plain arithmetic are lost."""
    small = Fraction(1, 10**9)
    z = sp.ImmutableMatrix([[(1 + S) ** 40 - 1 - 40 * S]])
    value = waves.value_at(z, small, Fraction(0))[0, 0]
    assert value == pytest.approx(780e-18, rel=1e-6)
    pole = waves.value_at(sp.ImmutableMatrix([[1 / (S - 1)]]), Fraction(1), Fraction(0))
    assert np.isnan(pole).all()


@pytest.mark.parametrize("x", [Fraction(2), Fraction(1, 3), Fraction(10**40, 7), Fraction(9)])
@pytest.mark.parametrize("digits", [5, 20])
def test_a_root_has_the_digits_that_are_asked_for(x, digits):
    root = waves.square_root(x, digits)
    assert abs(root**2 / x - 1) <= Fraction(2, 10**digits) * (1 + abs(1 / x))
    assert list(waves.halvings(x, 3)) == [x / 2, x / 4, x / 8]


def test_a_sum_that_is_rounding_shows_nothing():
    assert waves.drop_rounding(np.array([1.0, -1.0 + 2.0**-50])) == 0.0
    assert waves.drop_rounding(np.array([1.0, -1.0 + 2.0**-40])) == 2.0**-40
    assert waves.drop_rounding(np.array([-3.0])) == -3.0


@pytest.mark.parametrize("sizes", [(1, 1), (100, 10000), (0.001, 0.01, 10)])
def test_roots_are_counted_in_a_power_of_ten_near_their_mean(sizes):
    p = sp.Poly(sp.Mul(*(S + R(str(x)) for x in sizes)), S)
    middle = float(waves._middle(p))
    assert 10**-0.51 <= middle / np.prod(sizes) ** (1 / len(sizes)) <= 10**0.51
    assert waves._middle(sp.Poly(3 * S**2, S)) == 1
