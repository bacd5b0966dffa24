"""Tuning: the best of the points that were tried, within limits that are checked once more."""

import numpy as np
import pytest
from devices import body

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.passivity import claim_over_intervals
from teleopdesign.tuning.trade_off import select_unbeaten

LAW = td.controller("low_pass", {"bandwidth": 20.0}).then(td.controller("gain", {"gain": 0.2}))
LOOP = td.haptic_interface(body(0.15, viscous__damping=4.0), force_feedback=LAW)
PARAMETERS = {"H.gain.gain": (0.05, 20.0), "H.low_pass.bandwidth": (2.0, 50.0)}


def gain(diagram):
    """A measure without simulation."""
    return diagram.values["H.gain.gain"]


def less_gain(diagram):
    return -gain(diagram)


def most_gain(inertia, damping, bandwidth):
    """Largest passive gain of (m s + b)/(1 + g/(1 + s/a)): Re Z >= 0 at every frequency.

    Z = (m s + b)(s + a)/(s + a (1 + g)); its real part times abs(below)^2 is, with x = w^2,
    (a b - m x) a (1 + g) + x (b + a m), so that g <= b/(a m) is what it takes
    """
    return damping / (2 * np.pi * bandwidth * inertia)


def test_the_most_force_feedback_that_is_passive_is_where_algebra_has_it():
    most = {"H.gain.gain": (0.01, 5.0)}
    tuned = td.tune(LOOP, most, less_gain, subject_to=["passive"], evaluations=80)
    assert tuned.keeps_limits
    limit = most_gain(0.15, 4.0, 20.0)
    # within 1 % from below: the simplex stops at a step of 1e-4 of the interval
    assert 0.99 * limit < tuned.values["H.gain.gain"] <= limit * (1 + 1e-9)
    (passive,) = tuned.limits
    assert passive.active and passive.how == "proved at this point (in continuous time)"
    assert "best found of" in repr(tuned) and "optim" not in repr(tuned)


@pytest.mark.slow
def test_a_limit_over_intervals_holds_at_the_worst_hand_and_device():
    over = {"Z_M.inertia": (0.1, 0.2), "Z_M.viscous.damping": (3.0, 6.0)}
    tuned = td.tune(
        LOOP,
        {"H.gain.gain": (0.01, 5.0)},
        less_gain,
        subject_to=[td.limit("passive", over=over)],
        evaluations=80,
    )
    limit = most_gain(0.2, 3.0, 20.0)
    assert 0.99 * limit < tuned.values["H.gain.gain"] <= limit * (1 + 1e-9)
    assert tuned.limits[0].how == "proved over the whole box (in continuous time)"
    assert claim_over_intervals(tuned.diagram, over).status == "proved"


def load(diagram):
    """A measure that depends on what is tuned and on what is not known."""
    return diagram.values["H.gain.gain"] * diagram.values["Z_M.inertia"]


@pytest.mark.slow
def test_a_measure_over_intervals_is_bounded_at_its_worst_value():
    heavy = td.limit(load, most=0.3, over={"Z_M.inertia": (0.1, 0.2)})
    most = {"H.gain.gain": (0.05, 4.0)}
    tuned = td.tune(LOOP, most, less_gain, subject_to=[heavy], evaluations=60)
    assert tuned.keeps_limits and tuned.values["H.gain.gain"] == pytest.approx(1.5, rel=0.01)
    (checked,) = tuned.limits
    assert checked.worst == {"Z_M.inertia": 0.2} and checked.how.startswith("checked numerically")


def test_where_no_point_keeps_the_limits_the_answer_says_so():
    limits = [td.limit(gain, most=0.01)]
    tuned = td.tune(LOOP, {"H.gain.gain": (0.05, 1.0)}, gain, subject_to=limits, evaluations=20)
    assert not tuned.keeps_limits and "keeps all limits" in repr(tuned)


