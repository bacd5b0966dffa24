"""Spikes: what is read as lost, and what is no spike."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.measurement.spikes import fill_spikes, find_spikes

T = np.arange(3000) / 500.0


def motion(step=1e-5):
    x = 0.05 * np.sin(2 * np.pi * 0.7 * T) + 0.01 * np.sin(2 * np.pi * 3.1 * T)
    return step * np.round(x / step)


@settings(max_examples=30)
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([1, 3, 30, 90]),
    st.sampled_from([3e-2, 0.5, 1e3]),
)
def test_the_search_marks_spikes_of_any_number_and_size_and_no_other_reading(seed, count, size):
    rng = np.random.default_rng(seed)
    rows = rng.choice(np.arange(3, len(T) - 3), count, replace=False)
    there = np.bincount(rows, minlength=len(T))
    about, in_a_row = (np.convolve(there, np.ones(n), "same") for n in (7, 3))
    x = motion()
    x[rows] += size * rng.choice([-1, 1], count) * rng.uniform(1, 3, count)
    spikes = find_spikes(x, 1e-5)
    # among four spikes of seven rows, the other readings are those far off the course
    assert not spikes[(there == 0) & (about <= 3)].any()
    if about.max() <= 3 and in_a_row.max() <= 2:  # three in a row: an impact
        assert spikes[rows].all()
        np.testing.assert_allclose(fill_spikes(x, spikes), motion(), atol=4e-5)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e12])
@pytest.mark.parametrize(
    "signal",
    [
        np.where(T > 3, 1.0, 0.0),  # a step
        np.abs((T % 1.0) - 0.5),  # a triangle
        np.where((T > 2) & (T < 2.01), 1.0, 0.0),  # an impact of five rows
        np.where(np.arange(len(T)) % 2 == 0, 1.0, -1.0),  # chatter
        np.where(np.arange(len(T)) % 500 == 7, 1e-5, 0.0),  # one step of an encoder
        np.zeros(len(T)),
        np.random.default_rng(1).standard_normal(len(T)),
        np.random.default_rng(2).standard_t(3, len(T)),
        motion(),
        np.round(motion() / 1e-3) * 1e-3,
        np.sign(np.sin(7 * T)) * (1 + 0.1 * np.sin(90 * T)),
    ],
)
def test_steps_impacts_chatter_and_noise_hold_no_spike(signal, scale):
    assert not find_spikes(scale * signal, scale * 1e-5).any()


def hits(rows, *, move):
    """A body of 0.2 kg at rest, hit for one row at a time; it moves, or its sensor errs."""
    force = 0.01 * np.random.default_rng(4).standard_normal(len(T))
    force[rows] += 20.0
    speed = np.cumsum(force if move else 0 * force) * 2e-3 / 0.2 + 0.01 * np.sin(5 * T)
    return force, np.cumsum(speed) * 2e-3


@pytest.fixture
def spoilt():
    """Columns without and with spikes, and the rows of these."""
    noise = 1e-3 * np.random.default_rng(3).standard_normal(len(T))
    true = {"x": motion(), "u": np.sin(3 * T), "f": 0.3 * np.cos(2 * T) + noise}
    rows = {"x": np.array([100, 900, 2400]), "f": np.array([50, 2000]), "u": np.array([700])}
    bad = {name: y.copy() for name, y in true.items()}
    for name, at in rows.items():
        bad[name][at] = 9.0
    return true, bad, rows


def read(columns, **more):
    """The only record of an experiment on these columns."""
    names = {"time": "t", "position": "x", "actuator_force": "u", "interaction_force": "f"}
    (record,) = td.experiment(
        {"t": T} | columns, axis="prismatic", inertia=0.2, **(names | more)
    ).records
    return record


def counts(record):
    """Spikes of each channel, as the reading states them."""
    steps = [s for s in record.reading if s.topic == "outliers"]
    return {s.observed.split(":")[0]: dict(s.numbers)["count"] for s in steps}


def test_a_log_with_spikes_is_read_as_the_log_without(spoilt):
    true, bad, rows = spoilt
    record = read(bad)
    position, force = (record.signals[f"device.{n}"] for n in ("position", "interaction_force"))
    np.testing.assert_allclose(position, true["x"], atol=2.1e-5)
    np.testing.assert_allclose(force, true["f"], atol=8e-3)
    assert counts(record) == {"position": 3, "interaction_force": 2}
    (step,) = [s for s in record.reading if s.observed.startswith("position")]
    assert dict(step.numbers)["row"] - 1 in rows["x"]
    assert dict(step.numbers)["size"] == pytest.approx(9.0, abs=0.1)
    # filled readings lie on the steps of the encoder, which are then estimated from the readings
    np.testing.assert_allclose(position, 1e-5 * np.round(position / 1e-5), atol=1e-12)
    assert counts(read(true)) == {}


def test_a_command_may_have_any_value_and_a_measured_current_not(spoilt):
    true, bad, rows = spoilt
    assert read(true | {"u": bad["u"]}).signals["device.actuator_force"][700] == 9.0
    measured = {"column": "u", "unit": "N", "measured": True}
    record = read(true | {"u": bad["u"]}, actuator_force=measured)
    assert counts(record) == {"actuator_force": 1}
    np.testing.assert_allclose(record.signals["device.actuator_force"], true["u"], atol=1e-6)


def test_hits_that_move_the_body_stay_in_the_log():
    force, position = hits(np.array([400, 1000, 1700, 2500]), move=True)
    columns = {"x": position, "u": 0.01 * np.sin(5 * T), "f": force}
    assert counts(read(columns)) == {}
    columns["x"] = hits(np.array([400]), move=False)[1]
    assert counts(read(columns)) == {"interaction_force": 4}
