"""Ports with dead times: refuted beyond a known limit, evidence within it."""

import control as ct
import mpmath
import numpy as np
import pytest
import sympy as sp
from devices import body

from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.passivity import absolutely_stable, passive, ports, two_port
from teleopdesign.passivity.linear.family import family_of_matrix
from teleopdesign.passivity.linear.judge import passive_claim
from teleopdesign.passivity.linear.sweep import passive_margin
from teleopdesign.passivity.linear_diagrams import linear_claims

S = sp.Symbol("s")


def late(seconds):
    return controller("delay", {"time": seconds})


def ratio(*sides):
    return from_control(ct.tf(*sides), name="ratio")


def held(*laws, damping=1.0, read="x", sign=-1):
    """A mass of 0.1 kg on what the laws make of its position, one after the other."""
    signals = [read, *(f"y{k}" for k in range(len(laws)))]
    controls = [
        Control(f"C{k}", law, signals[k], signals[k + 1], "x") for k, law in enumerate(laws)
    ]
    mass = Moving("M", body(0.1, viscous__damping=damping), "x", "u", {"f": 1}, "f")
    force = Junction("u", {signals[-1]: sign})
    return Diagram("late", (mass, *controls), (force,), {"f": "force"}, ())


def interval_claim(diagram):
    (one,) = linear_claims(diagram, ports(diagram))
    return one.claim


@pytest.mark.parametrize(
    ("delay", "status"),
    [
        (0.0, "proved"),
        (0.005, "evidence"),
        (0.01, "evidence"),
        (0.012, "refuted"),
        (0.1, "refuted"),
    ],
)
def test_a_late_spring_is_passive_up_to_the_delay_that_its_damping_pays_for(delay, status):
    """Re Z = b - K sin(w T)/w >= 0 at all w if and only if K T <= b: 100 N/m, 1 N s/m."""
    claim = interval_claim(held(late(delay), ratio([100.0], [1.0])))
    assert claim.status == status
    if status == "refuted":
        assert claim.record.replay() > 0
        assert claim.record.impedance.shape == (1, 1)


@pytest.mark.parametrize("seed", range(6))
def test_no_point_of_the_right_half_plane_is_active_where_there_is_evidence(seed):
    """Late and low-passed laws at random, and an own look at Re Z at 4000 points."""
    rng = np.random.default_rng(seed)
    k, b, corner, delay, tau = 10.0 ** rng.uniform([0, -1, 0, -3, -2], [2, 1, 2, -1, 0])
    z = sum(
        (
            sp.Rational(1, 10) * S + sp.Rational(repr(float(b))),
            sp.Rational(repr(float(k))) / S / (1 + S / sp.Rational(repr(float(corner))))
            * sp.exp(-S * sp.Rational(repr(float(delay)))),
            sp.Rational(repr(float(tau))) * sp.exp(-S / 100) / (1 + S / 50),
        )
    )  # fmt: skip
    claim = passive_claim(family_of_matrix([[z]]))
    w = 10.0 ** rng.uniform(-4, 5, 4000)
    s = w * (10.0 ** rng.uniform(-9, 0, 4000) + 1j)
    value = (
        0.1 * s
        + b
        + k / s / (1 + s / corner) * np.exp(-s * delay)
        + tau * np.exp(-s / 100) / (1 + s / 50)
    )
    if claim.status == "evidence":
        assert (value.real > -1e-12 * np.abs(value)).all()
    else:
        assert claim.status == "refuted"
        wave = claim.record
        with mpmath.workdps(60):
            at = mpmath.mpc(*(mpmath.mpf(x.numerator) / x.denominator
                              for x in (wave.rate, wave.frequency)))  # fmt: skip
            exact = sp.lambdify(S, z, "mpmath")(at)
            assert exact.real < 0 < at.real


@pytest.mark.parametrize(
    ("gain", "delay", "status"),
    [
        (0.5, 0.01, "evidence"),
        (0.5, 0.9, "evidence"),
        (0.5, 1.1, "refuted"),
        (2.0, 0.01, "refuted"),
    ],
)
def test_a_dead_time_in_a_loop_of_laws_counts_with_its_poles(gain, delay, status):
    """y = g (x + y(t - T)): a chain of poles, and a spring that takes T N s/m away for g = 1/2."""
    mass = Moving("M", body(0.1, viscous__damping=1.0), "x", "u", {"f": 1}, "f")
    parts = (
        mass,
        Control("D", late(delay), "y", "z", "x"),
        Control("C", ratio([gain], [1.0]), "e", "y", "x"),
    )
    sums = (Junction("e", {"x": 1, "z": 1}), Junction("u", {"y": -1}))
    claim = interval_claim(Diagram("loop", parts, sums, {"f": "force"}, ()))
    assert claim.status == status, claim


@pytest.mark.parametrize(
    ("laws", "stays"),
    [
        ([ratio([1.0], [1.0, 0, 0]), late(0.005), ratio([10.0, 0, 0], [1.0, 20.0, 100.0])], True),
        ([ratio([1.0], [1.0, -1.0]), late(0.005), ratio([1.0, -1.0], [1.0, 9.0])], True),
        ([late(0.005).then(ratio([1.0, -1.0], [1.0, 8.0, -9.0]))], True),
        ([late(0.005), ratio([10.0], [1.0, 20.0, 100.0])], False),
        ([ratio([10.0, 0.0], [1.0, 0.0]), late(0.005)], True),
        ([ratio([10.0, 10.0], [1.0, 1.0]), late(0.005)], False),
    ],
)
def test_beside_a_mode_that_laws_with_a_dead_time_cancel_there_is_no_evidence(laws, stays):
    diagram = held(*laws, damping=5.0)
    assert interval_claim(diagram).holds is (None if stays else True)


