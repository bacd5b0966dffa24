"""Claims over a box that are decided point by point: values in structures, claims of a user."""

import math
from dataclasses import replace

import control as ct
import pytest
from devices import body

from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import Control, Diagram, Junction, Moving, teleoperator
from teleopdesign.passivity import claim_over_intervals
from teleopdesign.passivity.claims.claim import Claim, Evidence, Proof, Refutation, Unknown
from teleopdesign.passivity.intervals import linear
from teleopdesign.passivity.intervals.box import box_of
from teleopdesign.passivity.intervals.worst import search_worst
from teleopdesign.passivity.linear.positive_real import positive_real
from teleopdesign.realise.lti import S

SOFT = {
    f"transmission_compliance__{n}": x
    for n, x in {"tip_inertia": 0.05, "stiffness": 400.0, "damping": 1.0}.items()
}
STIFFNESS = "M.transmission_compliance.stiffness"


def held(gain, **more):
    """A body on a transmission, at whose motor a law holds it with a spring."""
    device = body(0.2, viscous__damping=2.0, **SOFT, **more)
    law = controller("gain", {"gain": gain})
    return Diagram(
        "held",
        (
            Moving("M", device, "x", "u", {"f": 1}, "f"),
            Control("P", law, "x", "p", "x", analog=True),
        ),
        (Junction("u", {"p": -1}),),
        {"f": "force"},
        ("x",),
    )


@pytest.mark.slow
def test_values_of_a_structure_are_decided_at_points_and_nothing_is_proved():
    claim = claim_over_intervals(held(30.0), {STIFFNESS: (300.0, 500.0)}, points=1)
    assert claim.status == "evidence" and claim.holds
    assert "every point is decided by itself" in claim.how
    assert claim.points >= 3 and claim.at_worst.holds
    assert math.isnan(claim.proved_margin) and claim.unit == "N s/m"


@pytest.mark.slow
def test_of_values_of_a_structure_a_point_that_fails_refutes_and_is_named():
    """A motor that is pushed away from its place by more than 30 N/m releases energy."""
    claim = claim_over_intervals(held(-60.0), {STIFFNESS: (300.0, 500.0)}, points=0)
    assert claim.status == "refuted" and claim.holds is False
    assert claim.at_worst.status == "refuted" and 300.0 <= claim.worst[STIFFNESS] <= 500.0
    assert claim.how == str(claim.at_worst.verdict) and "wave" in claim.how


@pytest.mark.slow
@pytest.mark.parametrize(("stiffness", "status"), [(40.0, "evidence"), (-40.0, "refuted")])
def test_of_two_ports_the_claim_that_is_named_is_decided(stiffness, status):
    soft = body(0.2, viscous__damping=2.0, **SOFT)
    coupling = controller("spring_damper", {"stiffness": stiffness, "damping": 1.0})
    pair = teleoperator(soft, body(0.3, viscous__damping=2.0), coupling=coupling)
    (name,) = [n for n in pair.values if n.startswith("Z_m") and n.endswith("compliance.stiffness")]
    for claim, word in [
        ("passive", "together passive"),
        ("absolutely stable", "absolutely stable"),
    ]:
        made = claim_over_intervals(pair, {name: (300.0, 500.0)}, claim=claim, points=1)
        assert made.status == status
        assert f"its ports are {word}" in made.statement
        assert made.unit == {"passive": "N s/m", "absolutely stable": "1"}[claim]
        expected = "is absolutely stable" if claim == "absolutely stable" else "is passive"
        assert expected in made.at_worst.statement


INERTIA = {"M.inertia": (0.1, 0.3)}


def judged(verdict):
    """A claim over inertias; verdict: function of the inertia."""

    def of_mine(diagram):
        outcome = verdict(diagram.values["M.inertia"])
        return Claim("mine", outcome) if not isinstance(outcome, Claim | float) else outcome

    return claim_over_intervals(held(0.0), INERTIA, claim=of_mine, points=6)


PROOF = positive_real(S + 1).verdict


def test_the_least_margin_of_a_users_claims_is_that_of_the_box():
    claim = judged(lambda m: Evidence(True, "it swings", 1.0 - m, "W"))
    assert claim.status == "evidence" and claim.unit == "W"
    assert claim.margin == pytest.approx(0.7) and claim.worst == {"M.inertia": 0.3}
    assert claim.statement.startswith("held: of_mine holds, for all M.inertia 0.1 to 0.3")
    assert claim.how == "of_mine: nothing is proved"


def test_one_point_where_a_users_claim_fails_refutes_it():
    fails = Refutation("a wave", positive_real(S - 1).record)
    claim = judged(lambda m: fails if m > 0.25 else PROOF)
    assert claim.status == "refuted" and claim.worst["M.inertia"] > 0.25
    assert claim.margin == -math.inf
    # a margin that contradicts its verdict says nothing
    claim = judged(lambda m: Evidence(m < 0.25, "it swings", 0.5, "W"))
    assert claim.status == "refuted" and claim.margin == -math.inf
    claim = judged(lambda m: Evidence(True, "it swings", -0.5, "W"))
    assert claim.status == "evidence" and claim.margin == math.inf


