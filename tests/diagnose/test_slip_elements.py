"""Springs that slip in turn are found from starts where all their stiffnesses are in proportion."""

import numpy as np
import pytest
from diagnose.made_records import write_made

from teleopdesign import Model, load_experiment
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.search import base_of, estimate_from_starts
from teleopdesign.measurement.prepare import prepare

pytestmark = pytest.mark.slow  # searches of three springs

STIFFNESS, LEVEL = (2000.0, 300.0, 40.0), (0.2, 0.5, 0.3)  # N m/rad, N m
NAMES = [f"device.maxwell_slip.stiffness_{i}" for i in (1, 2, 3, 4)]


def slip(position, stiffness, level):
    """Force (n,) of a spring that slips at a level, at rest at first."""
    force = np.zeros(len(position))
    for k in range(1, len(position)):
        moved = force[k - 1] + stiffness * (position[k] - position[k - 1])
        force[k] = np.clip(moved, -level, level)
    return force


def needed(t, x, v):
    return 2.0 * v + sum(slip(x, *element) for element in zip(STIFFNESS, LEVEL, strict=True))


def motion(t):
    w = 2 * np.pi * t
    return 0.02 * np.sin(0.5 * w) + 0.01 * np.sin(1.3 * w + 1) + 0.004 * np.sin(3.1 * w)


@pytest.fixture(scope="module")
def fit(tmp_path_factory):
    """The fit with friction and damping alone, with its records."""
    folder = write_made(
        tmp_path_factory.mktemp("slip"),
        {"fit": [(6.0, motion)], "check": [(4.0, motion)]},
        needed,
        effects="coulomb = {}\nviscous = {}",
        step=1e-6,
        noise=0.005,
        bandwidth=30,
        rate=500,
    )
    experiment = load_experiment(folder)
    prepared = prepare(experiment)
    return estimate(Model.from_experiment(experiment), prepared), prepared


def test_the_search_reaches_three_springs(fit):
    """From starts that are not in proportion the search ended at 1.2 %, and noise is 0.2 %."""
    base, prepared = fit
    springs = base.model.with_effect("maxwell_slip")
    best = estimate_from_starts(springs, prepared, base_of(base, prepared))
    assert best.check_error < 0.003 < 0.4 < base.check_error
    values = best.model.parameters
    for stiffness in STIFFNESS:
        assert min(abs(values[n].value / stiffness - 1.0) for n in NAMES) < 0.02
