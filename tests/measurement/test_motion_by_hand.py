"""The motion that readings leave of a body, and the forces along it."""

from dataclasses import replace

import numpy as np
import pytest

from teleopdesign.measurement.channel import Channel
from teleopdesign.measurement.conversion import Conversion
from teleopdesign.measurement.hum import hum_of
from teleopdesign.measurement.motion import (
    SHORTEST,
    LinkForces,
    direction_of,
    motion_of,
    motions,
    without_mains,
)
from teleopdesign.measurement.reading import ReadingStep
from teleopdesign.measurement.record import Record
from teleopdesign.measurement.record_clock import RecordClock
from teleopdesign.measurement.time_grid import clock_of

H = 0.002
T = H * np.arange(6000)
SWING = np.sin(2 * np.pi * 0.6 * T) + 0.4 * np.sin(2 * np.pi * 1.7 * T + 1.0)


def made(position, *, bandwidth=20.0, resolution=1e-6, command=None, sample_time=H):
    n = len(position)
    return motion_of(
        body="device",
        file="fit.csv",
        time=sample_time * np.arange(n),
        position=position,
        command=np.zeros(n) if command is None else command,
        interaction=None,
        sample_time=sample_time,
        rows=slice(0, n),
        bandwidth=bandwidth,
        resolution=resolution,
    )


def test_a_step_that_is_not_stated_is_read_and_noise_counts_for_more():
    rng = np.random.default_rng(3)
    read = 1e-4 * np.round(SWING / 1e-4)
    assert made(read, resolution=None).step == pytest.approx(1e-4, rel=0.02)
    assert made(read, resolution=3e-4).step == 3e-4
    for part, counts in [(0.3, False), (1.0, True)]:
        noisy = SWING + 1e-3 * part * rng.standard_normal(len(T))
        step = made(1e-3 * np.round(noisy / 1e-3), resolution=1e-3).step
        # rounding adds 0.29 of a step
        expected = 4e-3 * np.hypot(part, 12**-0.5) if counts else 1e-3
        assert step == pytest.approx(expected, rel=0.1)
    for noise in (1e-3, 1e-2):  # far above the steps: four times its rms
        noisy = SWING + noise * rng.standard_normal(len(T))
        assert made(noisy).step == pytest.approx(4 * noise, rel=0.1)


def test_where_the_velocity_is_below_what_readings_leave_no_direction_is_reported():
    """A motion that grows: what is told of it is its sign; a coarser reading tells less."""
    for step in (1e-5, 1e-2):
        motion = made(step * np.round(SWING * T / T[-1] / step), resolution=step)
        moving = motion.direction != 0
        inner = slice(300, -300)
        right = motion.direction[inner] == np.sign(np.gradient(SWING * T / T[-1], H))[inner]
        assert right[moving[inner]].mean() > 0.97
    fine, coarse = (
        np.mean(made(s * np.round(SWING / s), resolution=s).direction != 0) for s in (1e-5, 1e-2)
    )
    assert coarse < 0.9 < 0.95 < fine
    assert not made(np.zeros(2000)).direction.any()


def test_smoothing_passes_the_band_of_the_comparison_and_no_more_than_the_rows_bear():
    motion = made(SWING, bandwidth=20.0)
    gain = np.interp([1.0, 20.0, 30.0, 45.0], motion.spectrum.frequency, motion.smoothing)
    assert gain[0] > 0.9999 and gain[1] > 0.998 and gain[3] < 0.01
    assert gain[2] == pytest.approx(0.5, abs=0.02), "at one and a half times the bandwidth"
    wide = made(SWING, bandwidth=400.0)
    half = np.interp(0.45 / H, wide.spectrum.frequency, wide.smoothing)
    assert half == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize("parts", [1, 2, 5])
@pytest.mark.parametrize("late", [0.0, 0.004])
def test_a_held_force_acts_at_the_rows_as_its_mean_and_as_late_as_its_log(parts, late):
    """A sine of which each part of a row holds the value at its beginning."""
    w = 2 * np.pi * 3.0
    begins = H * np.arange(len(T) * parts) / parts
    motion = replace(made(SWING), command_late=late)
    command = motion.at_rows(np.sin(w * (begins - late)))
    inner = slice(600, -600)
    expected = np.sin(w * (T - 0.5 * H / parts))[inner]
    assert command[inner] == pytest.approx(expected, abs=2e-3)
    two = motion.at_rows(np.stack([np.sin(w * (begins - late)), np.ones(len(begins))]))
    assert two[0] == pytest.approx(command) and two[1] == pytest.approx(1.0)


def test_the_force_of_links_is_the_known_one_and_each_base_parameter_less_the_joints_inertia():
    constant, columns = np.array([1.0, 2.0]), np.array([[1.0, 0.0], [2.0, 4.0]])
    acceleration = np.array([10.0, -10.0])
    links = LinkForces(constant, columns, columns, inertia=0.3)
    assert links.carried((0.5, 2.0), acceleration) == pytest.approx([1 + 4.5 - 3, 2 + 8 + 3])
    assert links.carried((), acceleration) == pytest.approx([-2.0, 5.0])


