"""Whether records determine what was added: errors from absence, and columns that none imitates."""

import numpy as np
import pytest
from diagnose.known_models import ROWS, fitted, model

from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.identifiability import (
    doubt,
    is_identifiable,
    is_strength,
)
from teleopdesign.effects import EFFECTS

BASE = fitted(model("coulomb"), "coulomb")


def identifiable(effect, **changed):
    return is_identifiable(fitted(model("coulomb", effect, **changed), "coulomb", effect), BASE)


def test_what_is_optional_may_be_open():
    assert identifiable("presliding", bristle_damping=(4.0, 100.0))
    assert not identifiable("presliding", stiffness=(1e3, 1.1e3))


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


def test_what_an_effect_does_not_stand_on_is_not_doubted():
    assert doubted("cogging", period=(0.1, 1.0), phase=(0.4, 9.0)) == ""
    assert doubted("presliding", bristle_damping=(4.0, 50.0)) == ""
