"""Smoothed friction, stops at both ends and a dead zone of the actuator, found on made records."""

import numpy as np
import pytest
from diagnose.made_records import write_made

from teleopdesign import Model, find_missing, load_experiment
from teleopdesign.effects import EFFECTS

INERTIA = 0.05


def path(seed):
    rng = np.random.default_rng(seed)
    size, rate, phase = rng.uniform(0.7, 1.3, (3, 4))
    size, rate = size * [0.6, 0.3, 0.2, 0.1], 2 * np.pi * rate * [0.3, 0.7, 1.3, 2.1]
    return lambda t: (size * np.sin(np.multiply.outer(t, rate) + 6 * phase)).sum(-1)


def stopped(t, x, v):
    ends = 6.0 * (np.maximum(x - 0.5, 0.0) + np.minimum(x + 0.4, 0.0))
    return 0.2 * np.sign(v) + 0.1 * v + ends


def beyond_a_dead_zone(t, x, v):
    rest = 0.05 * np.sign(v) + 0.1 * v
    return rest + 0.15 * np.sign(INERTIA * np.gradient(v, t) + rest)


#: effect -> (force that the motion takes beside the inertia, value of a parameter)
MADE = {
    "smoothed_coulomb": (lambda t, x, v: 0.6 * v / (0.15 + np.abs(v)), ("level", 0.6)),
    "stops": (stopped, ("stiffness", 6.0)),
    "actuator_dead_zone": (beyond_a_dead_zone, ("half_width", 0.15)),
}
OTHERS = (
    *("coulomb", "viscous", "shear_thinning", "quadratic_drag", "bias", "spring", "stribeck"),
    *("hardening_spring", "actuator_gain", "actuator_saturation", "presliding"),
)


@pytest.mark.slow
@pytest.mark.parametrize("name", MADE)
def test_what_was_put_in_is_named_with_its_value(tmp_path, name):
    force, (parameter, value) = MADE[name]
    records = {"fit": [(12.0, path(1))], "check": [(12.0, path(2))]}
    write_made(
        tmp_path / "made", records, force, effects="coulomb = {}\nviscous = {}",
        step=1e-5, noise=0.01, rate=500, bandwidth=20, inertia=INERTIA,
    )  # fmt: skip
    experiment = load_experiment(tmp_path / "made")
    known = {n: EFFECTS[n] for n in (*OTHERS, *MADE)}
    diagnosis = find_missing(experiment, Model.from_experiment(experiment, known))
    assert name in {c.effect.name for c in diagnosis.missing}, diagnosis
    estimate = diagnosis.model.parameters[f"device.{name}.{parameter}"].value
    assert estimate == pytest.approx(value, rel=0.1)
