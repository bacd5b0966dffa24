"""Models estimated without a block of the records: one step leads there, or a search does."""

from dataclasses import replace
from importlib import import_module

import pytest

from teleopdesign import Model
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.search_plan import EFFORTS
from teleopdesign.diagnose.solve import solve
from teleopdesign.measurement.prepare import prepare


@pytest.fixture(scope="module")
def prepared(experiment):
    return prepare(replace(experiment, records=experiment.fit_records))


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
