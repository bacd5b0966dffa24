"""Dead times: ports refuted beyond a known limit, evidence within it; stability over intervals."""

import control as ct
import numpy as np
import pytest
import sympy as sp
from devices import body
from realise.test_delay_blocks import held as late_spring

from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import Control, Diagram, Junction, Moving, haptic_interface
from teleopdesign.passivity import absolutely_stable, claim_over_intervals, passive, ports, two_port
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
    # a whole turn of the mode, less 3e-7
    "a mode whose force is late by a turn": (
        [1 + S * sp.exp(-S * sp.Rational(6283185, 10**6)) / (S**2 + 1), 0, 0, 1], False,
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


TIME = "T_1.delay.time"
DAMPING, MASS = 5.0, 0.1


def limit(stiffness):
    """m (jw)^2 + b jw = -k e^(-jwT): the smallest such T, s."""
    w = np.roots([MASS**2, 0, DAMPING**2, 0, -(stiffness**2)])
    w = w[(np.abs(w.imag) < 1e-9) & (w.real > 0)].real[0]
    return np.arctan2(DAMPING, MASS * w) / w


@pytest.mark.slow
@pytest.mark.parametrize(("share", "status"), [(0.99, "proved"), (1.03, "refuted")])
def test_a_gain_within_an_interval_counts_at_its_worst(share, status):
    box = {TIME: (0.0, float(share * limit(25.0))), "P.spring_damper.stiffness": (10.0, 25.0)}
    claim = claim_over_intervals(late_spring(0.01, damping=DAMPING), box, claim="stable", points=4)
    assert claim.status == status, claim
    if status == "refuted":
        assert claim.worst["P.spring_damper.stiffness"] == 25.0


@pytest.mark.parametrize(("gain", "status"), [(10.0, "proved"), (1000.0, "refuted")])
def test_a_dead_time_of_an_actuator_counts_as_one_of_a_law(gain, status):
    """m s^2 + b s + k + g e^(-s T) for a rod that a gain holds through a late actuator."""
    device = body(0.1, viscous__damping=1.0, spring__stiffness=1.0, actuation_delay__delay=0.01)
    diagram = haptic_interface(device, position_loop=controller("gain", {"gain": gain}))
    claim = claim_over_intervals(diagram, {"Z_M.inertia": (0.1, 0.2)}, claim="stable", points=2)
    assert claim.status == status, claim


def beside_a_hidden_loop(back=-3.0):
    """A damped mass, and z' = -z - 3 z(t - T), which it drives and which it does not feel."""
    mass = Moving("M", body(0.1, viscous__damping=1.0), "x", "u", {"f": 1}, "f")
    parts = (
        mass,
        Control("L", ratio([1.0], [1.0, 1.0]), "e", "y"),
        Control("D", late(0.1), "y", "z"),
    )
    sums = (Junction("e", {"x": 1.0, "z": back}), Junction("u", {}))
    return Diagram("hidden", parts, sums, {"f": "force"}, ())


@pytest.mark.parametrize(("longest", "holds"), [(0.4, True), (2.0, None)])
def test_a_mode_with_a_dead_time_that_grows_somewhere_in_a_box_leaves_no_evidence(longest, holds):
    """It grows from T = acos(-1/3)/sqrt(8) = 0.676 s on, and no frequency shows it."""
    box = {"D.delay.time": (0.1, longest)}
    assert claim_over_intervals(beside_a_hidden_loop(), box, points=4).holds is holds


@pytest.mark.parametrize(("back", "status"), [(-3.0, "refuted"), (-0.5, "unknown")])
def test_dead_times_that_are_too_long_to_be_followed_leave_stability_open(back, status):
    diagram = beside_a_hidden_loop(back).with_values({"D.delay.time": 1e9})
    assert claim_over_intervals(diagram, {}, claim="stable").status == status
