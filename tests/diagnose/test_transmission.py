"""Gears: a gap or a spring, with dry friction behind it, found together."""

from dataclasses import replace

import numpy as np
import pytest
from effects.recorded import write_recorded

import teleopdesign as td
from teleopdesign.diagnose.candidates import Candidate, candidates
from teleopdesign.diagnose.fit import estimate, fit_squares
from teleopdesign.diagnose.search import base_of
from teleopdesign.diagnose.search_plan import PLAN
from teleopdesign.diagnose.tip_start import _Course, _linear_problem, tip_starts
from teleopdesign.effects import EFFECTS
from teleopdesign.measurement.prepare import prepare
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
FRICTION = Candidate(EFFECTS["tip_friction"], "device")


@pytest.fixture(scope="module")
def gear(tmp_path_factory):
    folder = tmp_path_factory.mktemp("gears") / "gap"
    write_recorded(folder, BELIEVED, gap=TRUE["gap"], **GEAR, **RUBBING)
    return td.load_experiment(folder)


def test_searches_begin_near_the_true_gap(gear):
    prepared = prepare(gear)
    base = base_of(estimate(Model.from_experiment(gear), prepared), prepared).coarse
    starts = tip_starts(base, prepared.coarse, Candidate(EFFECTS["backlash"], "device"), FRICTION)
    best = starts[0]
    assert best.squares == min(s.squares for s in starts)
    assert best.squares < 0.3 * fit_squares(base)
    values = {n: v.value for n, v in best.model.parameters.items()}
    for name in ("tip_inertia", "stiffness", "gap"):
        assert values[f"device.backlash.{name}"] == pytest.approx(TRUE[name], rel=0.5)
    assert values["device.tip_friction.level"] == pytest.approx(0.3, rel=0.5)
    # what the friction behind the gap does is no more put down to the friction before it
    assert values["device.coulomb.level"] < base.model.parameters["device.coulomb.level"].value


def test_a_search_that_nothing_holds_stays_near_its_grid(gear):
    """Where no gap helps, squares fall a hair to where the tip swings ever faster."""
    prepared = prepare(gear)
    base = estimate(Model.from_experiment(gear), prepared)
    problem = _linear_problem(base, prepared.of("fit"), "device", PLAN)
    flat = replace(problem, left=problem.left * 0.0)
    for one in (problem, flat):
        for swing in (PLAN.tip_swings[1] * 300.0, 20.0):
            start = _Course(1e-3, swing, 5.0)
            best = one.refine(start, replace(PLAN, tip_refined=400)).course
            for name in ("gap", "swing", "slowing"):
                ratio = getattr(best, name) / getattr(start, name)
                assert 1 / PLAN.tip_near <= ratio * 1.001 and ratio <= PLAN.tip_near * 1.001


def test_no_search_begins_where_a_hand_moves_the_tip(gear):
    prepared = prepare(gear)
    base = estimate(Model.from_experiment(gear), prepared)
    for stretch in prepared.stretches:
        stretch.motion.interaction[:] = 0.1
    assert tip_starts(base, prepared, Candidate(EFFECTS["backlash"], "device"), FRICTION) == []


@pytest.mark.slow
@pytest.mark.parametrize(("user", "gap"), [(BELIEVED, 1e-3), (DAMPED, 0.0)], ids=["gap", "spring"])
def test_a_gear_with_friction_on_the_load_is_named_whole(user, gap, tmp_path):
    """Without dry friction in the model its hysteresis had been called slipping springs."""
    folder = write_recorded(tmp_path / "gear", user, gap=gap, **GEAR, **RUBBING)
    diagnosis = td.find_missing(td.load_experiment(folder), among=GEARS)
    transmission = "backlash" if gap else "transmission_compliance"
    dry = ["coulomb"] if user == DAMPED else []
    assert [c.effect.name for c in diagnosis.missing] == [*dry, transmission, "tip_friction"]
    for name in EFFECTS[transmission].parameters:
        fitted = diagnosis.model.parameters[f"device.{transmission}.{name}"]
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
