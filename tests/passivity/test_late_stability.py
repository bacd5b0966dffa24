"""Stability over intervals of dead times: proved up to the exact limit, refuted beyond it."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from devices import body
from passivity.attacks.test_late_boxes import late_diagram
from realise.test_delay_blocks import held

from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.passivity import claim_over_intervals
from teleopdesign.passivity.intervals.box import ValueBox
from teleopdesign.passivity.intervals.late_cells import LateSum, is_zero_free

TIME = "T_1.delay.time"
DAMPING, STIFFNESS, MASS = 5.0, 20.0, 0.1


def limit(stiffness):
    """m (jw)^2 + b jw = -k e^(-jwT): the smallest such T, s."""
    w = np.roots([MASS**2, 0, DAMPING**2, 0, -(stiffness**2)])
    w = w[(np.abs(w.imag) < 1e-9) & (w.real > 0)].real[0]
    return np.arctan2(DAMPING, MASS * w) / w


def terms(rows, values=()):
    """rows: coefficient, then powers of s, values and e^(-s T), with T up to 1 s."""
    names = tuple(f"v{k}" for k in range(len(values)))
    mark = sp.Symbol("E")
    ring, *_ = sp.ring((sp.Symbol("s"), *map(sp.Symbol, names), mark), sp.QQ)
    p = ring({})
    for c, *powers in rows:
        p += ring({tuple(powers): sp.QQ(*Fraction(c).as_integer_ratio())})
    low, high = zip(*values, strict=True) if values else ((), ())
    return LateSum.of(p, {mark: sp.S(1)}, ValueBox(names, tuple(low), tuple(high)))


@pytest.mark.parametrize(("share", "status"), [(0.999, "proved"), (1.02, "refuted")])
def test_a_late_spring_is_stable_up_to_its_exact_limit(share, status):
    box = {TIME: (0.01, float(share * limit(STIFFNESS)))}
    claim = claim_over_intervals(held(0.01, damping=DAMPING), box, claim="stable", points=4)
    assert claim.status == status, claim
    assert (claim.proved_margin == 0.0) is (status == "proved")


@pytest.mark.slow
@pytest.mark.parametrize(("share", "status"), [(0.99, "proved"), (1.03, "refuted")])
def test_a_gain_within_an_interval_counts_at_its_worst(share, status):
    box = {TIME: (0.0, float(share * limit(25.0))), "P.spring_damper.stiffness": (10.0, 25.0)}
    claim = claim_over_intervals(held(0.01, damping=DAMPING), box, claim="stable", points=4)
    assert claim.status == status, claim
    if status == "refuted":
        assert claim.worst["P.spring_damper.stiffness"] == 25.0


@pytest.mark.slow
def test_a_fixed_dead_time_beside_an_interval_of_a_gain():
    time = limit(25.0)
    for share, status in ((0.99, "proved"), (1.03, "refuted")):
        diagram = held(float(share * time), damping=DAMPING)
        box = {"P.spring_damper.stiffness": (10.0, 25.0)}
        assert claim_over_intervals(diagram, box, claim="stable", points=4).status == status


def test_what_is_stable_with_a_dead_time_alone_is_no_proof():
    """x'' + 10 x - 2.9 x(t - T): a late push damps. Without a dead time it swings for ever."""
    values = {
        "M.inertia": 1.0, "M.viscous.damping": 0.0, "M.spring.stiffness": 10.0,
        "P.proportional_derivative.stiffness": 0.1, "P.proportional_derivative.damping": 0.0,
        "P.proportional_derivative.bandwidth": 10.0, "G.gain.gain": -3.0, TIME: 0.5,
        "T_2.delay.time": 0.0,
    }  # fmt: skip
    claim = claim_over_intervals(late_diagram(values), {TIME: (0.4, 0.6)}, claim="stable", points=4)
    assert claim.status == "evidence" and claim.margin > 0.4, claim


@pytest.mark.slow
def test_a_zero_inside_is_never_called_free_of_zeros():
    rng = np.random.default_rng(3)
    for _ in range(12):
        w, time, value = rng.uniform(0.2, 5), rng.uniform(0.05, 0.95), rng.uniform(-0.9, 0.9)
        # s^2 + a s + b + (c + v - v_0) e^(-s T) with f(jw) = 0 at that T and v = v_0
        c, a = rng.uniform(0.1, 3), 0.0
        late = c * np.exp(-1j * w * time)
        a, b = -late.imag / w, w * w - late.real
        rows = [(1, 2, 0, 0), (a, 1, 0, 0), (b, 0, 0, 0), (c - value, 0, 0, 1), (1, 0, 1, 1)]
        assert is_zero_free(terms(rows, [(-1.0, 1.0)]), most=3000) is None


def test_terms_as_strong_as_the_first_at_high_frequency_are_not_called_free_of_zeros():
    assert is_zero_free(terms([(1, 1, 0), (1, 0, 0), (0.9, 1, 1)])) is not None
    assert is_zero_free(terms([(1, 1, 0), (1, 0, 0), (1.0, 1, 1)])) is None
    assert is_zero_free(terms([(1, 1, 1), (1, 0, 0)])) is None


@pytest.mark.parametrize(("gain", "status"), [(10.0, "proved"), (1000.0, "refuted")])
def test_a_dead_time_of_an_actuator_counts_as_one_of_a_law(gain, status):
    """m s^2 + b s + k + g e^(-s T) for a rod that a gain holds through a late actuator."""
    device = body(0.1, viscous__damping=1.0, spring__stiffness=1.0, actuation_delay__delay=0.01)
    diagram = haptic_interface(device, position_loop=controller("gain", {"gain": gain}))
    claim = claim_over_intervals(diagram, {"Z_M.inertia": (0.1, 0.2)}, claim="stable", points=2)
    assert claim.status == status, claim


@pytest.mark.slow
def test_zeros_on_edges_of_parts_and_beyond_the_range_of_floats_are_not_passed_over():
    """s^2 + w^2 for each w that halving meets, and coefficients of 10^200 and 10^-320."""
    for w in (Fraction(1, 2), Fraction(1), Fraction(3, 8), Fraction(12345, 1024)):
        for size in (Fraction(1), Fraction(10) ** 200, Fraction(1, 10**320)):
            rows = [(size, 2, 0), (size * w * w, 0, 0), (size / 1000, 0, 1), (-size / 1000, 0, 0)]
            assert is_zero_free(terms(rows), most=3000) is None  # at T = 0


def test_what_is_large_beyond_floats_is_counted_as_others():
    """The same polynomial in another unit of its value is shown as well, from 1e-320 to 1e320."""
    plain = [(1, 1, 0), (1, 0, 0), (Fraction(9, 10), 0, 1)]
    shown = is_zero_free(terms(plain))
    assert shown is not None
    for size in (Fraction(10) ** 320, Fraction(1, 10**320)):
        assert is_zero_free(terms([(c * size, *rest) for c, *rest in plain])) == shown


def test_a_zero_a_hair_beyond_the_axis_is_never_called_stable():
    """s^2 + a s + b with a from 1e-9 down to minus that: floats alone lose the sign."""
    for damping in (Fraction(1, 10**17), Fraction(0), Fraction(-1, 10**17)):
        rows = [(1, 2, 0), (damping, 1, 0), (1, 0, 0), (Fraction(1, 10**18), 0, 1)]
        assert is_zero_free(terms(rows), most=20_000) is None


@pytest.mark.parametrize("others", [[1.0], [1.0, 2.0], [0.5, 1.0, 2.0]])
def test_a_zero_on_the_axis_is_met_whatever_the_degree(others):
    """(s^2 + 9) times decaying factors, and (s^2 + s + 9) times the same."""
    for middle, shown in ((0.0, False), (1.0, True)):
        whole = np.polymul(np.poly(np.negative(others)), [1.0, middle, 9.0])[::-1]
        rows = [(Fraction(float(c)), k, 0) for k, c in enumerate(whole)]
        # 1e-6 (e^(-s T) - 1) is zero at T = 0, where the plain polynomial counts
        rows += [(Fraction(1, 10**6), 0, 1), (-Fraction(1, 10**6), 0, 0)]
        assert (is_zero_free(terms(rows), most=20_000) is not None) is shown
