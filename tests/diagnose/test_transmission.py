"""Gears: a gap or a spring, with dry friction behind it, found together."""

from dataclasses import replace

import numpy as np
import pytest
from effects.recorded import write_recorded

import teleopdesign as td
from teleopdesign.diagnose.candidates import candidates
from teleopdesign.effects import EFFECTS
from teleopdesign.model import Model

DAMPED = "viscous = { damping = 0.5 }"
BELIEVED = "coulomb = { level = 0.4 }\nviscous = { damping = 0.5 }"
#: kg, N/m, N s/m, N; beside them a gap in m
GEAR = {"has_tip": 1.0, "tip_inertia": 0.06, "tip_stiffness": 800.0, "tip_damping": 1.0}
RUBBING = {"level": 0.2, "damping": 0.5, "tip_level": 0.3}
TRUE = {"tip_inertia": 0.06, "stiffness": 800.0, "damping": 1.0, "gap": 1e-3}
#: parts of a gear, and what its hysteresis was once called
GEARS = ("coulomb", "stribeck", "transmission_compliance", "backlash", "tip_friction")
GEARS += ("maxwell_slip", "presliding")


@pytest.fixture(scope="module")
def gear(tmp_path_factory):
    folder = tmp_path_factory.mktemp("gears") / "gap"
    write_recorded(folder, BELIEVED, gap=TRUE["gap"], **GEAR, **RUBBING)
    return td.load_experiment(folder)


@pytest.mark.slow
def test_a_gear_with_friction_on_the_load_is_named_whole(tmp_path):
    """Without dry friction in the model its hysteresis had been called slipping springs."""
    folder = write_recorded(tmp_path / "gear", DAMPED, gap=0.0, **GEAR, **RUBBING)
    diagnosis = td.find_missing(td.load_experiment(folder), among=GEARS)
    named = ["coulomb", "transmission_compliance", "tip_friction"]
    assert [c.effect.name for c in diagnosis.missing] == named
    for name in EFFECTS["transmission_compliance"].parameters:
        fitted = diagnosis.model.parameters[f"device.transmission_compliance.{name}"]
        assert abs(fitted.value - TRUE[name]) < max(5 * fitted.stderr, 0.1 * TRUE[name])
    level = diagnosis.model.parameters["device.tip_friction.level"]
    assert level.value == pytest.approx(0.3, rel=0.1)
    assert np.all(np.diff([r.check_error for r in diagnosis.rungs]) < 0)


@pytest.mark.parametrize("structure", ["transmission_compliance", "backlash"])
def test_friction_behind_a_transmission_does_not_take_the_place_of_the_actuators(gear, structure):
    """A servo without a gear, stated as an inertia alone, was given a soft one with friction."""
    bare = replace(Model.from_experiment(gear), known=EFFECTS)
    for name in ("viscous", "coulomb"):
        bare = bare.without_effect(name, at="device")
    bare = bare.with_effect(structure, at="device")
    rubbing = bare.with_effect("coulomb", at="device")
    names = [[c.effect.name for c in candidates(m)] for m in (bare, rubbing)]
    assert ["tip_friction" in some for some in names] == [False, True]


@pytest.mark.slow
def test_a_gap_without_friction_behind_it_gets_none(tmp_path):
    values = {**RUBBING, "tip_level": 0.0}
    folder = write_recorded(tmp_path / "gear", BELIEVED, gap=1e-3, **GEAR, **values)
    diagnosis = td.find_missing(td.load_experiment(folder), among=GEARS)
    assert [c.effect.name for c in diagnosis.missing] == ["backlash"]
