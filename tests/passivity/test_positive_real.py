"""The exact positive-real test: improper, marginal and badly scaled impedances."""

import math
from fractions import Fraction

import control
import numpy as np
import pytest
import sympy as sp

from teleopdesign.base.errors import ModelError
from teleopdesign.passivity import (
    absolutely_stable,
    damping_excess,
    impedance,
    passive,
    positive_real,
    read_record,
    two_port,
    write_record,
)
from teleopdesign.realise.lti import S

PASSIVE = {
    "mass and damper": 0.15 * S + 4,
    "mass": 0.15 * S,
    "spring": 300 / S,
    "mass, damper and spring": 0.15 * S + 4 + 300 / S,
    "nothing": 0,
    "damper": 5,
    "resonance without loss": S / (S**2 + 9),
    "its dual": (S**2 + 9) / S,
    "zeros and poles on the axis in turn": (S**2 + 4) * (S**2 + 16) / (S * (S**2 + 9)),
    "touching zero at one frequency": (S**2 + 1) / (S + 1) ** 2,
    "compliant damper": (S + 1) / (S**2 + S + 1),
    "common factor in the right half plane": (S - 1) * (S + 2) / ((S - 1) * (S + 1)),
}
NOT_PASSIVE = {
    "negative damper": -4,
    "negative mass": 4 - S,
    "negative spring": 4 - 1 / S,
    "second order lag": 1 / (S + 1) ** 2,
    "double integrator": 1 / S**2,
    "jerk": S**3 + S,
    "acceleration squared": S**2,
    "pole that grows": 1 / (S - 1),
    "resonance with negative residue": 1 - S / (S**2 + 9),
    "zeros and poles on the axis not in turn": (S**2 + 4) * (S**2 + 16) / (S * (S**2 + 17)),
    "just beyond touching": (S**2 - sp.Rational(1, 10**12) * S + 1) / (S + 1) ** 2,
    "all-pass": (S - 1) / (S + 1),
}


@pytest.mark.parametrize("name", PASSIVE)
def test_passive_impedances_are_proved(name):
    claim = positive_real(PASSIVE[name])
    assert claim.status == "proved"
    claim.certificates[0].check()


@pytest.mark.parametrize("name", NOT_PASSIVE)
def test_others_are_refuted_by_a_motion_that_gives_out_energy(name, tmp_path):
    claim = positive_real(NOT_PASSIVE[name])
    assert claim.status == "refuted"
    record = claim.record
    assert record.energy > 0
    # Re Z < 0 there, in exact arithmetic
    assert impedance(NOT_PASSIVE[name]).at(record.rate, record.frequency)[0] < 0
    assert record.rate > 0
    write_record(record, tmp_path / "motion.json")
    again = read_record(tmp_path / "motion.json")
    if record.frequency / record.rate < 100:  # else only a part of the wave is sampled
        assert again.replay() == pytest.approx(record.energy, rel=1e-6)
    assert again.replay() > 0


@pytest.mark.parametrize(
    ("z", "excess", "frequency"),
    [
        (0.15 * S + 4 + 300 / S, 4, None),
        ((S**2 + S + 1) / (S + 1) ** 2, 0.5, 1),
        ((S**2 - 0.1 * S + 1) / (S + 1) ** 2, -0.05, 1),
        (1 / (S + 2), 0, math.inf),
        (3 + 1 / (S + 2), 3, math.inf),
        ((S + 1) / (S + 2), 0.5, 0),
        (-7, -7, None),
        (1 / (S - 1), -math.inf, None),
        (4 - S, -math.inf, None),
        (1 / S**2, -math.inf, None),
        (4 - 1 / S, -math.inf, None),
    ],
)
def test_excess_and_shortage_of_damping(z, excess, frequency):
    """The damping that could go (> 0) or is lacking (< 0); worked out by hand."""
    margin = damping_excess(z)
    assert float(margin) == pytest.approx(excess, rel=1e-11, abs=1e-20)
    if frequency is not None:
        assert margin.frequency == pytest.approx(frequency, rel=1e-9)


