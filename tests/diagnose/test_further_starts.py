"""Cyclic tests of a structure that yields: a spring beside an element that slips.

The speed is one, the amplitude grows. Most of the motion takes place within the element, so rigid
friction says little of it, and one linear step beside a bristle gives a spring that is too stiff.
"""

import numpy as np
import pytest
from diagnose.made_records import write_made

from teleopdesign import Model, find_missing, load_experiment
from teleopdesign.diagnose.fit import estimate, fit_squares
from teleopdesign.diagnose.search import base_of, estimate_from_starts
from teleopdesign.measurement.prepare import prepare

pytestmark = pytest.mark.slow  # fits from many starts

ELEMENT, LEVEL = 44.0, 3.7  # N m/rad, N m
#: turns of the fit and of the check record (rad)
GROWING = (0.035, 0.052, 0.11, 0.112, 0.111, 0.22, 0.223, 0.222, 0.33), (0.1, 0.33, 0.335, 0.338)
STEPPED = (0.1, 0.2, 0.3, 0.35), (0.3, 0.3, 0.3)


def slip(position, stiffness, level):
    """Force (n,) of a spring that slips at a level, at rest at first."""
    force = np.zeros(len(position))
    for k in range(1, len(position)):
        moved = force[k - 1] + stiffness * (position[k] - position[k - 1])
        force[k] = np.clip(moved, -level, level)
    return force


def cycles(amplitudes, speed=0.6):
    """Duration, and position as a function of time, of ramps between growing turns."""
    turns = np.array([0.0, *(s * a for a in amplitudes for s in (1.0, -1.0))])
    times = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(turns)))]) / speed
    grid = np.arange(0.0, times[-1], 1e-3)
    window = np.hanning(122)[1:-1] / np.hanning(122)[1:-1].sum()
    path = np.convolve(np.pad(np.interp(grid, times, turns), 60, mode="edge"), window, "same")
    return times[-1] - 0.1, lambda t: np.interp(t, grid, path[60:-60])


def turned(turns):
    fit, check = map(cycles, turns)
    return {"fit": [fit], "check": [check]}


def yielding(folder, spring, records=None, level=LEVEL):
    """The experiment of a structure whose spring has this stiffness (N m/rad)."""
    write_made(
        folder,
        records or turned(GROWING),
        lambda t, x, v: spring * x + slip(x, ELEMENT, level),
        effects="coulomb = {}\nviscous = {}",
        step=4e-4,
        noise=0.03,
        bandwidth=8,
        inertia=0.02,
        rate=50,
        fixed=False,
    )
    return load_experiment(folder)


@pytest.mark.parametrize(("spring", "turns"), [(16.0, GROWING), (30.0, STEPPED)])
def test_a_search_never_leaves_more_than_the_model_without_the_effect(tmp_path, spring, turns):
    """From the strength of one linear step alone, these ended at 4.5 and 2.0 times its squares."""
    experiment = yielding(tmp_path, spring, turned(turns))
    prepared, model = prepare(experiment), Model.from_experiment(experiment)
    rigid = base_of(estimate(model, prepared), prepared)
    bristle = estimate_from_starts(model.with_effect("presliding"), prepared, rigid)
    assert bristle.fit_error < 0.2 < 0.8 < rigid.fit.fit_error
    base = base_of(bristle, prepared)
    best = estimate_from_starts(bristle.model.with_effect("spring"), prepared, base)
    assert fit_squares(best) < fit_squares(bristle)


def test_a_structure_that_yields_has_a_spring_and_an_element_that_slips(tmp_path):
    """A bristle alone left 24 %: the spring beside it was lost, and alone it was refused."""
    among = ("spring", "presliding", "maxwell_slip", "hardening_spring", "bias", "stribeck")
    diagnosis = find_missing(yielding(tmp_path, 16.0), among=among)
    assert {c.effect.name for c in diagnosis.missing} == {"spring", "maxwell_slip"}
    assert diagnosis.after.check_error < 0.01
    stiffness = diagnosis.model.parameters["device.spring.stiffness"]
    assert abs(stiffness.value - 16.0) < 3.0 * stiffness.stderr < 1.0
