"""One list of findings: who asks it is told the same."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.check import findings_of, look_at, stopping_findings, why_silent

H = 0.005
T = H * np.arange(1600)
X = 0.5 * np.sin(2.1 * T) + 0.2 * np.sin(5.3 * T)
V = np.gradient(X, T)
FORCES = {
    "constant force": np.full(len(T), 3.0),
    "unsigned force": 0.1 + np.abs(0.4 * np.tanh(V / 0.02) + 0.2 * V),
    "work": -2.0 * V,
    None: 0.4 * np.tanh(V / 0.02) + 0.2 * V,
}


def log(force):
    table = {"t": T, "x": np.round(X, 4), "u": force}
    position = {"column": "x", "unit": "rad", "resolution": 1e-4}
    return td.experiment(
        table, axis="revolute", inertia=0.05, position=position, actuator_force="u"
    )


@pytest.mark.parametrize("topic", FORCES)
def test_what_stops_a_diagnosis_is_among_the_findings_and_the_end_of_its_verdict(topic):
    experiment = log(FORCES[topic])
    recording = look_at(experiment)
    stops = [f for f in findings_of(recording) if f.stops]
    assert stops == list(stopping_findings(recording))
    assert [f.topic for f in stops] == [topic] * (topic is not None)
    assert stops == [f for f in td.check_experiment(experiment) if f.stops]
    silent = why_silent(recording)
    assert silent == "".join(f.sentence for f in stops)
