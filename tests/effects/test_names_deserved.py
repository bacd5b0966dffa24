"""Up to which values a parameter means what its effect's name says, each limit from both sides."""

from math import inf, pi
from types import SimpleNamespace

import numpy as np
import pytest

from teleopdesign.effects import EFFECTS, Parameter, RecordFacts, make_structure
from teleopdesign.effects._facts import follows_gravity, repeats_within_travel, slip_is_observable

#: beside a tip on a spring of 100 N m/rad
BODY = {"inertia": 0.5, "coulomb.level": 1.0, "transmission_compliance.stiffness": 100.0}


def facts(**changed):
    """Records in which a body of 0.5 kg m^2 turned to and fro, between -1 and 1 rad."""
    known = {
        "travel": 2.0,
        "sweep": 2.0,
        "step": 0.01,
        "stroke": 0.5,
        "force": 8.0,
        "speed": 4.0,
        "film": 2.0,
    }
    places = np.linspace(-1.0, 1.0, 401)
    known |= {"axis": "revolute", "body": BODY, "duration": 10.0, "places": places, "acting": 8.0}
    return RecordFacts(**known | {"speeds": 4.0 * np.cos(np.pi * places / 2)} | changed)


def objection_to(name, what, values, **changed):
    """What the effect says of such values: None, or why they do not deserve its name."""
    return getattr(EFFECTS[name], what)(SimpleNamespace(**values), facts(**changed))


MORE, LESS = 1.0 + 1e-9, 1.0 - 1e-9
HUM = 400.0 / (2 * pi * 50.0) ** 2  # kg m^2 that rings at 50 Hz on a spring of 400 N m/rad
TONE = 0.2 * 400.0 / (2 * pi * 50.0)  # N m s/rad: a damping ratio of a tenth of it
RINGS = {"stiffness": 400.0, "damping": 0.0}
SWINGS = {"stiffness": 100.0, "damping": 1.0}
HEAVY = {"stiffness": 400.0, "tip_inertia": 0.25}
AT_HUM = {"stiffness": 400.0, "tip_inertia": HUM}
AT_THE_END = {"centre": 1.0}
GAP = {"stiffness": 8.0, "gap": 0.01, "tip_inertia": 0.1}

#: effect, parameter, value that keeps the name, one that loses it, other values, words of why
DESERVED = [
    ("cogging", "period", 2.0 / 1.5, MORE * 2.0 / 1.5, {}, "does not repeat"),
    ("cogging", "period", -1.3, -1.4, {}, "a period of 1.4 rad"),
    ("torque_ripple", "period", 1.3, 1.4, {}, "does not repeat"),
    ("cogging_harmonic", "period", 1.3, 1.4, {}, "does not repeat"),
    # half of the gain is left one radian away, then none
    ("position_dependent_gain", "fall", LESS * 0.25, 0.25, AT_THE_END, "negative beyond"),
    ("position_dependent_gain", "centre", 1.0, MORE, {"fall": 0.1}, "to one side only"),
    # a bristle gives by level / stiffness: 0.005 rad are half a step, 2 rad the travel
    ("presliding", "stiffness", 199.0, 200.0, {}, "sgn friction"),
    ("presliding", "stiffness", 0.501, 0.5, {}, "imitates a spring"),
    ("tip_friction", "level", 0.25, LESS * 0.25, {}, "below the step of 0.01 rad"),
    ("tip_friction", "level", 100.0, MORE * 100.0, {}, "more than the travel"),
    ("coulomb_asymmetry", "half_difference", 1.0, MORE, {}, "constant force"),
    ("coulomb_asymmetry", "half_difference", -1.0, -MORE, {}, "constant force"),
    ("viscous_asymmetry", "half_difference", 0.5, MORE * 0.5, {}, "at 4 rad/s"),
    ("viscous_asymmetry", "half_difference", -0.5, -0.51, {}, "the difference, 0.51 N"),
    ("viscous_temperature", "coefficient", 0.0, -1e-9, {}, "no lubricant"),
    (
        "friction_drift",
        "time_constant",
        1.0,
        LESS,
        {"fraction": 0.5},
        "one cycle of the motion, 1 s",
    ),
    ("friction_drift", "fraction", LESS * 0.95, 0.95, {"time_constant": 1.0}, "nearly all"),
    ("gravity", "amplitude", -8.0, -MORE * 8.0, {"phase": 0.0}, "a torque of 8 N"),
    ("hardening_spring", "neutral", 1.0, MORE, {}, "beyond all"),
    ("hardening_spring", "neutral", -1.0, -MORE, {}, "beyond all"),
    # 4 rad/s to the power of the exponent, which counts up to one
    ("shear_thinning", "drag", 4.0, 4.01, {"exponent": 0.5}, "8.02 N"),
    ("shear_thinning", "drag", 2.0, 2.01, {"exponent": 1.5}, "8.04 N"),
    ("transmission_compliance", "tip_inertia", LESS * 0.5, 0.5, SWINGS, "no part"),
    # critical: 2 sqrt(400 N m/rad 0.25 kg m^2)
    ("transmission_compliance", "damping", LESS * 20.0, 20.0, HEAVY, "damping ratio of 1 creeps"),
    ("backlash", "gap", 0.01, LESS * 0.01, GAP, "no linear spring"),
    ("backlash", "tip_inertia", 0.49, 0.5, GAP, "no part"),
]
#: the same of what the records cannot tell
CASES = [
    ("friction_drift", "time_constant", 10.0, 10.5, {"fraction": 0.21}, "= 0.02 1/s"),
    ("stribeck", "extra_static_level", 7.0, 7.1, {"stribeck_velocity": 0.1}, "8.1 N"),
    ("transmission_compliance", "tip_inertia", HUM / 0.949**2, HUM / 0.951**2, RINGS, "47.5 Hz"),
    ("transmission_compliance", "tip_inertia", HUM / 1.27**2, HUM / 1.25**2, RINGS, "the 60 Hz"),
    ("transmission_compliance", "damping", MORE * TONE, LESS * TONE, AT_HUM, "50 Hz"),
]


