"""Checks of channels and clocks with the event just inside and just outside of each limit."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from check.made_channels import (
    H,
    channel,
    clipped,
    clock_errors,
    leaps,
    outliers,
    record_of,
    repeated,
    wrong_noise,
)

from teleopdesign.check import sample_clock
from teleopdesign.check.flat_channels import visits
from teleopdesign.measurement import log_clock
from teleopdesign.measurement.channel import Channel
from teleopdesign.measurement.encoder import is_on_grid
from teleopdesign.measurement.motion import without_mains
from teleopdesign.measurement.record_clock import RecordClock
from teleopdesign.measurement.tables import LogColumns
from teleopdesign.measurement.time_grid import stamps_are_true

# clipping


@pytest.mark.parametrize(
    ("coming", "counts"),
    [
        ([4, 4, 4], True), ([4, 3, 2], False), ([5, 3, 3], True), ([2, 3, 4], True),
        ([5, 5, 3], True), ([6, 5, 3], False), ([3, 3, 2], False), ([3, 3, 3], True),
        ([4, -4, 4], False), ([-4, -4, -4], False),
    ],
)  # fmt: skip
def test_a_limit_is_reached_with_three_steps_and_less_than_half_the_speed_lost(coming, counts):
    """The deceleration is per sample, over the two changes before the last."""
    rise = 100.0 - 4.0 - np.cumsum(coming[::-1])[::-1]
    x = np.array([*rise, 96.0, *[100.0] * 3, 97.0])
    assert visits(x, 100.0, 1.0, noisy=False) == counts
    assert visits(x, 100.0, 1.0, noisy=True) == 1
    assert visits(np.delete(x, -2), 100.0, 1.0, noisy=True) == 0, "two samples are few"
    assert visits(x[1:], 100.0, 1.0, noisy=True) == 0, "three before it are few"


@pytest.mark.parametrize(("times", "reported"), [(2, False), (3, True)])
def test_three_visits_to_a_limit_are_reported(times, reported):
    one = [0, 4, 8, 12, 16, 20, 20, 20, 20, 14, 8, 2]
    x = np.array([*one * times, *range(0, -40, -3)], dtype=float)
    result = clipped(channel(x, step=1.0))
    assert len(result) == reported
    if reported:
        part = 4 * times / len(x)
        assert result[0].numbers == {"value": 20.0, "count": times, "part": pytest.approx(part)}
        assert f"{100 * part:.2g} % of the samples" in result[0].sentence


# the grid of an encoder, outliers and jumps


def test_every_reading_of_a_short_record_counts_for_its_grid():
    assert not is_on_grid(0.5 * np.arange(1000.0), 1.0), "every second one lies on it"
    assert is_on_grid(np.arange(1000.0), 1.0)
    assert is_on_grid(0.3 + np.arange(1000.0), 1.0), "whatever the origin"


@pytest.mark.parametrize(
    ("row", "is_odd"), [(3, False), (4, True), (300, True), (595, True), (596, False)]
)
def test_a_lone_sample_needs_four_others_on_both_sides(row, is_odd):
    x = np.random.default_rng(1).normal(size=600)
    x[row] += 100.0
    assert [f.numbers["row"] for f in outliers(channel(x))] == [row + 1] * is_odd


@pytest.mark.parametrize(
    ("value", "is_odd"), [(12.9, False), (13.1, True), (9.1, False), (8.9, True)]
)
def test_a_command_is_off_where_it_leaves_the_range_of_all_others_by_half_of_it(value, is_odd):
    x = 11.0 + np.sin(2e-3 * np.pi * np.arange(4000))
    x[2000] = value
    assert bool(outliers(channel(x, "actuator_force"))) == is_odd
    assert outliers(channel(x, "interaction_force")), "a measured force is, whatever its range"


@pytest.mark.parametrize(("lost", "words"), [(0.4, False), (0.6, True), (990, True), (1010, False)])
def test_a_leap_by_half_a_sample_to_a_thousand_may_be_missing_samples(lost, words):
    x = np.arange(2000.0) + 1e-3 * np.random.default_rng(0).normal(size=2000)
    x[700:] += lost
    (finding,) = leaps(channel(x))
    assert finding.numbers["samples"] == pytest.approx(lost, rel=0.05)
    assert ("if samples are missing" in finding.sentence) == words


def test_repeated_samples_of_a_later_stretch_are_counted_from_the_first_row_of_the_record():
    x = 100.0 * np.arange(400.0)
    x[300] = x[299]
    (finding,) = repeated(channel(x, step=1.0, segments=(slice(0, 150), slice(150, 400))))
    assert finding.numbers["time"] == pytest.approx(0.300) and finding.numbers["count"] == 1
    assert finding.concern == "note"
    x[250:299:4] = x[249:298:4]  # more than a twentieth of those in motion
    x[160:250:4] = x[159:249:4]
    (finding,) = repeated(channel(x, step=1.0, segments=(slice(0, 150), slice(150, 400))))
    assert finding.numbers["part"] > 0.05 and finding.concern == "warning"


@pytest.mark.parametrize(("scatter", "is_wrong"), [(0.0307, False), (0.01, True), (0.06, True)])
def test_stated_noise_counts_with_the_rounding_of_its_resolution(scatter, is_wrong):
    """0.01 and 0.29 steps of 0.1: 0.0307 in all, within a factor of 1.6."""
    x = scatter * np.random.default_rng(3).standard_normal(4000)
    findings = wrong_noise(channel(x, noise=0.01, resolution=0.1))
    assert [f.topic for f in findings] == ["noise"] * is_wrong


def test_hum_is_that_of_the_longest_stretch():
    """The position shows the tone in the second stretch alone, which is shorter."""
    t = H * np.arange(9000)
    tone, noise = np.sin(2 * np.pi * 50.0 * t), np.random.default_rng(4).standard_normal(9000)
    force, parts = 0.5 * tone + 0.02 * noise, (slice(0, 5000), slice(5000, 9000))
    record = replace(record_of(9000, parts), signals={"a.position": np.where(t < 5.0, t, tone)})
    record.signals["f"] = force
    assert without_mains(record, "f") == pytest.approx(0.02 * noise, abs=0.02)
    record.signals["a.position"] = np.where(t < 4.0, tone, t)
    assert without_mains(record, "f") is force


# stamps and clocks


@pytest.mark.parametrize(
    ("part", "concern"), [(0.009, None), (0.011, "note"), (0.049, "note"), (0.051, "warning")]
)
def test_stamps_off_by_a_hundredth_are_noted_and_by_a_twentieth_a_warning(
    monkeypatch, part, concern
):
    record = record_of(1500)
    off = part * H * np.where(np.arange(1500) % 2, 1.0, -1.0)
    monkeypatch.setattr(sample_clock, "stamps_of", lambda *_: record.time + off)
    result = [f for f in clock_errors(record) if f.concern != "fine"]
    assert [f.concern for f in result] == ([] if concern is None else [concern])
    if result:
        numbers = result[0].numbers
        assert numbers["rate"] == pytest.approx(1000.0)
        assert numbers["jitter"] == pytest.approx(part * H) == numbers["worst"]
        assert f"{part:.3g} ms rms off a uniform clock of 1000 Hz" in result[0].sentence
        assert f"{100 * part:.2g} % of a sample, {part:.3g} ms at worst" in result[0].sentence
        assert len(result[0].graph.series[0].x) == 1500, "all points of a short record"


def test_stamps_are_read_in_the_unit_of_their_channel(tmp_path):
    (tmp_path / "a.csv").write_text("t,x\n0,1\n2,1\n4,1\n")
    for unit, second in (("ms", 2e-3), ("s", 2.0)):
        known = {"time": Channel("time", None, "t", unit, None, None)}
        experiment = SimpleNamespace(channels=known, folder=tmp_path, bodies={})
        record = SimpleNamespace(file="a.csv", time=np.zeros(3))
        assert sample_clock.stamps_of(experiment, record) == pytest.approx(
            [0.0, second, 2 * second]
        )
        assert (
            sample_clock.stamps_of(experiment, SimpleNamespace(file="b.csv", time=np.zeros(3)))
            is None
        )
        few = SimpleNamespace(file="a.csv", time=np.zeros(2))
        assert sample_clock.stamps_of(experiment, few) is None
    missing = {"time": Channel("time", None, "other", "s", None, None)}
    assert (
        sample_clock.stamps_of(
            SimpleNamespace(channels=missing, folder=tmp_path, bodies={}), record
        )
        is None
    )


def made_clock(off, **more):
    """Rows on a grid of 1 ms, with stamps that are off by parts of it."""
    n = len(off)
    places, whole = np.arange(n), (slice(0, n),)
    known = RecordClock(places, H * (places + off), places, H * places, H, whole, whole)
    return replace(known, **more)


POSITION = {"device.position": Channel("position", "device", "x", "m", None, None)}


def test_stamps_of_no_clock_say_rate_and_steps_and_what_even_ones_would_cost():
    off = np.where(np.arange(101) % 2, 0.25, -0.25)
    columns = LogColumns({"x": 5.0 * np.arange(101.0)})
    made = made_clock(off, jitter=np.inf)
    stamped, (step,) = log_clock._stamps(made, columns, POSITION, "a.csv")
    assert stamped and step.interpolates and step.topic == "sample clock"
    assert dict(step.numbers) == pytest.approx({"rate": 1000.0, "shortest": 0.5, "longest": 1.5})
    assert step.observed == "uneven stamps, steps of 0.5 to 1.5 times 0.001 s"
    speed = np.gradient(columns.values["x"], made.stamps)
    lost = 100 * np.sqrt(np.mean((speed * 0.25 * H) ** 2)) / 500.0
    assert step.effect == f"read as even, positions would err by {lost:.2g} % of the travel"
    assert log_clock._effect_of_even_stamps(made, []) == "none"


@pytest.mark.parametrize(
    ("slope", "error", "follows", "hardly"),
    [(0.9, 0.13, True, False), (0.9, 0.14, True, True), (0.1, 0.13, False, False),
     (0.1, 0.14, False, True), (1.0, np.inf, False, True), (0.4, 0.01, False, False)],
)  # fmt: skip
def test_positions_decide_whether_stamps_are_true_by_three_standard_errors(
    monkeypatch, slope, error, follows, hardly
):
    monkeypatch.setattr(log_clock, "stamps_are_true", lambda *_: (slope, error))
    columns = LogColumns({"x": np.arange(101.0)})
    made = made_clock(np.where(np.arange(101) % 2, 0.1, -0.1), jitter=1e-4)
    stamped, (step,) = log_clock._stamps(made, columns, POSITION, "a.csv")
    assert stamped == follows == step.interpolates
    assert step.effect.startswith("the position hardly tells") == hardly
    assert step.observed == "stamps 10 % of a row off an even clock"
    assert dict(step.numbers) == pytest.approx({"jitter": 1e-4, "rate": 1000.0, "followed": slope})
    even = made_clock(np.zeros(101), jitter=1e-5)
    assert log_clock._stamps(even, columns, POSITION, "a.csv") == (False, [])


def test_whether_stamps_are_true_is_that_of_a_regression_by_hand():
    """Second differences of the reading over those of speed times lateness; six count as one."""
    random = np.random.default_rng(3)
    off = 0.1 * random.standard_normal(40)
    x = np.cumsum(random.uniform(1.0, 2.0, 40))
    made = made_clock(off)
    slope, error = stamps_are_true(made, [x])
    late = H * (off - off.mean())
    speed = np.zeros(40)
    for k in range(1, 39):
        speed[k] = (x[k + 1] - x[k - 1]) / (2 * H)
    y = np.array([x[k - 1] - 2 * x[k] + x[k + 1] for k in range(2, 38)])
    product = speed * late
    z = np.array([product[k - 1] - 2 * product[k] + product[k + 1] for k in range(2, 38)])
    by_hand = float(z @ y / (z @ z))
    left = y - by_hand * z
    assert slope == pytest.approx(by_hand)
    assert error == pytest.approx(np.sqrt(6 * (left @ left) / len(y) / (z @ z)))
    four = replace(made, of_rows=(slice(0, 36), slice(36, 40)))
    five = replace(made, of_rows=(slice(0, 35), slice(35, 40)))
    assert stamps_are_true(four, [x])[0] != pytest.approx(stamps_are_true(five, [x])[0])
