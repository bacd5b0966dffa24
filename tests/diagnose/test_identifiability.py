"""Whether records determine what was added: errors from absence, and columns that none imitates."""

import numpy as np
import pytest
from diagnose.known_models import BY_EFFECT, ROWS, fitted, model

from teleopdesign.diagnose import identifiability
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.identifiability import (
    doubt,
    is_identifiable,
    is_strength,
    list_known_in_product,
)
from teleopdesign.diagnose.products import Product
from teleopdesign.effects import EFFECTS

BASE = fitted(model("coulomb"), "coulomb")


def identifiable(effect, **changed):
    return is_identifiable(fitted(model("coulomb", effect, **changed), "coulomb", effect), BASE)


@pytest.mark.parametrize(
    ("effect", "name", "errors"),
    [
        ("viscous", "damping", 2.0),  # a strength
        ("actuator_lag", "time_constant", 2.0),
        ("stribeck", "stribeck_velocity", 1.0),  # the effect stands on its level
        ("cogging", "period", 1.0),
        ("backlash", "gap", 4.0),  # without a gap it is another effect
        ("backlash", "tip_inertia", 2.0),
        ("backlash", "damping", 1.0),
    ],
)
def test_what_was_added_differs_from_absence_by_so_many_standard_errors(
    monkeypatch, effect, name, errors
):
    monkeypatch.setattr(identifiability, "product_of", lambda fit, effect: None)
    value, _ = BY_EFFECT[effect][name]
    for error, is_known in [(0.99 * value / errors, True), (1.01 * value / errors, False)]:
        assert identifiable(effect, **{name: (value, error)}) == is_known
    assert not identifiable(effect, **{name: (value, float("nan"))}), "nothing is known of it"


def test_absence_of_a_gain_is_one_and_an_angle_is_open_from_half_a_turn():
    for error, is_known in [(0.24, True), (0.26, False)]:
        assert identifiable("actuator_gain", gain=(1.5, error)) == is_known
    for error, is_known in [(3.1, True), (3.2, False)]:
        assert identifiable("cogging", phase=(0.01, error)) == is_known


@pytest.mark.parametrize(
    ("effect", "one"),
    [("stribeck", "stribeck_velocity"), ("cogging", "amplitude"), ("backlash", "stiffness")],
)
@pytest.mark.parametrize(("left", "most"), [(0.7, True), (0.72, False)])
@pytest.mark.parametrize("is_known", [True, False])
def test_what_takes_away_half_of_the_squares_of_both_uses_may_be_open(
    monkeypatch, effect, one, left, most, is_known
):
    """Where a product of its parameters is known; but for a gap: that effect is another without."""
    product = Product((f"device.{effect}.{one}",), (1.0,), (1.0,), 0.1 if is_known else 0.5)
    monkeypatch.setattr(identifiability, "product_of", lambda fit, effect: product)
    wide = {n: (v, 3.0 * v) for n, (v, _) in BY_EFFECT[effect].items()}
    after = fitted(model("coulomb", effect, **wide), "coulomb", effect)
    after.fit_residual = after.check_residual = np.full(ROWS, left)
    expected = most and is_known and effect != "backlash"
    assert is_identifiable(after, BASE) == expected
    if effect == "stribeck":  # its strength, the level, is no part of the product
        sentence = doubt(after, Candidate(EFFECTS[effect], "device"), most=after if most else None)
        assert bool(sentence) == (not expected)
    after.check_residual = np.ones(ROWS)
    assert not is_identifiable(after, BASE)


def test_what_is_optional_may_be_open():
    assert identifiable("presliding", bristle_damping=(4.0, 100.0))
    assert not identifiable("presliding", stiffness=(1e3, 1.1e3))


