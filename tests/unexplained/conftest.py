"""The shipped rod, its model without and with the effect that it lacks, and what each leaves."""

import numpy as np
import pytest

from teleopdesign import Model, example, load_experiment
from teleopdesign.diagnose.noise_floor import noise_floor
from teleopdesign.diagnose.search import estimate_from_starts
from teleopdesign.measurement.prepare import prepare
from teleopdesign.unexplained import describe_residual
from teleopdesign.unexplained.rows import rows_of


@pytest.fixture(scope="session")
def rod():
    """The shipped experiment, prepared."""
    return prepare(load_experiment(example("rod")))


@pytest.fixture(scope="session")
def lacking(rod):
    """The shipped model, which lacks `stribeck`, fitted."""
    return estimate_from_starts(Model.from_experiment(rod.experiment), rod)


@pytest.fixture(scope="session")
def adequate(rod, lacking):
    """The model that leaves only noise, fitted."""
    return estimate_from_starts(lacking.model.with_effect("stribeck", at="device"), rod)


@pytest.fixture(scope="session")
def failure(rod, lacking):
    """What the shipped model leaves."""
    return describe_residual(lacking, rod)


@pytest.fixture(scope="session")
def rows(rod, adequate):
    """The residual rows of the model that leaves only noise."""
    return rows_of(adequate.model, rod, "device")


@pytest.fixture(scope="session")
def floor_squares(rod, adequate, rows):
    """What sensors alone leave on the check rows."""
    floor = noise_floor(adequate.model, rod, np.random.default_rng(0)).value
    return floor**2 * sum(s.measured for s in rod.of("check"))
