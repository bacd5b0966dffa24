"""Friction at rest is no larger than the largest force: else the body would never have moved."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose.made_records import write_made

from teleopdesign import Model, load_experiment
from teleopdesign.diagnose.fit import estimate
from teleopdesign.measurement.prepare import prepare

LEVEL, SPEED = "device.stribeck.extra_static_level", "device.stribeck.stribeck_velocity"


def test_a_fit_seeks_friction_at_rest_only_up_to_the_largest_measured_force(tmp_path):
    """Only at 0.1 rad/s is there more friction, 0.18 N m, as if it were 10 N m at rest."""

    def triangle(speed):
        return lambda t: speed * np.abs((t + 1.0) % 4.0 - 2.0)

    write_made(
        tmp_path,
        {use: [(8.0, triangle(v)) for v in (0.1, 0.3)] for use in ("fit", "check")},
        lambda t, x, v: (0.5 + 10.0 * np.exp(-((v / 0.05) ** 2))) * np.sign(v),
        effects="coulomb = {}",
        step=1e-4,
        noise=1e-3,
    )
    prepared = prepare(load_experiment(tmp_path))
    model = Model.from_experiment(prepared.experiment).with_effect("stribeck")
    speed = replace(model.parameters[SPEED], value=0.05, fixed=True)
    fit = estimate(model.with_values({LEVEL: 10.0, SPEED: speed}), prepared)
    largest = max(np.abs(s.motion.command).max() for s in prepared.of("fit"))
    assert fit.model.parameters[LEVEL].value == pytest.approx(largest, rel=1e-3)
    # the limit of a search is no bound of the parameter, at which an effect would lose its name
    assert LEVEL in fit.free and fit.at_bound == ()
