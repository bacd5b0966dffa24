"""Claims over boxes of devices whose answer is known in closed form; the search for the worst."""

import math

import control as ct
import numpy as np
import pytest
import sympy as sp
from devices import body

from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import Control, Diagram, Junction, Moving, haptic_interface, teleoperator
from teleopdesign.passivity import claim_over_intervals
from teleopdesign.passivity.intervals.box import ValueBox, box_of
from teleopdesign.passivity.intervals.linear import margin_over
from teleopdesign.passivity.intervals.worst import port_margin, search_worst
from teleopdesign.passivity.linear.family import Family


def held(inertia=0.2, damping=2.0, stiffness=100.0, extra=0.0):
    """A mass on a spring and a damper to ground, which a controller makes."""
    law = controller("spring_damper", {"stiffness": stiffness, "damping": extra})
    return Diagram(
        "held",
        (
            Moving("M", body(inertia, viscous__damping=damping), "x", "u", {"f": 1}, "f"),
            Control("P", law, "x", "F", "x", analog=True),
        ),
        (Junction("u", {"F": -1}),),
        {"f": "force"},
        measured=("x",),
    )


def joined(damping=3.0):
    """Two masses with dampers to ground, on a spring and a damper between them."""
    law = controller("spring_damper", {"stiffness": 100.0, "damping": damping})
    return teleoperator(
        body(0.2, viscous__damping=2.0), body(0.3, viscous__damping=1.0), coupling=law
    )


@pytest.mark.slow
@pytest.mark.parametrize("low", [-1.5, -0.4, 0.5])
def test_a_damped_mass_is_passive_by_the_least_sum_of_its_dampings(low):
    """Re Z = d + c at every frequency: the margin of a box is its least sum."""
    box = {
        "M.viscous.damping": (1.0, 3.0),
        "P.spring_damper.damping": (low, 2.0),
        "M.inertia": (0.1, 0.4),
        "P.spring_damper.stiffness": (50.0, 200.0),
    }
    claim = claim_over_intervals(held(), box, points=8)
    least = 1.0 + low
    assert claim.margin == pytest.approx(least, rel=1e-6) if least > 0 else claim.margin < 0
    assert claim.status == ("proved" if least > 0 else "refuted")
    assert claim.holds is (least > 0) and claim.unit == "N s/m" and claim.time == "any"
    sums = claim.worst["M.viscous.damping"] + claim.worst["P.spring_damper.damping"]
    if least > 0:
        assert sums == pytest.approx(least)
        assert 0.99 * least < claim.proved_margin <= least
        assert claim.certificates
        assert claim.at_worst.holds
    else:
        assert sums < 0 and math.isnan(claim.proved_margin) and not claim.certificates
        assert claim.at_worst.holds is False
    assert set(claim.worst) == set(claim.intervals) == set(box) == set(claim.units)
    assert claim.points >= 2**4 + 1 + 8


def test_a_mass_without_any_damping_is_passive_by_nothing():
    """At the border the claim still holds over the box, with a proved margin of zero."""
    claim = claim_over_intervals(held(damping=0.0), {"M.inertia": (0.1, 0.4)}, points=4)
    assert claim.holds and claim.margin == pytest.approx(0.0, abs=1e-9) and claim.margin >= 0


