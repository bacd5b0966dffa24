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
def diagnosis(experiment):
    """What is found on `stribeck_case` among the few effects of `simulated_cases.FEW`."""
    from diagnose.simulated_cases import FEW

    from teleopdesign import Model, find_missing

    return find_missing(experiment, Model.from_experiment(experiment, FEW))
