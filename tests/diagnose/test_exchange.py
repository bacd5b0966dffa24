"""An effect that only stood in for another gives way to it, and a right one stays."""

import numpy as np
import pytest
from diagnose.simulated_cases import write_simulated

from teleopdesign import Model, load_experiment
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.exchange import best_exchange
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.ladder_state import LadderSearch
from teleopdesign.diagnose.noise_floor import noise_floor
from teleopdesign.diagnose.search import estimate_from_starts
from teleopdesign.effects import EFFECTS
from teleopdesign.measurement.prepare import prepare

pytestmark = pytest.mark.slow  # diagnoses of whole cases


def candidate(name):
    return Candidate(EFFECTS[name], "device")


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """Prepared records of a machine with a spring, the user's model, and its noise floor."""
    folder = write_simulated(tmp_path_factory.mktemp("spring") / "case", "spring", seed=3)
    experiment = load_experiment(folder)
    prepared, stated = prepare(experiment), Model.from_experiment(experiment)
    base = estimate(stated, prepared)
    search = LadderSearch(experiment, prepared, prepared, stated)
    return search, base, noise_floor(base.model, prepared, np.random.default_rng(0))


def fitted(base, prepared, *names):
    """The fit with these effects, added one after the other."""
    for name in names:
        added = base.model.with_effect(EFFECTS[name], at="device")
        base = estimate_from_starts(added, prepared, base)
    return base


def test_a_stand_in_gives_way_to_the_spring_that_it_stood_for(scene):
    search, base, floor = scene
    fit = fitted(base, search.prepared, "hardening_spring", "quadratic_drag")
    rivals = {candidate("hardening_spring"): [candidate("spring"), candidate("added_inertia")]}
    exchange = best_exchange(search, fit, rivals, floor)
    assert exchange is not None
    assert exchange.dropped.key == ("hardening_spring", "device")
    assert exchange.replacement.candidate.key == ("spring", "device")
    assert exchange.replacement.fit.check_error < 0.5 * fit.check_error


def test_the_spring_gives_way_to_nothing(scene):
    search, base, floor = scene
    fit = fitted(base, search.prepared, "spring")
    rivals = {candidate("spring"): [candidate("hardening_spring"), candidate("quadratic_drag")]}
    assert best_exchange(search, fit, rivals, floor) is None


def test_where_nothing_was_a_rival_no_exchange_is_made(scene):
    search, base, floor = scene
    assert best_exchange(search, base, {candidate("spring"): []}, floor) is None
