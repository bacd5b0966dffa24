"""Claims over intervals of values: never proved where a sample of the box shows the contrary."""

from fractions import Fraction

import control as ct
import numpy as np
import pytest
import sympy as sp
from devices import body
from passivity.interval_boxes import DIAGRAMS, HAND, failure, random_case

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import (
    Control,
    Diagram,
    Junction,
    Moving,
    four_channel,
    haptic_interface,
)
from teleopdesign.passivity import claim_over_intervals
from teleopdesign.passivity.intervals.box import box_of
from teleopdesign.passivity.intervals.linear import states_over
from teleopdesign.passivity.intervals.over_box import _rest_is_passive
from teleopdesign.passivity.linear.family import family_at
from teleopdesign.passivity.ports import ports


def attack(seed, *names):
    """The claim over a random box, and the lowest that 60 points of it show by other formulas."""
    rng = np.random.default_rng(seed)
    name, diagram, box, claim = random_case(rng, *names)
    answer = claim_over_intervals(diagram, box, claim=claim)
    lowest = np.inf
    for k in range(60):
        share = rng.random(len(box)) if k % 3 else rng.integers(0, 2, len(box))
        ends = zip(box.items(), share, strict=True)
        point = {n: low + (high - low) * u for (n, (low, high)), u in ends}
        lowest = min(lowest, failure(name, {**diagram.values, **point}, claim))
    # 1e-9: rounding of roots and of margins, which are of the order of 1
    if answer.status == "proved":
        assert lowest > -1e-9, (seed, answer)
        if claim != "absolutely stable":
            assert lowest > answer.proved_margin * (1 - 1e-6) - 1e-9, (seed, answer)
    if answer.status == "refuted":
        assert failure(name, {**diagram.values, **answer.worst}, claim) < 1e-6, (seed, answer)
    return answer.status


@pytest.mark.slow
def test_no_random_box_that_is_proved_holds_a_point_where_it_fails():
    assert {attack(seed, "interface") for seed in range(3)} <= {"proved", "refuted"}


@pytest.mark.slow
def test_no_more_random_boxes_that_are_proved_hold_a_point_where_they_fail():
    statuses = [attack(seed) for seed in range(4, 14)]
    assert statuses.count("proved") >= 5 and "refuted" in statuses


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


def test_what_no_computer_samples_is_proved_in_any_time():
    side, spring = body(0.15, viscous__damping=2.0), body(0.1, spring__stiffness=100.0)
    diagram = td.haptic_interface(side, hand=spring)
    claim = claim_over_intervals(diagram, {"Z_M.inertia": (0.1, 0.2)})
    assert claim.known == "proved over the whole box"


def test_a_hand_is_no_part_of_what_is_passive():
    with pytest.raises(ModelError, match='holds a port, and no part of what is "passive"'):
        claim_over_intervals(DIAGRAMS["interface"], {"Z_H.inertia": (0.1, 0.2)})


def rubbing(level, stiffness):
    device = body(0.15, viscous__damping=1.0, coulomb__level=0.5, presliding__stiffness=2e4)
    law = td.controller("dahl", {"level": level, "stiffness": stiffness})
    return td.haptic_interface(device, hand=HAND, cancellation=law)


@pytest.mark.slow
def test_vertices_decide_how_much_friction_may_be_cancelled():
    inertia = {"Z_M.inertia": (0.1, 0.3)}
    claim = claim_over_intervals(rubbing(0.3, 1e4), {"C.dahl.level": (0.2, 0.4), **inertia})
    assert claim.status == "proved" and "vertices decide" in claim.how
    # 1e4^2 0.5 <= 2e4^2 f_D fails below f_D = 0.125 N
    claim = claim_over_intervals(rubbing(0.3, 1e4), {"C.dahl.level": (0.1, 0.4), **inertia})
    assert claim.status == "refuted" and claim.worst["C.dahl.level"] == 0.1
    assert claim.at_worst.record.replay() > 0
    # f_D <= f_C fails inside, where the level of friction is least
    varied = {"C.dahl.level": (0.2, 0.4), "Z_M.coulomb.level": (0.3, 0.6)}
    claim = claim_over_intervals(rubbing(0.3, 1e4), varied)
    assert claim.status == "refuted" and claim.worst["Z_M.coulomb.level"] == 0.3


@pytest.mark.parametrize("late", [False, True])
def test_of_a_late_rest_beside_friction_nothing_is_shown_over_a_box(late):
    """A rod that a spring holds, through an actuator with or without a dead time."""
    more = {"actuation_delay__delay": 1e-3} if late else {}
    device = body(0.3, viscous__damping=5.0, coulomb__level=0.5, **more)
    diagram = haptic_interface(device, position_loop=controller("gain", {"gain": 20.0}))
    box = box_of(diagram, {"Z_M.inertia": (0.2, 0.4)})
    assert _rest_is_passive(*box) is not late


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


