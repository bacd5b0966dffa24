"""A search may try values at which numbers overflow: such a model must never look good."""

import math

import numpy as np
import pytest

from teleopdesign import Model, example, load_experiment
from teleopdesign.diagnose.error import force_error
from teleopdesign.diagnose.residual import relative_residuals
from teleopdesign.measurement.prepare import prepare

GAIN = "device.actuator_gain.gain"


@pytest.fixture(scope="module")
def amplified():
    """The rod with a gain at which the square of every force overflows, and its records."""
    experiment = load_experiment(example("rod"))
    model = Model.from_experiment(experiment).with_effect("actuator_gain", values={"gain": 1e200})
    return model, prepare(experiment)


def test_an_infinite_acting_force_leaves_no_number_rather_than_no_residual(amplified):
    model, prepared = amplified
    ((residual, slope),) = relative_residuals(model, prepared.of("fit"), [GAIN])
    assert np.isnan(residual).all() and np.isnan(slope).all()
    assert force_error(model, prepared.of("check")) == math.inf