def test_the_bounds_of_the_excess_are_exact():
    """Z less the lower bound is passive, less the upper it is not: by the same test."""
    for z in (0.3 + (S + 1) / (S**2 + S + 7), (S**2 - 0.1 * S + 1) / (S + 1) ** 2, 2 + 1 / S):
        excess = damping_excess(z)
        assert isinstance(excess.lower, Fraction)
        assert excess.lower < excess.upper
        less = [sp.sympify(z) - sp.Rational(str(c)) for c in (excess.lower, excess.upper)]
        assert [positive_real(e).status for e in less] == ["proved", "refuted"]


def test_floats_are_the_decimals_that_they_are_written_as():
    """On the boundary the binary value of 0.1, which is a little more, would decide."""
    assert impedance(0.1 / S).p.all_coeffs() == [sp.Rational(1, 10)]
    # (s + a)(s + b)/(...) that cancels only if 0.02 is 0.1 * 0.2
    cancels = control.tf([1, 0.3, 0.02], [1, 0.1])
    assert str(impedance(cancels)) == "s + 1/5"


@pytest.mark.parametrize(
    ("system", "message"),
    [
        (S + sp.Symbol("b"), "values are needed for b"),
        (sp.exp(-S), "not a rational function of s"),
        (sp.sqrt(S), "not a rational function of s"),
        (float("nan"), "not finite|finite real number"),
        (control.tf([1], [1, 0.5], 0.001), "discrete"),
        (control.ss([[-1.0]], [[1.0, 0.0]], [[1.0]], [[0.0, 0.0]]), "found 2 and 1"),
        (sp.Matrix([1]), "expected an expression in s"),
        ("s + 1", "expected an expression in s"),
        ((S + 1) ** 100000, "of degree 100000 in s, expected at most"),
        (sp.prod([S + k for k in range(41)]), "of degree 41 in s, expected at most"),
    ],
)
def test_what_is_no_impedance_is_one_clear_line(system, message):
    with pytest.raises(ModelError, match=message):
        positive_real(system)


@pytest.mark.slow
def test_numbers_of_sixteen_digits_are_decided_in_seconds_and_what_is_proved_is_accepted():
    """Twenty-six lags in series with nothing to cancel: remainders would have 10 000 digits."""
    rng = np.random.default_rng(1)
    for number, status in ((18, "proved"), (26, "evidence")):
        lags = [1 / (float(a) * S + float(b)) for a, b in rng.uniform(0.1, 1, (number, 2))]
        claim = positive_real(sum(lags))
        assert claim.status == status and claim.holds
        assert all(c.check() for c in getattr(claim.verdict, "certificates", ()))
        assert positive_real(sum(lags) - 1).status == "refuted"


ONE = control.tf([1, 2], [1, 1])
BOTH = control.tf([[[1, 2], [0]], [[0], [0.5, 1]]], [[[1, 1], [1]], [[1], [1]]])


@pytest.mark.parametrize(
    ("system", "entries"),
    [
        ([[ONE, 0], [0, control.tf([0.5, 1], [1])]], [[(S + 2) / (S + 1), 0], [0, S / 2 + 1]]),
        (BOTH, [[(S + 2) / (S + 1), 0], [0, S / 2 + 1]]),
        (control.ss(-np.eye(2), np.eye(2), np.eye(2), np.eye(2)), sp.eye(2) * (S + 2) / (S + 1)),
        (np.array([[2.0, 1.0], [1.0, 3.0]]), [[2, 1], [1, 3]]),
    ],
)
@pytest.mark.parametrize("decide", [passive, absolutely_stable])
def test_a_two_port_of_python_control_is_that_of_its_expressions(system, entries, decide):
    """A one-port could be one, and the error for a matrix of them pointed to `two_port`."""
    assert repr(decide(two_port(system))) == repr(decide(two_port(entries)))