def test_where_some_points_are_unknown_the_claim_is_unless_another_fails():
    claim = judged(lambda m: Unknown("no wave") if m > 0.25 else PROOF)
    assert claim.status == "unknown" and claim.holds is None
    number = int(claim.how.split()[2])
    assert claim.how == f"unknown at {number} points: {Unknown('no wave')}"
    assert 1 <= number < claim.points
    claim = judged(lambda m: Unknown("no wave") if m > 0.25 else -1.0 if m < 0.15 else 1.0)
    assert claim.status == "refuted" and claim.margin == -1.0
    assert claim.how == "of_mine is -1 there"
    assert judged(lambda m: math.nan).status == "refuted"
    assert judged(lambda m: 0.0).status == "evidence"
    assert judged(lambda m: PROOF).margin in (math.inf, pytest.approx(PROOF.margin))
    assert isinstance(PROOF, Proof)


def plain(gain, **more):
    """A rigid body that a law holds with a spring."""
    device = body(0.2, **more)
    law = controller("gain", {"gain": gain})
    blocks = (
        Moving("M", device, "x", "u", {"f": 1}, "f"),
        Control("P", law, "x", "p", "x", analog=True),
    )
    return Diagram("plain", blocks, (Junction("u", {"p": -1}),), {"f": "force"}, ("x",))


def test_a_claim_that_holds_everywhere_has_no_margin_below_zero_though_rounding_says_so(
    monkeypatch,
):
    """A lossless device has a margin of zero, give or take the last digit."""
    box = {"M.inertia": (0.1, 0.3), "P.gain.gain": (10.0, 30.0)}
    proved = claim_over_intervals(plain(20.0), box, points=4)
    assert proved.status == "proved" and proved.margin >= 0.0
    monkeypatch.setattr(linear, "is_shown", lambda *_: False)
    claim = claim_over_intervals(plain(20.0), box, points=4)
    assert claim.status == "evidence" and claim.margin >= 0.0
    assert claim.how.startswith("no proof over the whole box")
    monkeypatch.setattr(
        linear, "search_worst", lambda *a, **k: replace(search_worst(*a, **k), margin=-1e-18)
    )
    claim = claim_over_intervals(plain(20.0), box, points=4)
    assert claim.status == "evidence" and claim.margin == 0.0


def test_a_point_that_is_not_decided_leaves_the_box_open_and_says_why():
    """The law hides a mode that grows: from rest nothing shows it."""
    grows = from_control(ct.tf([1], [1, -1]), name="grows")
    cancels = from_control(ct.tf([1, -1], [1, 2]), name="cancels")
    whole = replace(
        plain(20.0, viscous__damping=2.0),
        blocks=(
            Moving("M", body(0.2, viscous__damping=2.0), "x", "u", {"f": 1}, "f"),
            Control("P", cancels.then(grows), "x", "p", "x", analog=True),
        ),
    )
    claim = claim_over_intervals(whole, {"M.inertia": (0.1, 0.3)}, points=4)
    assert claim.status == "unknown" and claim.holds is None
    assert claim.how == f"at the worst point of the search: {claim.at_worst.verdict}"
    assert "a mode that no port shows does not decay, at s = 1 1/s" in claim.how


def test_a_refuted_box_has_a_margin_below_zero():
    claim = claim_over_intervals(plain(20.0), {"P.gain.gain": (-30.0, 30.0)}, points=4)
    assert claim.status == "refuted" and claim.margin < 0.0
    assert claim.how == str(claim.at_worst.verdict) and claim.worst["P.gain.gain"] < 0.0


@pytest.mark.parametrize(
    ("claim", "status"),
    [pytest.param("passive", "refuted", marks=pytest.mark.slow), ("absolutely stable", "evidence")],
)
def test_of_two_ports_at_single_points_the_claim_that_is_named_is_decided(claim, status):
    """A force that follows the other body one way alone: it gives out energy, and never grows."""
    law = controller("gain", {"gain": 40.0})
    bodies = [
        Moving(f"M{k}", body(0.2, viscous__damping=2.0), f"x{k}", f"u{k}", {f"f{k}": 1}, f"f{k}")
        for k in (1, 2)
    ]
    blocks = (*bodies, Control("P", law, "x1", "p", "x1", analog=True))
    sums = (Junction("u1", {}), Junction("u2", {"p": 1}))
    pair = Diagram("one way", blocks, sums, {"f1": "force", "f2": "force"}, ("x1",))
    middle, box = box_of(pair, {"M1.inertia": (0.1, 0.3)})
    made = linear._point_by_point(middle, box, claim, 0, 0, "it is so")
    assert made["status"] == status and made["statement"] == "it is so"
    assert made["at_worst"].holds is (status == "evidence")
    assert ("absolutely stable" in made["at_worst"].statement) is (claim == "absolutely stable")
    assert made["unit"] == {"passive": "N s/m", "absolutely stable": "1"}[claim]
