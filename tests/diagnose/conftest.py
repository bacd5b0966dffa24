"""Cases and diagnoses that several of them use."""

import pytest


@pytest.fixture(scope="session")
def stribeck_case(tmp_path_factory):
    """A device whose model lacks `stribeck`: the folder, with truth.json."""
    from diagnose.simulated_cases import write_simulated

    return write_simulated(tmp_path_factory.mktemp("own") / "stribeck", "stribeck")


@pytest.fixture(scope="session")
def experiment(stribeck_case):
    from teleopdesign import load_experiment

    return load_experiment(stribeck_case)


@pytest.fixture(scope="session")
def search(experiment):
    """The search on `stribeck_case`, among effects that are quick to fit."""
    from teleopdesign import EFFECTS, Model
    from teleopdesign.diagnose.ladder_state import search_for

    quick = ("coulomb", "viscous", "stribeck", "coulomb_asymmetry", "bias", "spring")
    known = {name: EFFECTS[name] for name in quick}
    return search_for(experiment, Model.from_experiment(experiment, known))


@pytest.fixture(scope="session")
def first(search):
    """Where that search begins: the user's model, and all candidates beside it."""
    from teleopdesign.diagnose.ladder_state import begin

    return begin(search)


@pytest.fixture(scope="session")
def end(search, first):
    """What that search ends with."""
    from teleopdesign.diagnose.climb import climb
    from teleopdesign.diagnose.conclusion import end_of

    return end_of(search, *climb(search, first))


@pytest.fixture(scope="session")
def diagnosis(end):
    """What that search states."""
    from teleopdesign.diagnose.result import diagnosis_of

    return diagnosis_of(end)