def test_what_is_known_in_a_product_may_be_open_alone_unless_it_is_essential(monkeypatch):
    def known(*names, power=1.0, error=0.01):
        full = tuple(names)
        one = Product(full, (power,) * len(full), (1.0,) * len(full), error)
        monkeypatch.setattr(identifiability, "product_of", lambda fit, effect: one)

    level = "device.stribeck.extra_static_level"
    known(level)
    assert identifiable("stribeck", extra_static_level=(0.5, 2.0))
    known("device.stribeck.stribeck_velocity")
    assert not identifiable("stribeck", extra_static_level=(0.5, 2.0))
    known("device.backlash.gap")
    assert not identifiable("backlash", gap=(0.02, 0.02))
    # a power differs from zero by three errors of the product
    fit = fitted(model("coulomb", "stribeck"), "stribeck")
    for power, error, is_known in [(0.5, 0.16, True), (0.5, 0.17, False), (-0.5, 0.16, True)]:
        known(level, power=power, error=error)
        assert list_known_in_product(fit, "device.stribeck") == ({level} if is_known else set())


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize(("share", "is_known"), [(0.019, False), (0.021, True)])
def test_one_column_must_lie_outside_of_what_the_model_has(size, share, is_known):
    rng = np.random.default_rng(1)
    old = rng.standard_normal((ROWS, 2))
    span, _ = np.linalg.qr(old)
    alone = rng.standard_normal(ROWS)
    alone -= span @ (span.T @ alone)
    alone /= np.linalg.norm(alone)
    inside = span @ [0.6, 0.8]
    new = size * (np.sqrt(1 - share**2) * inside + share * alone)
    base = fitted(model("coulomb", "bias"), "coulomb", "bias")
    known = model("coulomb", "bias", "viscous")
    columns = np.column_stack([old, new])
    fit = fitted(known, "coulomb", "bias", "viscous", columns=columns)
    assert is_identifiable(fit, base) == is_known


def test_without_other_parameters_any_column_tells_and_one_of_nothing_never():
    known = model("viscous")
    none = fitted(model("coulomb"))
    assert is_identifiable(fitted(known, "viscous"), none)
    nothing = np.zeros((ROWS, 1))
    assert not is_identifiable(fitted(known, "viscous", columns=nothing), none)
    # of two new columns one that tells is enough
    two = np.column_stack([np.zeros(ROWS), np.ones(ROWS)])
    both = model("coulomb", "stribeck")
    assert is_identifiable(fitted(both, "stribeck", columns=two), none)
    assert is_identifiable(fitted(both, "stribeck", columns=two[:, ::-1]), none)


def test_strengths_are_what_an_effect_is_absent_without():
    known = model("coulomb", "presliding", "stribeck", "actuator_gain")
    assert is_strength(known, "device.stribeck.extra_static_level")
    assert is_strength(known, "device.actuator_gain.gain")
    assert not is_strength(known, "device.stribeck.stribeck_velocity")
    assert not is_strength(known, "device.presliding.stiffness"), "absent where it is infinite"
    assert not is_strength(known, "device.inertia")


def doubted(effect, free=None, **changed):
    fit = fitted(model("coulomb", effect, **changed), effect)
    if free is not None:
        fit.free = free
    return doubt(fit, Candidate(EFFECTS[effect], "device"))


@pytest.mark.parametrize(("effect", "name"), [("viscous", "damping"), ("backlash", "gap")])
def test_a_strength_or_what_is_essential_is_doubted_below_two_standard_errors(effect, name):
    value, _ = BY_EFFECT[effect][name]
    assert doubted(effect, **{name: (value, 0.49 * value)}) == ""
    sentence = doubted(effect, **{name: (value, 0.51 * value)})
    assert sentence.startswith(f"{name} = ") and "the effect may be absent" in sentence
    assert doubted(effect, free=(), **{name: (value, value)}) == "", "it is fixed"
    assert doubted(effect, **{name: (value, float("nan"))}) != ""


def test_what_an_effect_does_not_stand_on_is_not_doubted():
    assert doubted("cogging", period=(0.1, 1.0), phase=(0.4, 9.0)) == ""
    assert doubted("presliding", bristle_damping=(4.0, 50.0)) == ""
