"""Under one constant force nothing can be told, unless an inertia is known."""

from dataclasses import replace

import numpy as np
import pytest

import teleopdesign as td

H = 0.01


def spun_up(levels=(64.0,), *, fixed=False, seconds=3.0):
    """A motor of 1 kg m^2 with damping that spins up under each of these torques, from rest."""
    t = np.arange(0.0, seconds, H)
    angle = [u / 10.0 * (t - (1.0 - np.exp(-10.0 * t)) / 10.0) for u in levels]
    steps = 1e-3
    table = {
        "t": H * np.arange(len(levels) * len(t)),
        "q": steps * np.round(np.concatenate(angle) / steps),
        "u": np.repeat(levels, len(t)),
        "run": np.repeat(np.arange(len(levels)), len(t)),
    }
    channels = {"position": {"column": "q", "unit": "rad"}, "actuator_force": "u"}
    made = td.experiment(table, axis="revolute", segment="run", inertia=1.0, **channels)
    body = made.bodies["device"]
    known = replace(body, inertia=replace(body.inertia, fixed=fixed))
    return replace(made, bodies={"device": known})


@pytest.mark.parametrize(
    ("levels", "warned"),
    [((64.0,), True), ((-64.0, 64.0), True),
     pytest.param((64.0, 40.0), False, marks=pytest.mark.slow)],
)  # fmt: skip
def test_a_check_warns_of_a_force_of_one_size(levels, warned):
    findings = {f.topic: f for f in td.check_experiment(spun_up(levels))}
    assert ("constant force" in findings) == warned
    if warned:
        assert findings["constant force"].concern == "warning"
        assert findings["constant force"].stops
        assert "these records tell no inertia" in findings["constant force"].sentence
        assert "what the record can show" not in findings, "it listed what cannot be told"


@pytest.mark.slow
def test_no_effect_is_named_under_a_constant_force():
    """A bias of the size of the command, and a Stribeck friction, were named."""
    diagnosis = td.find_missing(spun_up())
    assert diagnosis.verdict == "undecided" and diagnosis.missing == ()
    assert "The force is constant" in str(diagnosis)
    assert "The force is constant" in diagnosis.silence
