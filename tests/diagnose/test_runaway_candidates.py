"""A candidate whose hidden body runs away has no error: it counts as absent, in numbers."""

import importlib
import math
from dataclasses import replace

import pytest

from teleopdesign.diagnose.fit import estimate
from teleopdesign.measurement import load_experiment
from teleopdesign.measurement.prepare import prepare
from teleopdesign.model import Model

pytestmark = pytest.mark.slow  # fits of candidates

#: the module: the folder has a function of the same name
rank = importlib.import_module("teleopdesign.diagnose.rank")


@pytest.mark.parametrize("lost", ["fit_error", "check_error"])
def test_it_has_the_error_of_the_model_without_it(lost, few, short_rod, monkeypatch):
    """Such an answer held a probability that was no number, and could not be read."""
    experiment = load_experiment(short_rod)
    prepared = prepare(experiment)
    base = estimate(Model.from_experiment(experiment), prepared)
    fit_each = rank.fit_each

    def with_runaway(*arguments, **options):
        (candidate, fit), *others = fit_each(*arguments, **options)
        return [(candidate, replace(fit, **{lost: math.nan})), *others]

    monkeypatch.setattr(rank, "fit_each", with_runaway)
    ranking = rank.rank_candidates(base, prepared)
    for one in ranking.ranked:
        assert math.isfinite(one.score) and math.isfinite(one.fit.check_error)
    runaway = [r for r in ranking.ranked if r.fit.check_error == base.check_error]
    assert any(r.candidate.key in r.fit.model.absent and not r.counts for r in runaway)