@pytest.mark.parametrize("damping", [(0.5, 2.0), (20.0, 30.0), (-3.0, 1.0)])
def test_the_pole_margin_of_a_held_mass_is_that_of_its_quadratic(damping):
    """m s^2 + d s + k: d/2m where it swings, the slower of two real roots where it does not."""
    box = {
        "P.spring_damper.damping": damping,
        "M.inertia": (0.1, 0.3),
        "P.spring_damper.stiffness": (60.0, 100.0),
    }
    claim = claim_over_intervals(held(), box, claim="stable", points=16)

    def margin(d, m, k):
        return -np.roots([m, 2.0 + d, k]).real.max()

    corners = [margin(d, m, k) for d in damping for m in (0.1, 0.3) for k in (60.0, 100.0)]
    assert claim.unit == "1/s" and claim.margin == pytest.approx(min(corners), rel=1e-6)
    point = [claim.worst[n] for n in box]
    assert margin(*point) == pytest.approx(claim.margin, rel=1e-9)
    if min(corners) > 0:
        assert claim.status == "proved" and 0.99 * claim.margin < claim.proved_margin
        assert claim.proved_margin <= claim.margin and len(claim.certificates) == 1
    else:
        assert claim.status == "refuted" and f"{-claim.margin:.4g} 1/s" in claim.how
        assert math.isnan(claim.proved_margin) and not claim.certificates


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "low", "status"),
    [("passive", -0.45, "proved"), ("absolutely stable", -0.45, "proved"),
     ("absolutely stable", -0.55, "refuted")],
)  # fmt: skip
def test_two_joined_masses_are_passive_and_stable_at_any_hands_down_to_the_same_damper(
    name, low, status
):
    """D + c [1 -1; -1 1] has the determinant d1 d2 + c (d1 + d2): c may be -1/2 for 1 and 1."""
    box = {"Z_m.viscous.damping": (1.0, 2.0), "P.spring_damper.damping": (low, 2.0)}
    claim = claim_over_intervals(joined(), box, claim=name, points=2)
    assert claim.status == status and claim.unit == {"passive": "N s/m"}.get(name, "1")
    d, c = (claim.worst[n] for n in box)
    matrix = np.diag([d, 1.0]) + c * np.array([[1, -1], [-1, 1]])
    if status == "refuted":
        assert d + c * (d + 1.0) < 0 and claim.at_worst.holds is False
    elif name == "passive":
        assert claim.margin == pytest.approx(np.linalg.eigvalsh(matrix)[0], rel=1e-5)
        assert claim.margin == pytest.approx(min(1.0 + 2 * low, 1.0), rel=1e-4)
        assert 0.4 * claim.margin < claim.proved_margin <= claim.margin
    else:
        assert claim.proved_margin == 0.0 and claim.margin > 0


def test_the_margin_over_a_box_is_a_function_of_its_values():
    """Of the diagram by itself at each: passivity, poles, and Llewellyn's margin of two ports."""
    rng, names = np.random.default_rng(5), ("P.spring_damper.damping", "P.spring_damper.stiffness")
    box = dict(zip(names, ((0.0, 2.0), (50.0, 150.0)), strict=True))
    one, two = box_of(held(), box), box_of(joined(), box)
    passive, poles = (margin_over(*one, c) for c in ("passive", "stable"))
    both, stable = (margin_over(*two, c) for c in ("passive", "absolutely stable"))
    for _ in range(6):
        c, k = point = np.array([rng.uniform(0.1, 2.0), rng.uniform(50.0, 150.0)])
        assert passive(point) == pytest.approx(2.0 + c, rel=1e-9)
        assert poles(point) == pytest.approx(-np.roots([0.2, 2.0 + c, k]).real.max(), rel=1e-9)
        matrix = np.diag([2.0, 1.0]) + c * np.array([[1, -1], [-1, 1]])
        assert both(point) == pytest.approx(np.linalg.eigvalsh(matrix)[0], rel=1e-6)
        # 2 (r1 r2 - c^2) / (c^2 + (k/w)^2): next to nothing for slow motion, never below zero
        assert 0 <= stable(point) < 1e-3
    growing = margin_over(*one, "stable")(np.array([-2.5, 100.0]))
    assert growing == pytest.approx(-1.25, rel=1e-9)


def test_a_controller_that_grows_behind_a_port_leaves_no_margin_at_all():
    """A pole at 20 1/s in the controller is a pole of the impedance: minus infinity."""
    grows = from_control(ct.tf([1.0], [1.0, -20.0]), name="grows")
    diagram = haptic_interface(body(0.2, viscous__damping=1.0), position_loop=grows)
    claim = claim_over_intervals(diagram, {"Z_M.inertia": (0.1, 0.2)}, points=4)
    assert claim.status == "refuted" and claim.margin == -np.inf
    claim = claim_over_intervals(diagram, {"Z_M.inertia": (0.1, 0.2)}, claim="stable", points=4)
    assert claim.status == "refuted" and claim.margin < -10.0


def box_of_values(low, high):
    return ValueBox(tuple(f"v{i}" for i in range(len(low))), tuple(low), tuple(high))


