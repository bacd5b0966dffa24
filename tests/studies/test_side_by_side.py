"""Points simulated side by side have the numbers of single simulations, whatever is beside them."""

import numpy as np
import pytest
import study_models as models

import teleopdesign as td
from teleopdesign.studies.chosen_measures import measures_of
from teleopdesign.studies.evaluate import StudyTask, evaluate, evaluate_unit, units_of
from teleopdesign.studies.points import points_of

AXES = {
    "C.dahl.level": np.linspace(0.0, 1.5, 7),
    "computer.delay": [0.0, 1.5e-4, 1e-3],
    "Z_M.viscous.damping": [0.5, 1.0],
}
MEASURES = ["force_error", "energy_drawn", td.measure("growth", signal="R_M")]


def task(axes=AXES, measures=MEASURES):
    case = td.studies.SimulatedCase(models.interface(), **models.SIMULATED)
    return StudyTask(case, {}, points_of(axes), measures_of(measures))


def test_blocks_have_the_numbers_and_reasons_of_single_simulations():
    one = task()
    (unit,) = units_of(one, [5])
    assert unit == range(42)
    for together in evaluate_unit(one, unit):
        alone = evaluate(one, together.point)
        assert (together.reason, together.form) == (alone.reason, alone.form)
        # lanes have another exp, right to a few units of the last digit; friction amplifies it
        assert together.values == pytest.approx(alone.values, rel=1e-6, abs=1e-9)
    assert "no whole number of steps" in evaluate(one, 2).reason


def test_a_point_does_not_depend_on_those_beside_it():
    whole = task()
    blocks = list(evaluate_unit(whole, range(42)))
    for first, last in ((0, 7), (6, 23), (30, 42)):
        part = list(evaluate_unit(whole, range(first, last)))
        assert part == blocks[first:last]
