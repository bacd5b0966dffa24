"""Loops of a controller that samples and holds: exact margins, and what else is said."""

from dataclasses import replace
from fractions import Fraction

import control as ct
import numpy as np
import pytest
from devices import body, two_rods

from teleopdesign.base.errors import UnstableLoop
from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import EFFECTS
from teleopdesign.frequency import delay_margin, gain_margin, loop_gain, phase_margin
from teleopdesign.frequency.sampled_loop import SampledLoop
from teleopdesign.simulate import Sampling, simulate

PERIOD = 1e-3
#: of the masses of hand and device: what the force fed back lets pass at once
SHARE = 0.5 / 0.65


def interface(law, device=None):
    device = body(0.15) if device is None else device
    return haptic_interface(device, hand=body(0.5), force_feedback=from_control(law))


def gain(k):
    return ct.tf([k], [1], PERIOD)


def poles_of_loop(late, law):
    """z^late d + share n = 0: what passes straight through is a sample late."""
    below = np.polymul(law.den[0][0], [1.0] + [0.0] * late)
    return np.abs(np.roots(np.polyadd(below, SHARE * np.atleast_1d(law.num[0][0])))).max()


def test_a_sampled_gain_of_a_force_bears_the_gain_of_one_sample():
    """u = -k share u of the sample before; by its response over frequency it seemed to bear 57 %
    more, as a hold lets only 2/pi of it pass at half the sampling rate.
    """
    loop = loop_gain(interface(gain(1.0)))
    assert gain_margin(loop) == pytest.approx(1 / SHARE, rel=1e-12)
    assert gain_margin(replace(loop, sampled=None)) > 1.5 / SHARE
    with pytest.raises(UnstableLoop):
        gain_margin(loop_gain(interface(gain(1.01 / SHARE))))


