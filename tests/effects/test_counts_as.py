"""What counts as an effect takes its place for others that need it."""

import pytest

from teleopdesign import ModelError
from teleopdesign.blocks import Body, Value
from teleopdesign.effects import EFFECTS

BODY = Body("prismatic", {"inertia": Value(1.0)})


@pytest.mark.parametrize("name", sorted(n for n, e in EFFECTS.items() if e.counts_as))
def test_what_an_effect_counts_as_is_a_catalogued_effect(name):
    assert EFFECTS[name].counts_as <= set(EFFECTS)


@pytest.mark.parametrize("friction", ["viscous", "shear_thinning"])
def test_asymmetry_is_possible_beside_any_friction_of_speed(friction):
    asymmetry = EFFECTS["viscous_asymmetry"]
    assert BODY.lacks(asymmetry) == ("viscous",)
    assert BODY.with_effect(EFFECTS[friction]).lacks(asymmetry) == ()


def test_a_law_that_holds_the_damping_itself_needs_the_viscous_effect():
    warming = EFFECTS["viscous_temperature"]
    assert warming.parameters_of_others() == {"viscous"}
    assert BODY.with_effect(EFFECTS["shear_thinning"]).lacks(warming) == ("viscous",)
    assert BODY.with_effect(EFFECTS["viscous"]).lacks(warming) == ()


def test_an_effect_names_none_of_its_parameters_as_those_of_others():
    # its own parameters begin with the name of the effect that it needs
    assert EFFECTS["viscous_asymmetry"].parameters_of_others() == frozenset()
    with pytest.raises(ModelError):
        BODY.effect("viscous_asymmetry")
