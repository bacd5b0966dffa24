"""A channel of another clock: its lag grows along the record; a delay corrects the mean alone."""

from dataclasses import replace

import numpy as np
import pytest
from fitted_checks.asking import disagreements

from teleopdesign import Model, example, load_experiment
from teleopdesign.measurement.prepare import prepare


@pytest.fixture(scope="module")
def rod():
    return load_experiment(example("rod"))


def findings_with(experiment, quantity, moments):
    """Findings where the row at each time holds the value of another moment: moments(t) (s)."""
    key = f"device.{quantity}"

    def change(record):
        t = record.sample_time * np.arange(len(record.signals[key]))
        signal = np.interp(moments(t), t, record.signals[key])
        return replace(record, signals={**record.signals, key: signal})

    records = tuple(map(change, experiment.records))
    changed = replace(experiment, records=records)
    findings = disagreements(Model.from_experiment(changed), prepare(changed))
    return [f for f in findings if f.topic in ("clock drift", "time shift")]


@pytest.mark.parametrize(
    ("quantity", "rate"),
    [("actuator_force", -2e-3), pytest.param("position", 2e-3, marks=pytest.mark.slow)],
)
def test_a_channel_with_another_clock_is_named_with_the_rate(rod, quantity, rate):
    (finding,) = findings_with(rod, quantity, lambda t: (1.0 + rate) * t)
    assert (finding.topic, finding.concern) == ("clock drift", "warning")
    assert finding.sentence.startswith(quantity)
    assert finding.numbers["rate"] == pytest.approx(rate, rel=0.15)
    assert np.sign(finding.numbers["last"]) == -np.sign(rate)
    assert f"value of time {1.0 + finding.numbers['rate']:.5g} t" in finding.sentence
    # corrected by what it says, no lag is left that grows
    rest = (1.0 + rate) / (1.0 + finding.numbers["rate"])
    left = findings_with(rod, quantity, lambda t: rest * t)
    assert not [f for f in left if f.topic == "clock drift"]


def test_a_constant_lag_is_no_drift(rod):
    (finding,) = findings_with(rod, "actuator_force", lambda t: t - 5e-3)
    assert finding.topic == "time shift"
    # nor is one that jumps in the middle, as where a logger lost rows
    jumps = findings_with(rod, "actuator_force", lambda t: t - 8e-3 * (t > t[-1] / 2))
    assert not [f for f in jumps if f.topic == "clock drift"]