@pytest.mark.parametrize("least", [(1.23, -0.4), (2.0, 0.77), (0.0, -1.0), (1.5, 5.0)])
def test_the_search_for_the_worst_goes_down_inside_and_along_the_sides(least):
    """A bowl whose bottom lies inside, on a side, in a corner, or beyond: the nearest point."""
    box = box_of_values((0.0, -1.0), (2.0, 1.0))

    def bowl(point):
        return float(3.0 + (point[0] - least[0]) ** 2 + 2 * (point[1] - least[1]) ** 2)

    nearest = np.clip(least, box.low, box.high)
    minimum = search_worst(bowl, box, points=16, seed=0)
    np.testing.assert_allclose(minimum.point, nearest, atol=2e-3)
    assert minimum.margin == bowl(minimum.point) <= bowl(nearest) + 1e-5
    assert np.all(minimum.point >= box.low) and np.all(minimum.point <= box.high)
    looked = []
    alone = search_worst(lambda p: looked.append(tuple(p)) or bowl(p), box, points=16, seed=0,
                         downhill=False)  # fmt: skip
    assert alone.points == len(looked) == len({*looked}) == 4 + 1 + 16 < minimum.points
    assert {(0.0, -1.0), (2.0, -1.0), (0.0, 1.0), (2.0, 1.0), (1.0, 0.0)} <= {*looked}
    assert alone.margin == min(map(bowl, looked)) and minimum.margin <= alone.margin


def test_where_the_claim_fails_by_more_than_a_number_says_the_search_ends_there():
    box = box_of_values((0.0,), (1.0,))
    point = search_worst(lambda p: -np.inf if p[0] == 1.0 else 1.0, box, points=4, seed=0)
    assert point.margin == -np.inf and point.point == [1.0] and point.points == 2 + 1 + 4


@pytest.mark.parametrize("damping", [1e-4, 1e-3, 0.03])
def test_the_least_margin_beside_a_sharp_resonance_is_detected_between_grid_points(damping):
    """Z = 5 - 1/(s + d + 1/s): a narrow dip of depth 1/d about 1 rad/s, whatever its width."""
    _, s, d = sp.ring("s, d", sp.QQ)
    below, size = s**2 + d * s + 1, sp.QQ(*damping.as_integer_ratio())
    family = Family(
        [[5 * size * below - size**2 * s]], below, below, names=("v0",), ends=((damping, 1.0),)
    )
    margin = port_margin(family, "passive")
    assert margin(np.array([damping])) == pytest.approx(4 * damping, rel=0.02)
    assert margin(np.array([-damping])) == -np.inf


def test_a_negative_spring_leaves_no_margin_though_its_real_part_is_that_of_the_damper():
    """Z = m s + d - k/s: Re Z = d at every frequency, and the device falls over."""
    box = {"P.spring_damper.stiffness": (-80.0, -20.0), "M.inertia": (0.1, 0.2)}
    claim = claim_over_intervals(held(stiffness=-50.0), box, points=4)
    assert claim.status == "refuted" and claim.margin == -np.inf and claim.unit == "N s/m"
    assert math.isnan(claim.proved_margin) and claim.at_worst.holds is False
    assert str(claim.at_worst.verdict) == claim.how
    box["P.spring_damper.stiffness"] = (-80.0, 20.0)  # a spring at one end alone
    assert claim_over_intervals(held(), box, points=4).status == "refuted"


@pytest.mark.slow
def test_a_damper_beside_a_filtered_spring_adds_to_that_of_the_body():
    """Its damper reads the velocity, its spring a filtered position."""
    law = controller("spring_damper", {"stiffness": 0.0, "damping": 1.0})
    low_pass = controller("low_pass", {"bandwidth": 5.0})
    diagram = Diagram(
        "filtered",
        (
            Moving("M", body(0.15, viscous__damping=2.0), "x", "u", {"f": 1}, "f"),
            Control("Q", low_pass, "x", "y"),
            Control("C", law, "y", "F", "x"),
        ),
        (Junction("u", {"F": -1}),),
        {"f": "force"},
        (),
    )
    box = {"C.spring_damper.damping": (0.5, 5.0)}
    claim = claim_over_intervals(diagram, box, points=2)
    assert claim.status == "proved" and claim.unit == "N s/m" and claim.certificates
    assert 2.4 < claim.proved_margin <= 2.5 and claim.at_worst.holds
    assert claim.margin == pytest.approx(2.5, rel=1e-3)
    assert claim.worst["C.spring_damper.damping"] == 0.5 and claim.time == "continuous"