@pytest.mark.parametrize(("share", "grows"), [(0.93, False), (1.07, True)])
def test_simulated_force_feedback_grows_just_beyond_its_gain_margin(share, grows):
    diagram = interface(gain(share * gain_margin(loop_gain(interface(gain(1.0))))))
    pushed = {"R_V": lambda t: 1e-3 * (t < 0.01)}
    simulation = simulate(diagram, duration=0.1, inputs=pushed, computer=Sampling(period=PERIOD),
                     jit=False)  # fmt: skip
    error = np.abs(simulation["E"].values)
    early, late = error[: len(error) // 3].max(), error[-len(error) // 5 :].max()
    assert bool(late > early) is grows


def test_a_delay_margin_of_what_passes_straight_through_is_whole_samples():
    law = ct.sample_system(ct.tf([5.0], [1 / (2 * np.pi * 20.0), 1.0]), PERIOD)
    samples = delay_margin(loop_gain(interface(law))) / PERIOD
    assert samples == pytest.approx(round(samples), rel=1e-8) and samples > 2
    # with m samples of dead time, what is read is m + 1 samples old
    assert poles_of_loop(round(samples), law) < 1 < poles_of_loop(round(samples) + 1, law)


def test_a_dead_time_of_part_of_a_sample_counts_as_it_is():
    """k (1 - d + d/z) h/(z - 1): an integrator that is late by the part d of a sample."""
    k, h = Fraction(800), Fraction(1, 1000)
    for part in (Fraction(0), Fraction(1, 4), Fraction(9, 10)):
        loop = SampledLoop(h, ((Fraction(1),), (Fraction(1),)), (Fraction(1), Fraction(0)),
                           ((h * part, (k,)),))  # fmt: skip
        angle, g, d = np.array([1e-6, 0.01, 1.0, 3.0]), float(k * h), float(part)
        z = np.exp(1j * angle)
        expected = g * (1 - d + d / z) / np.expm1(1j * angle)
        assert np.allclose(loop(angle), expected, rtol=1e-12)
        # roots of z^2 - z + g ((1 - d) z + d)
        for factor in np.linspace(0.3, 3, 19):
            grown = factor * g
            largest = np.abs(np.roots([1, -1 + grown * (1 - d), grown * d])).max()
            stronger = replace(loop, law=((Fraction(factor),), (Fraction(1),)))
            assert stronger.grows() == (largest >= 1)


def test_slow_poles_sampled_fast_are_distinguished_from_each_other():
    """Poles at -1e-3 and -2e-3 1/s, a sample of 1e-5 s: 1e-8 from z = 1. As without samples."""
    below = np.polymul([1, 1e-3], [1, 2e-3])
    exact = tuple(Fraction(repr(float(c))) for c in below)
    for k, grows in ((1e-6, False), (-1.9e-6, False), (-2.1e-6, True)):
        loop = SampledLoop(Fraction(1, 10**5), ((Fraction(1),), (Fraction(1),)), exact,
                           ((Fraction(0), (Fraction(repr(k)),)),))  # fmt: skip
        assert loop.grows() == grows
        w = np.array([1e-4, 1e-3, 1e-2])
        plain = k / np.polyval(below, 1j * w) * np.exp(-0.5e-5j * w)
        assert np.allclose(loop(w * 1e-5), plain, rtol=1e-7)


@pytest.mark.slow
def test_a_fast_sampled_loop_has_the_margins_of_one_in_continuous_time():
    law, late = ct.tf([5.0], [1 / (2 * np.pi * 20.0), 1.0]), 2e-3
    device = body(0.15, viscous__damping=2.0)
    device = device.with_effect(EFFECTS["actuation_delay"], {"delay": late})
    period = 1e-5
    held = ct.sample_system(law, period)
    plain, sampled = (loop_gain(interface(one, device)) for one in (law, held))
    assert sampled.sampled is not None and plain.sampled is None
    # 2e-3: lags of some samples of 1e-5 s beside milliseconds
    assert gain_margin(sampled) == pytest.approx(gain_margin(plain), rel=2e-2)
    assert phase_margin(sampled) == pytest.approx(phase_margin(plain), abs=0.5)
    assert delay_margin(sampled) == pytest.approx(delay_margin(plain), abs=3e-5)


def test_where_others_sample_too_margins_are_called_approximate():
    diagram = haptic_interface(
        body(0.15), hand=body(0.5), force_feedback=from_control(gain(0.3)),
        cancellation=from_control(ct.tf([-2.0], [1], PERIOD)),
    )  # fmt: skip
    loop = loop_gain(diagram)
    assert loop.sampled is None and "margins by an approximation" in repr(loop)
    alone = loop_gain(interface(gain(0.3)))
    assert alone.sampled is not None and "approximation" not in repr(alone)
    mixed = haptic_interface(
        body(0.15), hand=body(0.5),
        force_feedback=from_control(gain(0.3)).then(controller("low_pass", {"bandwidth": 50.0})),
    )  # fmt: skip
    assert loop_gain(mixed).sampled is None


@pytest.mark.parametrize("hidden", [(), (0.7,), (1.5,)])
def test_a_law_of_two_axes_hides_what_neither_of_its_outputs_shows(hidden):
    """States of two entries each, integrators among them, count once; margins with 0.7 hidden."""
    n, gains = len(hidden), -np.array([[50.0, -20.0], [-20.0, 50.0]])
    a = np.diag([1.0, 0.5, *hidden])
    b = np.vstack([np.eye(2), np.ones((n, 2))])
    c = np.hstack([0.001 * gains, np.zeros((2, n))])
    system = ct.ss(a, b, c, gains, 0.01)
    loop = loop_gain(two_rods(system, analog=False), controller="C_1_1")
    if 1.5 in hidden:
        with pytest.raises(UnstableLoop, match="does not see grows"):
            delay_margin(loop)
    else:
        assert delay_margin(loop) == pytest.approx(0.09, rel=0.1)
