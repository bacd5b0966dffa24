"""A check record in which nothing moves checks no model, and one may have a sign of its own."""

from dataclasses import replace

import numpy as np
import pytest

import teleopdesign as td

H = 0.01


def arrived(moves_in_check):
    """A joint with friction that swings for 3 s, and then holds its place against its friction."""
    t = H * np.arange(600)
    fades = 1.0 if moves_in_check else np.clip(4.0 - 4.0 * t / 3.0, 0.0, 1.0)
    angle = fades * np.sin(2.0 * np.pi * 1.5 * t)
    rate = np.gradient(angle, H)
    torque = 0.02 * np.gradient(rate, H) + 0.3 * np.tanh(rate / 0.01) + 0.1 * rate
    at_rest = np.abs(rate) < 1e-9
    table = {"t": t, "q": 1e-3 * np.round(1e3 * angle), "u": np.where(at_rest, 0.1, torque)}
    channels = {"position": {"column": "q", "unit": "rad"}, "actuator_force": "u"}
    return td.experiment(
        table, axis="revolute", inertia=0.02, fit=[(0, 3)], check=[(3.1, 6)], **channels
    )


@pytest.mark.parametrize("moves", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_a_check_warns_of_a_check_record_at_rest(moves):
    sentences = [f.sentence for f in td.check_experiment(arrived(moves)) if f.concern == "warning"]
    assert any("rests throughout the check records" in one for one in sentences) != moves


def test_a_check_warns_of_a_command_that_has_another_sign_in_the_check_record():
    experiment = td.load_experiment(td.example("rod"))
    fit, check = experiment.records
    turned = {n: -x if n.endswith("actuator_force") else x for n, x in check.signals.items()}
    experiment = replace(experiment, records=(fit, replace(check, signals=turned)))
    (finding,) = (f for f in td.check_experiment(experiment) if f.topic == "signs")
    assert finding.concern == "warning" and "check records" in finding.sentence


@pytest.mark.slow
def test_no_model_is_adequate_by_a_check_record_at_rest():
    """The verdict was `model_adequate`, with an error of "inf noise floors"."""
    diagnosis = td.find_missing(arrived(False))
    assert diagnosis.verdict == "undecided"
    assert "cannot check a model" in str(diagnosis)