@pytest.mark.slow
def test_a_delay_leaves_numbers_and_no_proof():
    values = {"stiffness": 100.0, "damping": 1.0, "bandwidth": 500.0}
    spring = td.controller("proportional_derivative", values)
    side, none = body(0.15, viscous__damping=8.0), td.controller("gain", {"gain": 0.0})
    channels = {"C_1": spring, "C_2": none, "C_3": none, "C_4": spring}
    diagram = four_channel(
        side, side, master_control=spring, slave_control=spring, channels=channels, delay=0.005
    )
    claim = claim_over_intervals(diagram, {"Z_m.inertia": (0.1, 0.2)}, points=4)
    assert claim.status != "proved" and np.isnan(claim.proved_margin)


@pytest.mark.parametrize(
    ("intervals", "words"),
    [
        ({"Z_M.inertio": (0.1, 0.2)}, 'did you mean "Z_M.inertia"'),
        ({"Z_M.inertia": (0.2, 0.1)}, "expected finite low <= high"),
        ({"Z_M.inertia": (0.2, float("inf"))}, "expected finite low <= high"),
    ],
)
def test_an_interval_that_is_none_is_refused(intervals, words):
    with pytest.raises(ModelError, match=words):
        claim_over_intervals(DIAGRAMS["interface"], intervals)


def test_an_interval_without_width_is_a_value():
    claim = claim_over_intervals(DIAGRAMS["interface"], {"Z_M.inertia": (0.2, 0.2)}, claim="stable")
    assert claim.status == "proved" and claim.worst == {"Z_M.inertia": 0.2} and claim.points == 1


GROWS, ENDS = ([1.0], [1.0, -1.0]), ([1.0, -1.0], [1.0, 1.0])


@pytest.mark.parametrize("within", [False, True], ids=["between two blocks", "within one"])
def test_nothing_is_proved_over_a_box_in_which_a_hidden_mode_grows(within):
    """A pole at 1 1/s that a zero cancels: at the port, a spring behind a low-pass."""
    first, second = (from_control(ct.tf(*ratio), name="law") for ratio in (GROWS, ENDS))
    laws = [first.then(second)] if within else [first, second]
    names = ["x", *(f"y{k}" for k in range(len(laws)))]
    controls = [Control(f"C{k}", law, names[k], names[k + 1], "x") for k, law in enumerate(laws)]
    device = Moving("M", body(0.15, viscous__damping=2.0), "x", "u", {"f": 1}, "f")
    minus = Junction("u", {names[-1]: -1})
    diagram = Diagram("hidden", (device, *controls), (minus,), {"f": "force"}, ())
    box = {"M.inertia": (0.1, 0.3)}
    assert claim_over_intervals(diagram, box).status == "unknown"
    assert claim_over_intervals(diagram, box, claim="stable").status == "refuted"


@pytest.mark.slow
def test_a_damper_along_another_motion_is_proved_by_one_family():
    """Its spring reads a filtered position, its damper the velocity now: two forms of one value."""
    damper = td.controller("spring_damper", {"stiffness": 0.0, "damping": 1.0})
    low_pass = td.controller("low_pass", {"bandwidth": 5.0})
    device = Moving("M", body(0.15, viscous__damping=2.0), "x", "u", {"f": 1}, "f")
    controls = (Control("Q", low_pass, "x", "y"), Control("C", damper, "y", "F", "x"))
    minus = Junction("u", {"F": -1})
    diagram = Diagram("damped", (device, *controls), (minus,), {"f": "force"}, ())
    claim = claim_over_intervals(diagram, {"C.spring_damper.damping": (0.0, 5.0)}, points=4)
    assert claim.status == "proved" and claim.margin == pytest.approx(2.0, rel=1e-3)
    claim = claim_over_intervals(diagram, {"C.spring_damper.damping": (-5.0, 5.0)}, points=4)
    assert claim.status == "refuted"


def test_what_a_varied_block_cancels_inside_counts_as_a_mode():
    """1/(s - 1), then (s - 1)/(s + 2), then the gain that is varied: a pole no port shows."""
    grows = from_control(ct.tf([1.0], [1.0, -1.0]), name="one")
    hides = from_control(ct.tf([1.0, -1.0], [1.0, 2.0]), name="two")
    law = grows.then(hides).then(controller("gain", {"gain": 0.1}))
    diagram = haptic_interface(body(0.3, viscous__damping=2.0), force_feedback=law)
    box = {"H.gain.gain": (0.1, 0.2)}
    p = states_over(*box_of(diagram, box)).determinant()
    assert p.rem([p.ring.gens[0] - 1]) == 0
    assert claim_over_intervals(diagram, box).status == "unknown"


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


def test_a_port_that_nothing_resists_has_the_impedance_zero():
    diagram = haptic_interface(body(0.0))
    assert family_at(diagram, ports(diagram)).z == sp.zeros(1)


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


def test_an_interval_may_be_of_fractions():
    box = {"Z_M.inertia": (Fraction(1, 3), Fraction(1, 2))}
    claim = claim_over_intervals(haptic_interface(body(0.3, viscous__damping=2.0)), box)
    assert claim.status == "proved" and "0.3333333333333333 to 0.5" in claim.statement
