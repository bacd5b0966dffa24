"""A right model leaves a residual that follows neither its own past nor the command."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.diagnose.covariance import residual_correlations
from teleopdesign.measurement.prepare import prepare


@pytest.fixture(scope="module")
def rod():
    experiment = td.load_experiment(td.example("rod"))
    stated = td.Model.from_experiment(experiment)
    return experiment, stated, td.fit(stated.with_effect("stribeck"), experiment)


def share_outside(model, experiment):
    known = residual_correlations(model, prepare(experiment), "device")
    others = known.lag != 0
    parts = np.concatenate([known.itself[others], known.command])
    assert known.itself[~others] == pytest.approx(1.0)
    return float(np.mean(np.abs(parts) > known.band))


def test_a_right_model_stays_within_the_band_and_one_that_lacks_an_effect_does_not(rod):
    experiment, stated, right = rod
    # one in a hundred by chance
    assert share_outside(right, experiment) <= 0.03
    assert share_outside(stated, experiment) > 0.06
