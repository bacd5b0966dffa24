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


def test_the_motion_is_drawn_over_the_measured_one_with_its_fit(rod):
    experiment, _, right = rod
    comparison = td.compare(right, experiment, by="simulation")
    motion, itself, command = comparison.plot().axes
    text = motion.get_legend().get_texts()
    fit = comparison.error(float("inf")).fit
    assert f"{fit:.1f} %" in text[1].get_text()
    measured, simulated = motion.lines[:2]
    spread = np.std(measured.get_ydata())
    off = np.sqrt(np.mean((simulated.get_ydata() - measured.get_ydata()) ** 2))
    assert fit == pytest.approx(100 * (1 - off / spread), abs=0.01)
    assert motion.get_ylabel() == "position (m)"
    assert "ms" in itself.get_xlabel() and "command" in command.get_ylabel()
