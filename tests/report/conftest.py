"""One diagnosis of the shipped experiment among few effects, and its page, for all tests here."""

import pytest

from teleopdesign import EFFECTS, Model, example, find_missing, load_experiment
from teleopdesign.report.page import page_of
from teleopdesign.report.write import figures_of

FEW = ("coulomb", "viscous", "stribeck", "quadratic_drag", "spring", "friction_memory")


@pytest.fixture(scope="session")
def diagnosis():
    experiment = load_experiment(example("rod"))
    known = {n: EFFECTS[n] for n in FEW}
    return find_missing(experiment, Model.from_experiment(experiment, known))


@pytest.fixture(scope="session")
def page(diagnosis):
    return page_of(diagnosis)


@pytest.fixture(scope="session")
def figures(page):
    return figures_of(page)