@pytest.mark.parametrize(
    ("name", "parameter", "keeps", "loses", "others", "words", "what"),
    [(*row, "plausible") for row in DESERVED] + [(*row, "undetermined") for row in CASES],
)
def test_an_effect_keeps_its_name_up_to_the_limit_and_loses_it_beyond(
    name, parameter, keeps, loses, others, words, what
):
    assert objection_to(name, what, {**others, parameter: keeps}) is None
    assert words in objection_to(name, what, {**others, parameter: loses})


def test_where_the_motion_never_turns_round_no_loop_and_no_cycle_is_there():
    assert "never reverses" in objection_to(
        "presliding", "plausible", {"stiffness": 10.0}, stroke=inf
    )
    assert (
        objection_to(
            "friction_drift", "plausible", {"fraction": 0.5, "time_constant": 0.1}, stroke=inf
        )
        is None
    )


@pytest.mark.parametrize("name", ["presliding", "maxwell_slip"])
def test_one_reversal_closes_no_loop(name):
    """A slow sweep of a wrist and part of its way back got two false names of friction."""
    bristles = {f"stiffness_{k}": 10.0 for k in range(1, 5)} | {
        f"level_{k}": 0.1 for k in (2, 3, 4)
    }
    values = bristles if name == "maxwell_slip" else {"stiffness": 10.0}
    assert "no loop closes" in objection_to(name, "plausible", values, reversals=1)
    assert objection_to(name, "plausible", values, reversals=2) is None


def test_nothing_is_reported_where_nothing_can_be_held_against_the_records():
    assert objection_to("presliding", "plausible", {"stiffness": 0.0}) is None, (
        "there is no bristle"
    )
    no_tip = {"inertia": 0.5, "coulomb.level": 1.0}
    assert objection_to("tip_friction", "plausible", {"level": 0.1}, body=no_tip) is None
    nowhere = np.zeros(0)
    assert objection_to("hardening_spring", "plausible", {"neutral": 9.0}, places=nowhere) is None


def test_one_deflection_within_the_travel_is_enough():
    assert slip_is_observable("it", [0.001, 1.0], facts()) is None
    assert "spring" in slip_is_observable("it", [0.001, 2.0], facts())
    assert "sgn friction" in slip_is_observable("it", [0.001, 0.005], facts())
    assert "sgn friction" in slip_is_observable("it", [], facts())
    assert repeats_within_travel(SimpleNamespace(period=1.0), facts()) is None


@pytest.mark.parametrize("name", ["cogging", "cogging_harmonic", "torque_ripple"])
def test_a_period_must_be_two_steps_long_and_repeat_within_the_travel(name):
    """Steps of 0.01 rad over a travel of 2 rad."""
    assert "errors of the readings" in objection_to(name, "plausible", {"period": 0.02 * LESS})
    assert objection_to(name, "plausible", {"period": 0.02 * MORE}) is None
    assert objection_to(name, "plausible", {"period": 2.0 / 1.5 * LESS}) is None
    assert "does not repeat" in objection_to(name, "plausible", {"period": 2.0 / 1.5 * MORE})


@pytest.mark.parametrize(
    "name", ["cogging", "cogging_harmonic", "torque_ripple", "position_dependent_friction"]
)
def test_a_period_must_repeat_where_the_body_is_slow_enough_to_show_it(name):
    """A sine of 1 rad at 0.5 Hz reaches 3.1 rad/s; a bandwidth of 5 Hz shows 0.1 rad at 0.5 rad/s.

    From its turning points it gets this fast within 0.013 rad.
    """
    time = np.arange(0.0, 20.0, 0.01)
    places, speeds = np.sin(np.pi * time), np.pi * np.cos(np.pi * time)
    values = {"amplitude": 0.5, "phase": 0.3, "period": 0.1}
    sine = {"places": places, "speeds": speeds, "resolved": 0.1}
    assert "is not seen to repeat" in objection_to(name, "plausible", values, **sine)
    # over a period of 1 rad it gets no faster than the bandwidth shows
    assert "seen to repeat" not in str(
        objection_to(name, "plausible", values | {"period": 1.0}, **sine)
    )
    # a slow run over two periods shows them
    slow = {
        "places": np.r_[places, np.linspace(0.0, 0.2, 401)],
        "speeds": np.r_[speeds, np.full(401, 0.05)],
    }
    assert objection_to(name, "plausible", values, **sine | slow) is None


