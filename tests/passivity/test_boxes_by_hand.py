"""Claims over boxes of devices whose answer is known in closed form; the search for the worst."""

import math

import control as ct
import numpy as np
import pytest
import sympy as sp
from devices import body
from passivity.interval_boxes import DIAGRAMS, HAND, failure

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import (
    Control,
    Diagram,
    Junction,
    Moving,
    haptic_interface,
)
from teleopdesign.passivity import claim_over_intervals


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


def test_hands_within_bounds_are_intervals_of_their_values():
    hands = {
        "Z_H.inertia": (0.05, 0.2),
        "Z_H.viscous.damping": (1.0, 10.0),
        "Z_H.spring.stiffness": (100.0, 600.0),
    }
    claim = claim_over_intervals(DIAGRAMS["interface"], hands, claim="stable")
    assert claim.status == "proved" and claim.known.startswith(
        "proved over the whole box (in continuous time)"
    )
    assert 0 < claim.proved_margin <= claim.margin
    # the slowest is the softest hand with the least damping, or the stiffest one with much mass
    assert claim.worst["Z_H.viscous.damping"] == 1.0
    strong = DIAGRAMS["interface"].with_values({"H.gain.gain": 5.0, "Z_M.inertia": 0.4})
    claim = claim_over_intervals(strong, hands, claim="stable")
    assert claim.status == "refuted"
    assert failure("interface", {**strong.values, **claim.worst}, "stable") < 0


def rubbing(level, stiffness):
    device = body(0.15, viscous__damping=1.0, coulomb__level=0.5, presliding__stiffness=2e4)
    law = td.controller("dahl", {"level": level, "stiffness": stiffness})
    return td.haptic_interface(device, hand=HAND, cancellation=law)


@pytest.mark.slow
def test_friction_that_is_proved_over_a_box_is_so_at_points_inside():
    rng = np.random.default_rng(3)
    statuses = []
    for _ in range(12):
        middle = {
            "C.dahl.level": rng.uniform(0.1, 0.6),
            "C.dahl.stiffness": rng.uniform(5e3, 2e4),
            "Z_M.coulomb.level": rng.uniform(0.3, 0.8),
            "Z_M.presliding.stiffness": rng.uniform(1e4, 4e4),
        }
        names = rng.choice(list(middle), 2, replace=False)
        box = {str(n): (0.9 * middle[n], 1.1 * middle[n]) for n in names}
        diagram = rubbing(0.3, 1e4).with_values(middle)
        claim = claim_over_intervals(diagram, box)
        statuses.append(claim.status)
        for _ in range(20):
            v = {**diagram.values, **{n: rng.uniform(*ends) for n, ends in box.items()}}
            level, friction = v["C.dahl.level"], v["Z_M.coulomb.level"]
            ratio = v["C.dahl.stiffness"] / v["Z_M.presliding.stiffness"]
            passive = level <= friction and ratio**2 * friction <= level
            assert passive or claim.status == "refuted"
    assert {"proved", "refuted"} <= set(statuses)


def test_what_no_exact_reasoning_covers_is_checked_numerically_and_says_so():
    def headroom(diagram):
        return 0.3 - diagram.values["Z_M.inertia"]

    device = DIAGRAMS["interface"]
    claim = claim_over_intervals(device, {"Z_M.inertia": (0.1, 0.25)}, claim=headroom, points=4)
    assert claim.status == "evidence"
    assert claim.known == f"checked numerically at {claim.points} points, worst found there"
    assert claim.margin == pytest.approx(0.05) and claim.worst == {"Z_M.inertia": 0.25}
    claim = claim_over_intervals(device, {"Z_M.inertia": (0.1, 0.4)}, claim=headroom, points=4)
    assert claim.status == "refuted" and claim.worst == {"Z_M.inertia": 0.4}
    assert "proved" not in repr(claim)


@pytest.mark.parametrize("hides", [False, True])
def test_a_mode_that_no_port_shows_has_a_certificate_beside_that_of_the_port(hides):
    """1/(s + 1), then (s + 1)/(s + 2): the mode at -1 dies out, and this must be certified, too."""
    lag = from_control(ct.tf([1.0], [1.0, 1.0]), name="one")
    undone = from_control(ct.tf([1.0, 1.0], [1.0, 2.0]), name="two")
    law = (lag.then(undone) if hides else lag).then(controller("gain", {"gain": 0.1}))
    diagram = haptic_interface(body(0.3, viscous__damping=2.0), position_loop=law)
    claim = claim_over_intervals(diagram, {"K.gain.gain": (0.1, 0.2)}, points=2)
    assert claim.status == "proved"
    kinds = [one.kind for one in claim.certificates]
    assert kinds == ["positive real over a box", *["stable over a box"] * hides]
    for one in claim.certificates:
        one.check()
    if hides:
        mode = sp.sympify(claim.certificates[1].content["polynomial"])
        assert mode.subs(sp.Symbol("s"), -1) == 0


BENT = {
    "cogging": ("amplitude", {"period": 0.01, "phase": 0.0}),
    "torque_ripple": ("amplitude", {"period": 0.01, "phase": 0.0}),
    "viscous_asymmetry": ("half_difference", {}),
    "bias": ("force", {}),
}


@pytest.mark.parametrize("name", BENT)
def test_an_effect_that_is_absent_in_the_middle_alone_is_not_left_out(name):
    """Evidence for -0.5 to 0.5 was that of 0, where there is no such effect."""
    value, others = BENT[name]
    values = {n: others.get(n, 0.0) for n in td.EFFECTS[name].parameters}
    device = body(0.3, viscous__damping=2.0).with_effect(td.EFFECTS[name], values)
    box = {f"Z_M.{name}.{value}": (-0.5, 0.5)}
    assert claim_over_intervals(haptic_interface(device), box).status == "unknown"
    with pytest.raises(ModelError, match=f"Z_M.{name} has no linear form"):
        claim_over_intervals(haptic_interface(device), box, claim="stable")


def test_a_margin_that_is_no_number_at_some_point_is_no_evidence():
    def margin(d):
        inertia = d.values["Z_M.inertia"]
        return np.nan if inertia > 0.2 else 1.0

    device = haptic_interface(body(0.15))
    for high, status, refuted in ((0.15, "evidence", "evidence"), (0.25, "unknown", "refuted")):
        box = {"Z_M.inertia": (0.1, high)}
        assert claim_over_intervals(device, box, claim=margin).status == status
        is_light = claim_over_intervals(device, box, claim=lambda d: margin(d) > 0)
        assert is_light.status == refuted
