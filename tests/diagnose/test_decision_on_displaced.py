"""When a candidate displaces an effect of the model, and when it is refused for that."""

import pytest
from diagnose.known_models import BY_EFFECT, model
from diagnose.stand_ins import SHAPE, fit, floor, ranked

from teleopdesign import Model
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.decision import (
    find_superfluous_effect,
    helps_but_is_barred,
    is_better,
    is_supported,
    list_displaced_parameters,
    objection,
)
from teleopdesign.effects import EFFECTS

DAMPING = "device.viscous.damping"


def of(known, *at_bound, error=0.5):
    """A fit of that model with these parameters at a bound."""
    one = fit(error)
    one.model, one.at_bound = known, at_bound
    return one


def displaced(base, *at_bound, **how):
    return list_displaced_parameters(of(base), of(base, *at_bound), **how)


@pytest.mark.parametrize(("errors", "least"), [(1.0, {}), (3.0, {"least": 3.0})])
def test_a_parameter_is_displaced_where_it_was_surely_there(errors, least):
    sure, open_one = (
        model("coulomb", "viscous", damping=(2.0, 2.0 / (errors * by))) for by in (1.01, 0.99)
    )
    assert displaced(sure, DAMPING, **least) == [DAMPING]
    assert displaced(open_one, DAMPING, **least) == []
    assert displaced(sure, **least) == []
    # nor is one that was at a bound before, or that the model had not
    assert list_displaced_parameters(of(sure, DAMPING), of(sure, DAMPING), **least) == []
    assert displaced(sure, "device.spring.stiffness", **least) == []


def test_what_an_effect_cannot_be_without_must_be_sure_and_what_is_optional_may_be_open():
    level, speed = "device.stribeck.extra_static_level", "device.stribeck.stribeck_velocity"
    assert displaced(model("coulomb", "stribeck"), level, speed) == [level, speed]
    assert displaced(model("coulomb", "stribeck", stribeck_velocity=(0.1, 1.0)), level) == []
    assert displaced(model("coulomb", "stribeck", stribeck_velocity=(0.1, 0.0, True)), level) == [
        level
    ]
    stiffness, damping = "device.presliding.stiffness", "device.presliding.bristle_damping"
    open_damping = model("coulomb", "presliding", bristle_damping=(4.0, 9.0))
    assert displaced(open_damping, stiffness) == [stiffness]
    assert displaced(open_damping, damping) == [], "of itself nothing is known"
    assert displaced(model("coulomb", "presliding"), damping) == [damping]
    # another effect that is open says nothing of this one
    assert displaced(model("coulomb", "viscous", level=(1.0, 9.0)), DAMPING) == [DAMPING]


def candidate_at(base, effect, *at_bound, error=0.3):
    """The candidate beside that base, with these parameters at a bound."""
    one = ranked(error, effect)
    one.fit.model, one.fit.at_bound = base.with_effect(effect), at_bound
    return one


def test_an_effect_with_a_parameter_at_a_bound_is_another_effect_unless_noise_is_left():
    base, at = model("coulomb"), "device.presliding.stiffness"
    bound = candidate_at(base, "presliding", at)
    assert (
        objection(of(base), bound, floor(0.01))
        == f"fits only with {at} at a bound, where it is another effect"
    )
    assert objection(of(base), bound, floor(0.2)) == "", "only noise is left"
    # a base that left noise already is no worse without it
    assert "another effect" in objection(of(base, error=0.31), bound, floor(0.2))
    optional = candidate_at(base, "presliding", "device.presliding.bristle_damping")
    assert objection(of(base), optional, floor(0.01)) == ""
    two = candidate_at(base, "stribeck", *(f"device.stribeck.{n}" for n in BY_EFFECT["stribeck"]))
    assert "extra_static_level, device.stribeck.stribeck_velocity at" in objection(
        of(base), two, floor(0.01)
    )


def test_only_what_is_better_identifiable_and_not_barred_is_supported():
    base, low = fit(0.5), floor(0.01)
    assert is_supported(base, ranked(0.3), low)
    assert not is_supported(base, ranked(0.499), low)
    assert not is_supported(base, ranked(0.3, is_identifiable=False), low)
    assert not is_supported(base, ranked(0.3, implausible="a bristle"), low)


def test_a_gain_must_be_one_of_the_force_too():
    """Seen at the command much less is left, of the force next to nothing."""
    base, low = fit(0.5), floor(0.01)
    assert not is_better(base, fit(0.499, at_command=0.3), low)
    assert not is_better(base, fit(0.501, at_command=0.3, residual=0.3 * SHAPE), low)
    assert is_better(base, fit(0.45, at_command=0.3), low)


