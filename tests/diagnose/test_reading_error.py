"""What a second reading of the same motion does to estimates."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.force_error import prepare
from teleopdesign.diagnose.reading_error import reading_error, widened


@pytest.fixture(scope="module")
def rod():
    """The shipped rod with its true effects, fitted."""
    experiment = td.load_experiment(td.example("rod"))
    prepared = prepare(experiment)
    model = td.Model.from_experiment(experiment).with_effect(
        "stribeck", values={"extra_static_level": 0.2, "stribeck_velocity": 0.022}
    )
    return estimate(model, prepared), prepared


def test_a_coarse_encoder_makes_friction_look_higher_and_damping_lower(rod):
    found, prepared = rod
    error = reading_error(found, prepared, np.random.default_rng(1))
    shift = dict(zip(found.free, error.shift * found.scale, strict=True))
    spread = dict(zip(found.free, error.spread * found.scale, strict=True))
    assert shift["device.coulomb.level"] > 0
    assert shift["device.viscous.damping"] < 0
    for name in found.free:
        # a reading of 7 um of a travel of centimetres: small against every value
        value = found.model.parameters[name].value
        assert abs(shift[name]) + spread[name] < 0.02 * abs(value)


def test_errors_only_grow_and_values_stay(rod):
    found, prepared = rod
    wide = widened(found, prepared, np.random.default_rng(1))
    for name in found.free:
        before, after = found.model.parameters[name], wide.model.parameters[name]
        assert after.value == before.value
        assert before.stderr < after.stderr < 20 * before.stderr
    again = widened(found, prepared, np.random.default_rng(1))
    assert again.model.parameters == wide.model.parameters