def test_a_gap_ends_the_way_on_which_a_period_is_visible():
    """Two runs over 0.3 rad each that lie apart."""
    places = np.r_[np.linspace(-1.0, -0.7, 61), np.linspace(0.7, 1.0, 61)]
    apart = facts(places=places, speeds=np.full(122, 0.1), resolved=0.1)
    assert apart.visible_way(0.25) == pytest.approx(0.3)
    assert apart.visible_way(0.019) == 0.0, "too fast"
    assert apart.visible_way(0.021) == pytest.approx(0.3)
    assert apart.visible_way(np.inf) == pytest.approx(2.0)
    assert facts(places=np.zeros(0), speeds=np.zeros(0)).visible_way(0.1) == 0.0


def test_the_slowest_speed_is_that_of_a_hundredth_of_the_samples():
    speeds = np.r_[np.linspace(-1.0, -0.101, 900), np.linspace(0.1, 1.0, 901)]
    assert facts(speeds=speeds).slowest == pytest.approx(0.109, abs=1e-3)
    assert facts(speeds=np.zeros(0)).slowest == 0.0


def test_what_is_apart_from_speed_is_the_part_that_speed_does_not_tell():
    rng = np.random.default_rng(1)
    speed = rng.uniform(0.1, 1.0, 4000) * rng.choice([-1.0, 1.0], 4000)
    by_speed = facts(places=np.abs(speed), speeds=speed)
    # within a fortieth of the speeds a line varies by a fortieth: 1/1600 of the squares
    assert by_speed.apart_from_speed(lambda x: x) == pytest.approx(1 / 1600, rel=0.05)
    free = facts(places=rng.uniform(-1.0, 1.0, 4000), speeds=speed)
    assert free.apart_from_speed(lambda x: x) == pytest.approx(39 / 40, abs=0.02)
    assert free.apart_from_speed(np.ones_like) == 1.0, "nothing varies"
    few = facts(places=np.abs(speed[:399]), speeds=speed[:399])
    assert few.apart_from_speed(lambda x: x) == 1.0, "too few samples"
    assert facts(places=np.abs(speed[:400]), speeds=speed[:400]).apart_from_speed(np.sin) < 0.01


def test_bend_is_what_no_line_has():
    assert facts().bend(lambda x: 3.0 * x + 1.0) == pytest.approx(0.0, abs=1e-12)
    assert facts().bend(lambda x: x**2) == pytest.approx(1.0)
    # of x + x^2 the line has 1/3, the bend 4/45 of the squares
    assert facts().bend(lambda x: x + x**2) == pytest.approx((4 / 19) ** 0.5, rel=0.02)
    assert facts(places=np.array([0.0, 1.0])).bend(np.sin) == 1.0
    assert facts(places=np.array([0.0, 1.0, 2.0])).bend(np.sin) < 1.0
    assert facts(places=np.full(9, 0.3)).bend(np.sin) == 1.0


def test_three_places_tell_whether_friction_follows_the_torque_of_gravity():
    body = {"gravity.phase": 0.0}

    def objection_at(places):
        return follows_gravity(lambda x: 1.0 + np.abs(np.sin(x)), facts(body=body, places=places))

    assert "load_dependent_friction" in objection_at(np.array([0.1, 0.5, 1.2]))
    assert objection_at(np.array([0.1, 0.5])) is None


def test_a_structure_declares_neither_a_linear_form_nor_what_it_does_with_energy_by_itself():
    effect = make_structure(
        coupling=lambda now, p: p.stiffness * now.stretch,
        parameters={
            "tip_inertia": Parameter("inertia", "of the tip"),
            "stiffness": Parameter("stiffness", "of the coupling"),
        },
    )
    assert not effect.linear and effect.energy == "supplies"
    assert effect.corrections() == {} and effect.led_momentum() == 0, "the tip runs free"
    assert "no part" in effect.plausible(SimpleNamespace(tip_inertia=0.5), facts())


def test_a_gain_over_the_place_has_no_name_where_each_place_was_passed_at_one_speed():
    values = {"fall": 0.1, "centre": 0.0}
    assert "one speed only" in objection_to("position_dependent_gain", "plausible", values)
    apart = np.random.default_rng(0).uniform(-4.0, 4.0, 401)
    assert objection_to("position_dependent_gain", "plausible", values, speeds=apart) is None
    assert objection_to("position_dependent_gain", "plausible", values, places=np.zeros(0)) is None