def record_of(segments, force=None, hand=None):
    signals = {
        "device.position": SWING,
        "device.actuator_force": np.cos(T) if force is None else force,
    }
    if hand is not None:
        signals["device.interaction_force"] = hand
    return Record("fit.csv", "fit", frozenset(), T, H, segments, signals)


def test_stretches_long_enough_to_be_trimmed_are_motions():
    rows = round(SHORTEST / H)
    segments = (slice(0, rows), slice(rows, 2 * rows - 1), slice(2 * rows, 5000))
    record = record_of(segments, hand=np.sin(T))
    stretches = motions(record, "device", bandwidth=20.0, resolution=1e-6)
    assert [m.rows for m in stretches] == [segments[0], segments[2]]
    last = stretches[-1]
    assert np.array_equal(last.time, T[segments[2]])
    assert np.array_equal(last.command, np.cos(T)[segments[2]])
    assert last.interaction[300:-300] == pytest.approx(np.sin(T)[segments[2]][300:-300], abs=1e-3)
    assert not motions(record_of(segments), "device", bandwidth=20.0, resolution=1e-6)[
        0
    ].interaction.any()


def test_a_hum_is_taken_off_each_stretch_with_the_phase_that_it_has_there():
    rng = np.random.default_rng(5)
    plain = np.cos(2 * np.pi * 0.8 * T) + 0.01 * rng.standard_normal(len(T))
    segments = (slice(0, 3600), slice(3600, 6000))
    phase = np.where(np.arange(6000) < 3600, 0.3, 2.1)
    hummed = plain + 0.2 * np.sin(2 * np.pi * 50.02 * T + phase)
    left = without_mains(record_of(segments, hummed), "device.actuator_force") - plain
    assert np.sqrt(np.mean(left**2)) < 0.02
    assert without_mains(record_of(segments, plain), "device.actuator_force") is plain
    hum = hum_of(hummed[segments[0]], [SWING[segments[0]]], H)
    assert hum.mains == 50.0 and hum.frequency == pytest.approx(50.02, abs=0.01)
    assert hum.rms == pytest.approx(0.2 / 2**0.5, rel=0.05)


@pytest.mark.parametrize(
    ("changes", "patience", "moving"),
    [
        ({10: 5.0, 12: 5.0}, 3, {(10, 12): 1}),  # two changes are a motion
        ({10: 5.0}, 3, {}),  # one is none
        ({10: -5.0, 12: -5.0}, 3, {(10, 12): -1}),
        ({10: 5.0, 13: 5.0}, 3, {(10, 13): 1}),
        ({10: 5.0, 14: 5.0}, 3, {}),  # rests between them
        ({10: 5.0, 12: -5.0}, 3, {}),
        ({10: 5.0, 12: 5.0, 15: -4.0, 16: -4.0}, 3, {(10, 12): 1, (15, 16): -1}),
        ({10: 0.7, 11: 0.7, 12: 0.7, 13: 0.7}, 3, {(10, 13): 1}),
        ({10: 0.4, 11: 0.4, 12: 0.4, 13: 0.4, 14: 9.0, 15: 9.0}, 3, {(14, 15): 1}),
        ({10: 0.7, 11: 0.7}, 3, {}),  # too short a way
    ],
)
@pytest.mark.parametrize("step", [1e-6, 1.0, 1e3])
def test_a_motion_is_changes_one_way_that_follow_each_other_over_some_steps(
    changes, patience, moving, step
):
    """From the first change to the one before the last."""
    x = np.zeros(30)
    for row, by in changes.items():
        x[row:] += step * by
    expected = np.zeros(30)
    for (a, b), way in moving.items():
        expected[a:b] = way
    assert direction_of(x, step, step, patience).tolist() == expected.tolist()


def test_a_motion_and_a_clock_are_plain_unless_stated_otherwise():
    """A log on time, of a sensor without lag, each row used; an even clock without a flaw."""
    motion = made(SWING)
    assert (motion.command_late, motion.interaction_late, motion.merged) == (0.0, 0.0, 1)
    assert motion.links is None and motion.carried is None and not motion.further
    force = LinkForces(np.ones(3), np.zeros((0, 3)), np.zeros((0, 3)))
    assert force.inertia == 0.0 and force.drawn == ()
    assert force.carried((), 5.0 * np.ones(3)).tolist() == [1.0, 1.0, 1.0]
    rows, whole = np.arange(200), (slice(0, 200),)
    clock = RecordClock(rows, 0.01 * rows, rows, 0.01 * rows, 0.01, whole, whole)
    assert clock.exact and not clock.counted and clock.jitter == clock.longest_gap == 0.0
    assert not any(
        (clock.dropped, clock.sorted, clock.restarts, clock.lost, clock.alone, clock.gaps)
    )
    even = clock_of(0.01 * rows, whole, np.zeros(200, dtype=bool), "log")
    assert even.exact and even.lost == even.gaps == even.dropped == even.sorted == 0
    step = ReadingStep("a", "b", "c", "d")
    assert np.isnan(step.size) and not step.interpolates and step.numbers == ()
    channel = Channel("position", "device", "x", "m", None, None)
    assert not channel.measured and channel.conversion is None and channel.delay == 0.0
    plain = Conversion(("x",), (1.0,))
    assert plain.is_plain and plain.signal({"x": np.array([2.0])}).tolist() == [2.0]
