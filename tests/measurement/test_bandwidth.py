"""The bandwidth that records propose: how far up they tell an acceleration, and a motion."""

from dataclasses import replace

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.measurement.bandwidth import default_bandwidth

RATE = 200.0
STEP = 1e-4


def recorded(amplitude, noise=0.0):
    """A slow sine as an encoder reads it; amplitude and noise (rms) in steps."""
    t = np.arange(6000) / RATE
    scatter = noise * np.random.default_rng(0).standard_normal(len(t))
    x = STEP * np.round(amplitude * np.sin(2 * np.pi * 0.3 * t) + scatter)
    force = np.sign(np.cos(2 * np.pi * 0.3 * t))
    return td.experiment(
        {"t": t, "x": x, "F": force},
        axis="prismatic",
        time="t",
        position={"column": "x", "resolution": STEP},
        actuator_force="F",
        inertia=0.1,
    )


def joined(*frequencies):
    """Records of 20 s, each a sine of one frequency (Hz), 0.2 rad, with noise of a step, 1 mrad."""
    t = np.arange(8000) / 400.0
    step, records = 1e-3, []
    scatter = step * np.random.default_rng(0).standard_normal(len(t))
    for k, f in enumerate(frequencies):
        x = step * np.round((0.2 * np.sin(2 * np.pi * f * t) + scatter) / step)
        columns = {"t": t, "x": x, "F": np.sign(np.cos(2 * np.pi * f * t))}
        records.append(
            td.experiment(
                columns,
                axis="revolute",
                time="t",
                position={"column": "x", "resolution": step},
                actuator_force="F",
                inertia=0.1,
            ).records[0]
        )
        records[-1] = replace(records[-1], file=f"{k}.csv", use="fit" if k == 0 else "check")
    return replace(recorded(1000.0), records=tuple(records))


@pytest.mark.parametrize("frequencies", [(2.6, 0.4), (0.4, 2.6)])
def test_a_slow_record_does_not_cut_off_the_motion_of_a_fast_one(frequencies):
    slow, fast = (default_bandwidth(joined(f, f)) for f in sorted(frequencies))
    together = default_bandwidth(joined(*frequencies))
    assert slow < 2.6 < together == fast


@pytest.mark.parametrize("rate", [100.0, 500.0])
def test_a_motion_of_all_frequencies_is_compared_up_to_a_tenth_of_the_rate(rate):
    random = np.random.default_rng(1)
    t = np.arange(round(20 * rate)) / rate
    x = np.cumsum(np.cumsum(random.standard_normal(len(t)))) / rate**2 + 0.3 * np.sin(3 * t)
    experiment = td.experiment(
        {"t": t, "x": x, "F": np.sign(np.cos(3 * t))},
        axis="prismatic",
        time="t",
        position="x",
        actuator_force="F",
        inertia=0.1,
    )
    assert default_bandwidth(experiment) == pytest.approx(0.1 * rate, rel=0.01)


def runs_at_constant_speed(shaken=0.0, tone=60.0):
    """Runs to both sides at six speeds, as for a Stribeck curve; a sine in steps, tone in Hz."""
    rate, step = 400.0, 1e-3
    speeds = np.outer([0.023, 0.051, 0.083, 0.53, 2.1, 7.9], [1.0, -1.0]).ravel()
    v = np.convolve(np.repeat(speeds, 800), np.hanning(80) / np.hanning(80).sum(), "same")
    t = np.arange(len(v)) / rate
    x = np.cumsum(v) / rate + step * np.random.default_rng(0).normal(0.0, 0.1, len(t))
    x += shaken * step * np.sin(2 * np.pi * tone * t)
    return td.experiment(
        {"t": t, "x": step * np.round(x / step), "F": np.sign(v)},
        axis="revolute",
        time="t",
        position={"column": "x", "resolution": step},
        actuator_force="F",
        inertia=0.1,
    )


def test_lines_that_an_encoder_makes_at_constant_speed_do_not_widen_the_band():
    """The changes of speed end near 10 Hz; lines of steps that pass reach half of the rate."""
    assert default_bandwidth(runs_at_constant_speed()) < 12.0
    # a tone with more power than rounding to the steps is a motion
    assert 29.0 < default_bandwidth(runs_at_constant_speed(shaken=3.0, tone=30.0)) < 31.0
