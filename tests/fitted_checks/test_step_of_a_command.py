"""A motor that spins up after one step of its command: what its record tells, and what not."""

import numpy as np

import teleopdesign as td
from teleopdesign.fitted_checks import check_experiment


def sentences(table, **channels):
    position = {"column": "q", "unit": "rad"}
    experiment = td.experiment(
        table, axis="revolute", inertia=1e-4, position=position, actuator_force="u", **channels
    )
    return {f.sentence: f.concern for f in check_experiment(experiment)}


def test_a_command_that_is_constant_in_motion_has_no_lag():
    """A delay of 110 ms was advised: the low-pass of the step was taken for a late force.

    As it gets warm, the motor reaches its last twentieth of the speed slowly.
    """
    t = 0.01 * np.arange(283)
    since = np.maximum(t - 1.2, 0.0)
    rpm = 1700.0 * (1 - np.exp(-since / 0.085)) + 100.0 * (1 - np.exp(-since / 0.6))
    rpm += 5.0 * np.random.default_rng(2).standard_normal(len(t)) * (since > 0)
    rate = rpm * 2.0 * np.pi / 60.0
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1])) * 0.01])
    findings = sentences({"t": t, "q": angle, "u": np.where(t < 1.2, 0.0, 0.2)})
    assert not [s for s in findings if "lags the motion" in s]


def test_a_negative_inertia_is_no_agreement_of_signs():
    """ "signs and units agree" stood beside an inertia of -0.013 kg: the motor is short-circuited,
    its current brakes, and a spring that is not in the model moves the body."""
    t = 0.004 * np.arange(450)
    angle = 1.5 * np.exp(-0.6 * t) * np.cos(17.0 * t)
    rate = np.gradient(angle, t)
    current = 0.02 * rate - 0.3e-4 * np.gradient(rate, t) + 0.05 * np.sign(rate)
    noise = 1e-3 * np.random.default_rng(3).standard_normal(len(t))
    findings = sentences({"t": t, "q": np.round(angle, 3), "u": current + noise})
    assert not [s for s in findings if "signs and units agree" in s]
    negative = [concern for s, concern in findings.items() if "a negative inertia" in s]
    assert negative == ["note"], findings
