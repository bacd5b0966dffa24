"""Passive terminations, excesses of damping and borders of claims, against plain arithmetic."""

import cmath
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from teleopdesign.passivity import sampled_coupling, wave_channel
from teleopdesign.passivity.linear.positive_real import damping_excess, mobility_excess
from teleopdesign.passivity.search import sampled_wave
from teleopdesign.passivity.two_port import termination
from teleopdesign.passivity.two_port.termination import Termination
from teleopdesign.realise.lti import S

PART = st.fractions(0, 5, max_denominator=20)
REAL = st.fractions(Fraction(1, 20), 5, max_denominator=20)
ANY = st.fractions(-5, 5, max_denominator=20)


def plain(pair):
    return complex(float(pair[0]), float(pair[1]))


@settings(max_examples=20)
@given(PART, PART, PART, REAL, ANY)
def test_every_form_of_a_termination_has_the_same_value(damping, inertia, stiffness, rate, turn):
    held, s = Termination(damping, inertia, stiffness), complex(rate, turn)
    expected = complex(damping) + float(inertia) * s + float(stiffness) / s
    size = 1e-12 * (1 + abs(expected))
    forms = [
        held.at(s),
        complex(held.expression.subs(S, sp.Rational(rate) + sp.I * sp.Rational(turn))),
        plain(termination.exact_value(held, (rate, turn))),
    ]
    assert all(abs(one - expected) <= size for one in forms), forms


@settings(max_examples=20)
@given(ANY, ANY, REAL, PART)
def test_a_termination_of_a_value_has_it_and_is_there_wherever_a_passive_one_is(a, b, rate, turn):
    """Of a passive impedance the angle at s is at most that of s."""
    held = termination.termination_of((a, b), (rate, turn))
    angle, most = abs(cmath.phase(complex(a, b))), abs(cmath.phase(complex(rate, turn)))
    assume(abs(angle - most) > 1e-9 or not (a or b))
    assert (held is not None) == (angle <= most or not (a or b))
    if held is not None:
        assert termination.exact_value(held, (rate, turn)) == (a, b)
        assert min(held.damping, held.inertia, held.stiffness) >= 0
        assert not (held.inertia and held.stiffness)
        near = termination.termination_near((a, b), (rate, turn), 7)
        assert abs(plain(termination.exact_value(near, (rate, turn))) - complex(a, b)) <= 1e-5 * (
            abs(complex(a, b)) + float(held.damping)
        )
    else:  # the nearest one has no damper that drives
        assert termination.termination_near((a, b), (rate, turn), 7).damping >= 0


@settings(max_examples=20)
@given(REAL, PART, PART, REAL, ANY)
def test_a_resonance_in_the_place_of_half_a_damper_changes_nothing_at_its_point(d, m, k, rate, w):
    held = Termination(d, m, k)
    made = termination.with_resonance(held, (rate, w))
    assert made.damping == d / 2 and made.inertia > m and made.stiffness > k
    value = termination.exact_value(held, (rate, w))
    assert termination.exact_value(made, (rate, w)) == value


@settings(max_examples=20)
@given(PART, PART, REAL, REAL, PART, ANY, ANY)
def test_velocities_have_their_ratio_and_the_phase_in_which_terminations_take_most(
    damping, inertia, other, rate, turn, first, second
):
    near, far = Termination(damping, inertia), Termination(other, Fraction(0), other)
    s, ratio = complex(rate, turn), complex(first, second if turn else 0)
    v1, v2 = termination.velocities_in_phase(near, far, ratio, s)
    assert max(abs(v1), abs(v2)) == pytest.approx(1.0)
    if turn == 0:
        assert v1.imag == v2.imag == 0 and v2.real == pytest.approx(v1.real * ratio.real)
        return
    assert v2 == pytest.approx(v1 * ratio, rel=1e-9, abs=1e-12)
    power = (near.at(s) * v1**2 + far.at(s) * v2**2) / s
    assume(abs(power) > 1e-6)
    assert abs(cmath.phase(power)) < 1e-6