@pytest.mark.parametrize("size", [0.05, 1.0, 20.0])
def test_what_is_barred_helps_by_its_error_or_by_its_squares(size):
    """The one is relative to what was recorded, the other to what acts by the model."""
    bar, less, much = "a bristle", size * 0.96**0.5, size * 0.98**0.5
    base = fit(size)
    for error, squares, reason in [(less, size, bar), (size, less, bar), (much, much, "")]:
        one = ranked(error, implausible=bar, residual=squares * SHAPE)
        assert helps_but_is_barred(base, one, floor(0.01 * size)) == reason


def superfluous(base, *at_bound, new="spring", **changed):
    """The effect that a candidate makes superfluous; changed: parameters beside it."""
    names = [name for name, _ in base.effects]
    beside = model(*names, **changed).with_effect(new)
    one = find_superfluous_effect(
        of(base), of(beside, *at_bound), Candidate(EFFECTS[new], "device")
    )
    return one if one is None else one.key


def test_what_ends_where_it_is_absent_is_superfluous_if_it_was_there():
    base = model("coulomb", "viscous")
    assert superfluous(base, DAMPING, damping=(0.0, 0.1)) == ("viscous", "device")
    assert superfluous(base, damping=(1e-9, 1e-10)) is None, "it is there, if weak"
    hardly = model("coulomb", "viscous", damping=(2.0, 2.1))
    assert superfluous(hardly, DAMPING, damping=(0.0, 0.1)) is None


def test_a_bound_where_an_effect_is_not_absent_makes_it_not_superfluous():
    """A gain of nothing is no gain of one; a fraction of 1 is the largest drift."""
    gain, drift = model("coulomb", "actuator_gain"), model("coulomb", "friction_drift")
    assert superfluous(gain, "device.actuator_gain.gain", gain=(0.0, 0.1)) is None
    fraction = "device.friction_drift.fraction"
    assert superfluous(drift, fraction, fraction=(1.0, 0.1)) is None
    assert superfluous(drift, fraction, fraction=(-1.0, 0.1)) is None
    lag, longest = model("actuator_lag"), "device.actuator_lag.time_constant"
    assert superfluous(lag, longest, time_constant=(0.2, 0.01)) is None, "nor is the longest"
    assert superfluous(lag, longest, time_constant=(0.0, 0.01)) == ("actuator_lag", "device")


@pytest.mark.parametrize(("before", "after", "gives_way"), [
    (3.9, 0.9, False), (4.1, 0.9, True), (4.1, 1.1, False), (100.0, 0.5, True),
])  # fmt: skip
def test_what_was_surely_there_and_may_be_absent_now_is_superfluous(before, after, gives_way):
    """In standard errors from absence."""
    base = model("coulomb", "viscous", damping=(2.0, 2.0 / before))
    sentence = superfluous(base, damping=(0.3, 0.3 / after))
    assert sentence == (("viscous", "device") if gives_way else None)


def test_what_ends_at_its_bound_comes_before_what_is_only_open_now():
    base = model("coulomb", "viscous", "bias")
    open_bias = {"force": (0.1, 0.2)}
    assert superfluous(base, **open_bias) == ("bias", "device")
    assert superfluous(base, DAMPING, damping=(0.0, 0.1), **open_bias) == ("viscous", "device")


def test_of_two_that_would_give_way_none_does():
    base = model("coulomb", "viscous", "bias")
    assert superfluous(base, damping=(0.1, 0.2), force=(0.1, 0.2)) is None


@pytest.mark.parametrize(("error", "gives_way"), [(0.01, False), (0.2, True)])
def test_none_gives_way_where_another_that_is_surely_there_is_driven_to_a_bound(error, gives_way):
    """To its largest drift: half of that, and 2.5 standard errors of it, were there before."""
    base = model("coulomb", "viscous", "friction_drift", fraction=(0.5, error))
    at_bound = (DAMPING, "device.friction_drift.fraction")
    sentence = superfluous(base, *at_bound, fraction=(1.0, 0.1), damping=(0.0, 0.1))
    assert sentence == (("viscous", "device") if gives_way else None)


def test_what_its_user_holds_fixed_never_gives_way():
    base = model("coulomb", "viscous", damping=(2.0, 0.0, True))
    assert superfluous(base, DAMPING, damping=(0.0, 0.0, True)) is None


def test_an_effect_of_another_place_does_not_give_way():
    here, there = model("coulomb", "viscous").bodies["device"], model("coulomb").bodies["device"]
    base = Model({"device": here, "handle": there})
    absent = model("coulomb", "viscous", damping=(0.0, 0.1)).bodies["device"]
    beside = Model({"device": absent, "handle": there}).with_effect("spring", at="handle")
    spring = Candidate(EFFECTS["spring"], "handle")
    assert find_superfluous_effect(of(base), of(beside, DAMPING), spring) is None
    beside = Model({"device": absent, "handle": there}).with_effect("spring", at="device")
    spring = Candidate(EFFECTS["spring"], "device")
    assert find_superfluous_effect(of(base), of(beside, DAMPING), spring).key == (
        "viscous",
        "device",
    )
