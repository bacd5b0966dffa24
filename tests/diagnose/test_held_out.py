"""Models estimated without a block of the records: one step leads there, or a search does."""

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest

from teleopdesign import Model
from teleopdesign.diagnose.effort import EFFORTS
from teleopdesign.diagnose.fit import estimate, free_parameters
from teleopdesign.diagnose.folds import folds
from teleopdesign.diagnose.solve import model_without, solve
from teleopdesign.measurement.prepare import prepare


@pytest.fixture(scope="module")
def prepared(experiment):
    return prepare(replace(experiment, records=experiment.fit_records))


@pytest.fixture
def searches(monkeypatch):
    """Calls of a search from now on."""
    calls = []

    def counted(*arguments):
        calls.append(arguments)
        return solve(*arguments)

    monkeypatch.setattr(import_module("teleopdesign.diagnose.solve"), "solve", counted)
    return calls


def first_fold(prepared):
    """The stretches without the first block, and which rows these are."""
    stretches = prepared.of("fit")
    known, _ = folds(stretches)[0]
    pairs = zip(stretches, known, strict=True)
    return known, np.concatenate([np.isin(s.keep, k.keep) for s, k in pairs])


@pytest.mark.parametrize(
    "effects", [{}, {"spring": {"stiffness": 0.1}}, {"quadratic_drag": {"drag": 0.01}}]
)
def test_one_step_leads_to_the_model_without_a_block(effects, experiment, prepared, searches):
    model = Model.from_experiment(experiment)
    for name, values in effects.items():
        model = model.with_effect(name, values=values)
    free = free_parameters(model)
    solution = solve(model, free, prepared, prepared.of("fit"), EFFORTS.fine)
    known, rows = first_fold(prepared)
    near = model_without(solution, free, prepared, known, rows, EFFORTS.held_out)
    assert not searches, "the residual is nearly linear so near to the optimum"
    exact = solve(solution.model, free, prepared, known, EFFORTS.fine).model
    for name in free:
        whole, without = (m.parameters[name].value for m in (solution.model, exact))
        assert near.parameters[name].value == pytest.approx(
            without, abs=0.1 * abs(without - whole) + 1e-4 * abs(without)
        ), name


def test_a_search_goes_on_where_the_step_does_not_lead_down(experiment, prepared, searches):
    """By derivatives that are a thousand times too small, a step leads far too far."""
    model = Model.from_experiment(experiment)
    free = free_parameters(model)
    solution = solve(model, free, prepared, prepared.of("fit"), EFFORTS.fine)
    known, rows = first_fold(prepared)
    wrong = replace(solution, jacobian=1e-3 * solution.jacobian)
    near = model_without(wrong, free, prepared, known, rows, EFFORTS.held_out)
    assert len(searches) == 1
    exact = solve(solution.model, free, prepared, known, EFFORTS.fine).model
    for name in free:
        assert near.parameters[name].value == pytest.approx(exact.parameters[name].value, rel=0.05)


def test_the_check_error_of_held_out_blocks_is_that_of_searches_without_them(
    experiment, prepared, monkeypatch
):
    model = Model.from_experiment(experiment)
    by_step = estimate(model, prepared)
    monkeypatch.setattr(
        import_module("teleopdesign.diagnose.fit"),
        "model_without",
        lambda solution, free, prepared, known, rows, effort: (
            solve(solution.model, free, prepared, known, EFFORTS.fine).model
        ),
    )
    by_search = estimate(model, prepared)
    assert by_step.check_error == pytest.approx(by_search.check_error, rel=1e-3)
    assert by_step.check_error > by_step.fit_error
