"""Where the readings tell no direction of motion, friction balances any force."""

import numpy as np
import pytest
from check.made_channels import ask

import teleopdesign as td

H = 0.002


def swinging(noise, bandwidth, coulomb=0.3):
    """A joint with dry friction that swings for 20 s; noise (rad, rms) of its position."""
    t = H * np.arange(10_000)
    angle = 0.1 * np.sin(2.0 * np.pi * 0.7 * t) + 0.03 * np.sin(2.0 * np.pi * 1.9 * t)
    rate = np.gradient(angle, H)
    torque = 0.02 * np.gradient(rate, H) + coulomb * np.tanh(rate / 0.01) + 0.1 * rate
    scatter = noise * np.random.default_rng(0).standard_normal(len(t))
    read = 1e-4 * np.round(1e4 * (angle + scatter))
    position = {"column": "q", "unit": "rad", "resolution": 1e-4}
    return td.experiment(
        {"t": t, "q": read, "u": torque},
        axis="revolute",
        inertia=0.02,
        fit=[(0, 12)],
        check=[(12, 20)],
        bandwidth=bandwidth,
        effects=["coulomb"] if coulomb else ["viscous"],
        position=position,
        actuator_force="u",
    )


def reasons(experiment):
    """Why too little moves in the records to test a model."""
    return [f.sentence for f in ask("hidden_motion", experiment) if f.stops]


@pytest.mark.parametrize(
    ("noise", "bandwidth", "hidden"), [(0.002, 100.0, True), (0.0, 100.0, False)]
)
def test_a_bandwidth_that_hides_the_motion_is_a_reason_and_a_warning(noise, bandwidth, hidden):
    experiment = swinging(noise, bandwidth)
    words = "no model is tested: write bandwidth = { value = "
    assert any(words in sentence for sentence in reasons(experiment)) == hidden
    warnings = [f.sentence for f in td.check_experiment(experiment) if f.concern == "warning"]
    assert any("no model is tested" in one for one in warnings) == hidden


def test_without_dry_friction_each_row_tests_the_model():
    experiment = swinging(0.002, 100.0, coulomb=0.0)
    assert not reasons(experiment)


def test_no_model_is_adequate_where_none_is_tested():
    """The verdict was `model_adequate`, with an error of 0.00 % and "inf noise floors"."""
    diagnosis = td.find_missing(swinging(0.002, 100.0))
    assert diagnosis.verdict == "undecided"
    assert "no model is tested" in str(diagnosis)