@pytest.mark.slow
def test_trade_offs_are_points_that_no_other_one_beats_in_both():
    rows = np.array([[1.0, 3.0], [2.0, 2.0], [2.0, 2.5], [3.0, 1.0], [3.5, 1.0]])
    assert select_unbeaten(rows) == [0, 1, 3]

    def slow(diagram):
        return 1 / diagram.values["H.low_pass.bandwidth"]

    front = td.trade_off(
        LOOP, PARAMETERS, [less_gain, slow], subject_to=["passive"], evaluations=120, points=5
    )
    assert 2 < len(front.points) <= 5 and front.dropped == 0
    assert (np.diff(front.objectives[:, 0]) > 0).all()
    assert (np.diff(front.objectives[:, 1]) < 0).all()
    for point in front.points:  # none is beyond what algebra allows: g a <= b/m
        values = point.values
        bound = most_gain(0.15, 4.0, values["H.low_pass.bandwidth"])
        assert values["H.gain.gain"] <= bound * (1 + 1e-9)
    axes = front.plot().axes[0]
    assert axes.get_xlabel() == "less gain (1)" and len(axes.lines) == 4


@pytest.mark.slow
def test_a_simulated_error_falls_while_all_limits_are_kept():
    tuned = td.tune(
        LOOP,
        PARAMETERS,
        "force_error",
        subject_to=["passive", td.limit(td.measure("peak", signal="R_FF"), most=1.0)],
        duration=0.5,
        motion={"L": td.sine(amplitude=0.01, frequency=4.0)},
        evaluations=60,
    )
    assert tuned.objective < 0.9 * tuned.before
    assert tuned.unit == "N"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"parameters": {"H.gain.gian": (0, 1)}}, "no parameter"),
        ({"parameters": {"H.gain.gain": (1.0, 1.0)}}, "expected \\(low, high\\)"),
        ({"objective": ["force_error", gain]}, "see `trade_off`"),
        ({"subject_to": ["force_error"]}, "expected least or most"),
        (
            {"subject_to": [td.limit("passive", over={"H.gain.gain": (0, 1)})]},
            "also in the intervals of passive",
        ),
    ],
)
def test_what_cannot_be_tuned_is_refused_in_one_line(arguments, words):
    whole = {"parameters": {"H.gain.gain": (0.1, 1.0)}, "objective": gain, **arguments}
    with pytest.raises(ModelError, match=words):
        td.tune(LOOP, **whole)


def test_a_limit_that_is_missed_is_not_called_active():
    """No gain of the interval is passive: the nearest point lies at the bound and misses it."""
    limit = most_gain(0.15, 4.0, 20.0)
    low = 1.001 * limit
    tuned = td.tune(LOOP, {"H.gain.gain": (low, 50 * low)}, less_gain, subject_to=["passive"],
                    evaluations=40)  # fmt: skip
    (passive,) = tuned.limits
    assert not tuned.keeps_limits and not passive.holds
    assert not passive.active and tuned.active == () and repr(passive).startswith("missed")


@pytest.mark.slow
def test_a_loop_with_margins_is_stable_in_its_computer():
    """Force feedback behind a low-pass: in continuous time no gain of it is too large."""
    device = td.hand(mass=0.15, damping=4.0, stiffness=0.0)
    feedback = td.controller("low_pass", {"bandwidth": 50.0})
    feedback = feedback.then(td.controller("gain", {"gain": 1.0}))
    hand = td.hand(mass=1.0, damping=1.0, stiffness=50.0)
    tuned = td.tune(
        td.haptic_interface(device, force_feedback=feedback, hand=hand),
        {"H.gain.gain": (0.5, 20.0)},
        "force_error",
        duration=0.3,
        inputs={"R_D": 0.0, "R_V": lambda t: np.sin(12 * t)},
        evaluations=10,
        subject_to=[td.limit("gain margin", least=2.0)],
    )
    assert 1.0 < tuned.values["H.gain.gain"] < 6.0
    run = td.simulate_diagram(tuned.diagram, duration=1.0, inputs={"R_V": 0.01})
    assert abs(run["R_A"].values).max() < 0.1
