"""A claim about a device counts every effect that the device has, and says over which reach."""

import pytest

import teleopdesign as td
from teleopdesign.controllers import Controller, controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import EFFECTS
from teleopdesign.passivity.device_claims import margins
from teleopdesign.passivity.friction_pairs import friction_pairs, pair_claims
from teleopdesign.passivity.identified import DIGITS, identify_device
from teleopdesign.passivity.theorems import Question, Wall, settle
from teleopdesign.realise.friction_interval import friction_interval
from teleopdesign.realise.reach import Reach
from teleopdesign.simulate import Sampling

REACH = Reach(
    low=-0.05, high=0.05, peak_speed=0.3, rms_speed=0.1, command=3.0, duration=10.0,
    sample_period=1e-3, step=5e-6, unresolved=2e-5, measures_force=True,
)  # fmt: skip


def body_of(**more):
    """A body of 0.1 kg with 0.5 N of friction and these effects, name -> parameters."""
    body = td.Body("prismatic", {"inertia": td.Value(0.1)})
    for name, values in {"coulomb": {"level": 0.5}, **more}.items():
        body = body.with_effect(EFFECTS[name], values)
    return body


def dahl(level, stiffness):
    (stage,) = td.controller("dahl", {"level": level, "stiffness": stiffness}).stages
    return stage


def claims_on(body, level=0.4, stiffness=1e4, reach=None):
    """Topic -> claim about a Dahl compensator, by theorems."""
    question = Question(identify_device(body, reach), dahl(level, stiffness))
    claims = settle(question, simulated=False)
    return {s.topic: s.claim for s in claims}


def statuses(body, **arguments):
    return {topic: claim.status for topic, claim in claims_on(body, **arguments).items()}


SLOPE = {"stribeck": {"extra_static_level": 0.2, "stribeck_velocity": 0.01}}
GAP = {"tip_inertia": 0.02, "stiffness": 1e4, "damping": 1.0, "gap": 1e-3}
BRISTLE = {"stiffness": 2e4, "bristle_damping": 30.0}


def test_bristle_damping_below_a_falling_level_is_not_dropped():
    """The device alone gives out energy in jumps of speed: no pair with it can be proved."""
    body = body_of(**SLOPE, presliding=BRISTLE)
    (claim,) = settle(Question(identify_device(body)))
    assert claim.claim.status == "refuted"
    assert claim.claim.record.replay() > 0
    claims = claims_on(body)
    assert claims["estimate"].status == claims["95 % interval"].status == "unknown"
    assert "bristle damping may release energy" in str(claims["estimate"].verdict)
    assert list(margins(identify_device(body))) == []


@pytest.mark.parametrize(
    ("effect", "values", "ideal", "gives"),
    [
        ("viscous", {"damping": 2.0}, "proved", "proved"),
        ("cogging", {"amplitude": 0.2, "period": 0.01, "phase": 0.0}, "proved", "proved"),
        ("backlash", GAP, "proved", "proved"),
        ("actuation_delay", {"delay": 2e-3}, "proved", "unknown"),
        ("actuator_lag", {"time_constant": 2e-3}, "proved", "unknown"),
        ("actuator_gain", {"gain": 1.2}, "proved", "unknown"),
        ("actuator_gain", {"gain": 1.3}, "refuted", "unknown"),
        ("torque_ripple", {"amplitude": 0.3, "period": 0.01, "phase": 0.0}, "refuted", "unknown"),
    ],
)  # fmt: skip
def test_an_effect_that_may_supply_energy_leaves_a_claim_open(effect, values, ideal, gives):
    """Beside ideal friction any law within the level that acts is covered, late or not."""
    claims = statuses(body_of(**{effect: values}))
    assert claims["any law within the level"] == ideal
    claims = statuses(body_of(**{effect: values}, presliding={"stiffness": 2e4}))
    assert claims["estimate"] == claims["95 % interval"] == gives


def test_damping_of_one_direction_counts_against_that_of_the_other():
    asymmetric = {"viscous_asymmetry": {"half_difference": -0.5}}
    device = identify_device(body_of(viscous={"damping": 2.0}, **asymmetric))
    assert device.set_aside == ()
    assert device.damping.low == pytest.approx(1.5)
    # alone it pushes one way
    body = body_of(viscous={"damping": 0.2}, **asymmetric)
    assert identify_device(body).set_aside == ("viscous_asymmetry",)
    assert statuses(body)["any law within the level"] == "unknown"
    question = Question(
        identify_device(body), wall=Wall(100.0, 0.0), computer=Sampling(period=1e-4)
    )
    (wall,) = settle(question)
    assert wall.claim.status == "unknown"


@pytest.mark.slow
def test_design_and_passivity_have_one_interval():
    """Stribeck and a wave along the travel, a period that is not known well."""
    body = body_of(
        **SLOPE, position_dependent_friction={"amplitude": 0.2, "period": 0.05, "phase": 0.3}
    ).with_values({"position_dependent_friction.period": td.Value(0.05, stderr=0.002)})
    device = identify_device(body, REACH)
    same = friction_interval(body, REACH, errors=1.96)
    for name in ("lowest", "highest"):  # with the digits of claims, outward
        assert getattr(device, name) == getattr(same, name).round_outward(digits=DIGITS)
    # 0.4 N by hand; what is guaranteed is a hair less, and rounded outward
    assert device.lowest.low == pytest.approx(0.4, rel=3e-4) and device.lowest.low <= 0.4
    claim = claims_on(body, level=0.3, reach=REACH)["any law within the level"]
    assert claim.status == "proved"
    assert "levels over speed 0 to 3 m/s, position -0.05 to 0.05 m" in claim.statement
    assert (
        "levels over any speed, any position"
        in claims_on(body)["any law within the level"].statement
    )


@pytest.mark.parametrize("slope", [{}, SLOPE])
@pytest.mark.parametrize("level", [0.3, 0.45])
def test_a_claim_is_proved_up_to_the_stated_limit_and_no_further(slope, level):
    body = body_of(**slope, presliding={"stiffness": 2e4, "bristle_damping": 0.0})
    device = identify_device(body)

    def is_proved(level, stiffness):
        return claims_on(body, level, stiffness)["95 % interval"].status == "proved"

    limits = {m.text.partition(" at ")[0]: m.value for m in margins(device, dahl(level, 1.5e4))}
    softest = limits["largest sigma_D"]
    assert is_proved(level, softest) and not is_proved(level, 1.01 * softest)
    least = limits["least f_D"]
    if least < 0.5:
        assert is_proved(least, 1.5e4)
    assert not is_proved(0.99 * least, 1.5e4)
    largest = margins(device)[1].value
    assert is_proved(largest, 1e3) and not is_proved(1.01 * largest, 1e3)


@pytest.mark.parametrize("gain", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("first", [True, False])
def test_a_cancellation_of_several_stages_is_not_judged_by_one_of_them(gain, first):
    """A Dahl law of 0.4 N behind a gain of two drives friction of 0.5 N."""
    dahl = controller("dahl", {"level": 0.4, "stiffness": 1e4})
    more = controller("gain", {"gain": gain})
    stages = (*dahl.stages, *more.stages) if first else (*more.stages, *dahl.stages)
    body = body_of(presliding={"stiffness": 2e4, "bristle_damping": 0.0})
    (alone,) = friction_pairs(haptic_interface(body, cancellation=dahl))
    assert [one.claim.status for one in pair_claims(alone)] == ["proved"]
    assert friction_pairs(haptic_interface(body, cancellation=Controller(stages))) == []