# Z = n(s)/d(s) and where Re Z(jw) is least, by hand
EXCESS = {
    "a damped mass": (2 * S + 3, 3.0),
    "a spring": (5 / S, 0.0),
    "a damper behind a spring": (1 / (1 / sp.S(4) + S / 8), 0.0),  # at high frequency
    "a lead": ((S + 1) / (S + 4), 0.25),
    "a lag": ((S + 4) / (S + 1), 1.0),
    "a damper less a narrow dip": (3 - S / (S**2 + S + 1), 2.0),
    "a driving damper": (S - sp.S(1) / 2, -0.5),
    "a force that grows": (1 / (S - 1), -np.inf),
    "a negative mass": (2 - S, -np.inf),
    "an acceleration fed back": (1 - S**2 / 3 + S**3, -np.inf),
}


@pytest.mark.parametrize("name", EXCESS)
def test_the_excess_of_damping_is_the_least_real_part(name):
    z, least = EXCESS[name]
    excess = damping_excess(z)
    assert float(excess) == pytest.approx(least, abs=1e-9)
    assert excess.lower <= excess.upper
    if np.isfinite(least) and np.isfinite(excess.frequency):
        there = complex(z.subs(S, sp.I * excess.frequency)) if excess.frequency else z.subs(S, 0)
        if there.is_finite if isinstance(there, sp.Expr) else True:
            assert sp.re(there) == pytest.approx(least, abs=1e-6)


@pytest.mark.parametrize("name", ["a damped mass", "a lead", "a lag", "a damper less a narrow dip"])
def test_the_excess_of_a_mobility_is_the_least_real_part_of_the_inverse(name):
    z = EXCESS[name][0]
    w = np.concatenate([[1e-9], np.geomspace(1e-4, 1e6, 200_001)])
    inverse = sp.lambdify(S, 1 / z, "numpy")(1j * w)
    assert float(mobility_excess(z)) == pytest.approx(np.real(inverse).min(), abs=1e-6)


def test_an_impedance_of_nothing_has_a_mobility_without_bound():
    excess = mobility_excess(sp.S(0))
    assert excess.lower == excess.upper == np.inf and excess.frequency == 0.0


def test_a_sampled_coupling_between_two_undamped_masses_has_no_damping_to_count_on():
    law = sp.Rational(3, 2)
    none = sampled_coupling(law, master_damping=0, slave_damping=0, sample_time=1)
    one = sampled_coupling(law, master_damping=5, slave_damping=0, sample_time=1)
    both = sampled_coupling(law, master_damping=2, slave_damping=2, sample_time=1)
    # a spring of K needs K T/2 = 3/4 of the dampings in series: 0, 0 and 1
    assert [c.status for c in (none, one, both)] == ["refuted", "refuted", "proved"]


@pytest.mark.parametrize(
    ("scale", "growth", "status", "lossless"),
    [(1, 0, "proved", True), (sp.Rational(1, 2), 0, "proved", False),
     (sp.Rational(1, 2), sp.Rational(3, 4), "proved", False),
     (sp.Rational(1, 2), sp.Rational(4, 5), "unknown", False),
     (sp.Rational(11, 10), 0, "unknown", False)],
)  # fmt: skip
def test_a_channel_of_waves_loses_nothing_only_at_full_scale(scale, growth, status, lossless):
    """Proved up to f^2 = 1 - d; the margin is what is left of it."""
    claim = wave_channel(wave_impedance=2, scale=scale, delay_growth=growth)
    assert claim.status == status
    if status == "proved":
        assert claim.verdict.margin == pytest.approx(float(1 - growth - scale**2))
        assert ("lossless" in claim.verdict.equality) == lossless
        assert ("grow by" in claim.statement) == (growth != 0)


@pytest.mark.parametrize("seed", range(4))
def test_of_all_mixtures_of_two_travels_the_one_that_releases_most_is_taken(seed):
    """A spring that acts two samples late, held by little damping: energy is quadratic."""
    rng = np.random.default_rng(seed)
    one, other = rng.standard_normal((2, 12))
    system = sp.Rational(-500) / sampled_wave.Z**2, sp.Rational(1, 10), sp.Rational(1, 1000), 500
    energy, travel = sampled_wave._largest(one, other, system)
    assert energy == pytest.approx(float(sampled_wave._released_energy(travel, *system)))
    turns = np.linspace(0, np.pi, 721)
    mixed = np.cos(turns)[:, None] * one + np.sin(turns)[:, None] * other
    best = sampled_wave._released_energy(mixed, *system).max()
    assert energy == pytest.approx(best, rel=1e-4)