def test_a_pole_at_a_frequency_of_a_sweep_has_no_margin_there():
    z = np.array([[[complex(np.inf, np.nan), 0], [0, 1]], [[2, 0], [0, 1]]], dtype=complex)
    np.testing.assert_array_equal(passive_margin(z), [np.nan, 1.0])


def test_a_resonance_narrower_than_the_steps_of_a_sweep_is_looked_at():
    """1e-5 of its frequency wide, late by half a turn: Re Z is -48 N s/m there, 0.1 at low f."""
    w, width = sp.Rational(31417, 100), sp.Rational(1, 100000)
    swing = 100 * width * w * S / (S**2 + 2 * width * w * S + w**2)
    z = S / 10 + 1 - sp.Rational(9, 10) / (1 + S / 10) + swing * sp.exp(-S / 100) / (1 + S / 1000)
    claim = passive_claim(family_of_matrix([[z]]))
    assert claim.status == "refuted" and claim.record.replay() > 0


E_T = sp.exp(-S / 5)
#: what no sweep of the axis shows, and what it does show; z11, z12, z21, z22
NAMED = {
    "a late spring between dampers": ([1 + 3 / S, E_T / S, E_T / S, 1 + 3 / S], True),
    "a residue that is no spring": ([1 + 1 / S, 3 * E_T / S, 3 * E_T / S, 1 + 1 / S], False),
    "two poles at zero": ([1 + 1 / S**2, E_T, E_T, 1], False),
    "a growing pole": ([1 + 1 / (S - 1), E_T, E_T, 1], False),
    "a dead time below": ([1, E_T, 1 / (2 + E_T), 1], True),
    "a late port": ([2 + S, E_T, E_T, 3 + E_T], True),
    "growth like s^2": ([S**2 + 1, E_T, E_T, 1], False),
    "a late mass": ([1 + S, S * E_T, S * E_T, 1 + S], False),
    "dampers that a late one outdoes": ([1, 2 * E_T, 2 * E_T, 1], False),
    "two poles on the axis": ([1 + 1 / (S**2 + 1) ** 2, E_T / 2, E_T / 2, 1], False),
    "a resonance that one port has": (
        [1, E_T / 4 + S / (S**2 + 4), E_T / 4 + S / (S**2 + 4), 1], False,
    ),
}  # fmt: skip


@pytest.mark.parametrize("claim", [passive, absolutely_stable])
@pytest.mark.parametrize("name", NAMED)
def test_there_is_no_evidence_beside_what_the_axis_does_not_show(name, claim):
    """Beside a dead time nothing is proved; what a sweep sees as a margin need not hold."""
    entries, holds = NAMED[name]
    made = claim(two_port([entries[:2], entries[2:]]))
    assert made.status in (("evidence", "unknown") if holds else ("refuted", "unknown"))
    if holds:
        assert made.status == "evidence", made


@pytest.mark.parametrize(("r1", "r2"), [(1, 4), (2, 2)])
@pytest.mark.parametrize("rest", [0, 10 / (S + 1)])
def test_late_dampers_stay_within_those_of_the_ports_far_out(r1, r2, rest):
    """Dampers that are ten times as strong at low frequency bound no late coupling beyond."""
    for forth, back in ((1, 1), (2, 2), (4, 2), (1, 4), (3, 1)):
        system = two_port([[r1 + rest, forth * E_T], [back * E_T, r2 + rest]])
        if r1 * r2 != forth * back:  # at equality rounding may decide
            assert bool(absolutely_stable(system).holds) == (r1 * r2 > forth * back)
        assert not passive(system).holds or 2 * (r1 * r2) ** 0.5 >= forth + back


@pytest.mark.parametrize("claim", [passive, absolutely_stable])
@pytest.mark.parametrize(("here", "across"), [(5.5, 6), (6.5, 6), (3, 0)])
@pytest.mark.parametrize("pole", [S, S**2 + sp.Rational(7, 3)])
def test_what_two_ports_share_without_loss_is_held_against_their_product(claim, here, across, pole):
    """Springs, or oscillators, of a network that acts alike both ways, beside a dead time."""
    shape = (1 if pole == S else S) / pole
    rest = 5 + sp.exp(-S / 10) / (1 + S) / 10
    here, across = sp.Rational(str(here)) * shape, across * shape
    made = claim(two_port([[here + rest, across], [across, here + 5]]))
    assert bool(made.holds) == (here / shape >= across / shape), made


def test_three_ports_with_dead_times_are_judged_as_one_and_two():
    """Dampers of 1 N s/m and a late one, of half and of twice as many."""
    half, twice = (sp.diag(1 + k * E_T, 1, 2).tolist() for k in (sp.Rational(1, 2), 2))
    assert passive_claim(family_of_matrix(half)).status in ("evidence", "unknown")
    assert passive_claim(family_of_matrix(twice)).status == "refuted"
