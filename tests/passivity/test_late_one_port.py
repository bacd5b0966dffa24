"""One port with dead times: refuted beyond a known limit, evidence within it."""

import control as ct
import mpmath
import numpy as np
import pytest
import sympy as sp
from devices import body

from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.passivity import ports
from teleopdesign.passivity.linear_diagrams import linear_claims
from teleopdesign.passivity.two_port.late_one_port import late_one_port
from teleopdesign.passivity.two_port.two_port import passive_margin

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


def judged(diagram):
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
    claim = judged(held(late(delay), ratio([100.0], [1.0])))
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
    claim = late_one_port(z)
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


def test_a_dead_time_in_a_loop_of_laws_is_unknown_and_says_why():
    """y = 0.5 (x + y(t - T)): its poles are those of 1 - 0.5 e^(-s T), which nothing counts."""
    mass = Moving("M", body(0.1, viscous__damping=1.0), "x", "u", {"f": 1}, "f")
    parts = (
        mass,
        Control("D", late(0.01), "y", "z", "x"),
        Control("C", ratio([0.5], [1.0]), "e", "y", "x"),
    )
    sums = (Junction("e", {"x": 1, "z": 1}), Junction("u", {"y": -1}))
    claim = judged(Diagram("loop", parts, sums, {"f": "force"}, ()))
    assert claim.status == "unknown" and "a dead time in the denominator" in str(claim.verdict)


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
    assert judged(diagram).holds is (None if stays else True)


def test_a_pole_at_a_frequency_of_a_sweep_has_no_margin_there():
    z = np.array([[[complex(np.inf, np.nan), 0], [0, 1]], [[2, 0], [0, 1]]], dtype=complex)
    np.testing.assert_array_equal(passive_margin(z), [np.nan, 1.0])


def test_a_resonance_narrower_than_the_steps_of_a_sweep_is_looked_at():
    """1e-5 of its frequency wide, late by half a turn: Re Z is -48 N s/m there, 0.1 at low f."""
    w, width = sp.Rational(31417, 100), sp.Rational(1, 100000)
    swing = 100 * width * w * S / (S**2 + 2 * width * w * S + w**2)
    z = S / 10 + 1 - sp.Rational(9, 10) / (1 + S / 10) + swing * sp.exp(-S / 100) / (1 + S / 1000)
    claim = late_one_port(z)
    assert claim.status == "refuted" and claim.record.replay() > 0
