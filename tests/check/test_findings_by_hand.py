"""Leaps, held samples and limits of single channels: what is said, with which numbers."""

import numpy as np
import pytest
from check.made_channels import H, channel, clipped, flat, leaps, outliers, repeated, slower, swing

# leaps


def leaping(by, unit="rad", row=700):
    x = swing()
    x[row:] += by
    return channel(x, unit=unit)


@pytest.mark.parametrize("part", [-1.04, 0.96, 1.0])
def test_a_leap_by_about_a_turn_asks_for_an_angle_to_be_unwrapped(part):
    (finding,) = leaps(leaping(part * 2 * np.pi))
    assert "jumps once, most at 0.699 s (row 700)" in finding.sentence
    assert "unwrap = true" in finding.sentence and finding.stops
    assert finding.numbers["size"] == pytest.approx(part * 2 * np.pi, abs=1e-3)


@pytest.mark.parametrize(("part", "unit"), [(1.2, "rad"), (0.8, "rad"), (2.0, "rad"), (1.0, "m")])
def test_a_leap_by_anything_else_is_no_turn(part, unit):
    (finding,) = leaps(leaping(part * 2 * np.pi, unit))
    assert "turn" not in finding.sentence and "unwrap" not in finding.sentence


def test_a_leap_is_shown_with_the_samples_before_and_after_it():
    (finding,) = leaps(leaping(3.0))
    marked = finding.graph.series[1]
    assert marked.x.tolist() == pytest.approx([0.699, 0.7])
    assert marked.y[1] - marked.y[0] == pytest.approx(3.0, abs=0.02)


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("sample", ["before", "after"])
def test_a_reading_that_was_held_and_catches_up_does_not_leap(sample, way):
    """At a hundred steps a sample: a sample is held, the next one is where it would be."""
    x = way * 100.0 * np.arange(2000.0) + np.random.default_rng(0).normal(size=2000)
    assert leaps(channel(x)) == []
    x[700:] += way * 1000.0
    assert len(leaps(channel(x))) == 1
    if sample == "before":
        x[698] = x[699]
    else:
        x[701] = x[700]
    assert leaps(channel(x)) == []


@pytest.mark.parametrize("off", [5, 7, 9])
def test_a_body_that_sticks_for_a_row_as_it_turns_round_does_not_leap(off):
    """Its speed changes by less there than from row to row elsewhere: "no body does that"."""
    change = np.round(140 * np.sin(0.12 * np.arange(3000)))
    # a reversal: down to a row of rest, and on with the friction of the other direction
    change[1500:1512] = [102, 85, 68, 51, 34, 17, 0, -17 + off, *range(-28, -68, -10)]
    change[1512:] = np.round(140 * np.sin(0.12 * np.arange(3000 - 1512) + np.pi + 0.5))
    x = np.cumsum(change)
    assert leaps(channel(x, step=1.0)) == []
    x[1700:] += 400  # more than any change of speed
    assert len(leaps(channel(x, step=1.0))) == 1


@pytest.mark.parametrize("size", [10.0, 40.0, 1e3])
def test_a_lone_sample_is_no_leap_whatever_its_size(size):
    for seed in range(20):
        x = np.random.default_rng(seed).normal(size=600)
        x[300] += size
        assert leaps(channel(x)) == []


# samples that are held


def held_in_turn(every, n=4000, off=0, part=0.0):
    """A scatter that changes every so many samples, a part of the changes `off` samples late."""
    random = np.random.default_rng(0)
    at = np.arange(0, n, every)
    at[1:] += off * (random.random(len(at) - 1) < part)
    values = np.zeros(n)
    for k, a in enumerate(at):
        values[a:] = k % 2 + 0.01 * k
    return channel(values, "interaction_force")


@pytest.mark.parametrize("every", [2, 3, 10])
def test_a_channel_of_a_slower_source_says_its_rate(every):
    for signal in (held_in_turn(every), held_in_turn(every, off=1, part=0.02)):
        (finding,) = slower(signal)
        assert f"changes only every {every} samples" in finding.sentence
        assert f"the log at {1 / H:.4g} Hz" in finding.sentence
        assert finding.numbers == {"samples": every, "rate": pytest.approx(1 / H / every)}


@pytest.mark.parametrize(
    ("name", "quantity", "advised"),
    [
        ("slave.position", "position", True),
        ("position", "position", False),
        ("slave.actuator_force", "actuator_force", False),
    ],
)
def test_a_body_that_is_logged_more_slowly_than_another_is_to_be_diagnosed_alone(
    name, quantity, advised
):
    """Its Stribeck friction was lost in the jitter that its repeated rows seem to show."""
    values = held_in_turn(4).values
    (finding,) = slower(channel(values, quantity, name=name))
    assert (
        "diagnose the slave in an experiment with its channels alone" in finding.sentence
    ) == advised


def test_a_channel_that_changes_at_odd_times_or_always_has_no_rate():
    assert slower(held_in_turn(1)) == []
    assert slower(held_in_turn(10, off=1, part=0.4)) == []
    position = [channel(held_in_turn(10, n=n).values, "position") for n in (500, 520)]
    assert slower(position[0]) == []  # fifty changes, 49 distances
    assert len(slower(position[1])) == 1


def test_a_current_that_is_read_every_eighth_row_shows_it_in_few_seconds():
    """A force takes no even times, as a position at constant speed does: twenty changes tell."""
    short, long = (held_in_turn(8, n=n).values for n in (160, 176))
    assert slower(channel(short, "actuator_force")) == []
    assert slower(channel(long, "position")) == []
    (finding,) = slower(channel(long, "actuator_force"))
    assert "changes only every 8 samples" in finding.sentence
    assert "of a measured force, what is faster than half of this rate is lost" in finding.sentence
    relay = np.repeat(np.arange(22) % 2, 8).astype(float)
    assert slower(channel(relay, "actuator_force")) == [], "a test by steps"


def stuck_at(*holds):
    x = 100.0 * np.sin(2 * np.pi * 3.0 * H * np.arange(4000))
    for a, b in holds:
        x[a:b] = x[a]
    return channel(x)


def test_a_stuck_channel_is_reported_from_its_first_to_its_last_sample():
    (finding,) = flat(stuck_at((1005, 1100)))
    assert (finding.numbers["from"], finding.numbers["to"]) == (
        pytest.approx(1.005),
        pytest.approx(1.099),
    )
    assert "from 1.005 to 1.099 s: cut that out" in finding.sentence
    assert finding.numbers["duration"] == pytest.approx(0.095) and finding.numbers["count"] == 1


def test_of_several_stuck_stretches_the_longest_is_reported_and_all_are_counted():
    (finding,) = flat(stuck_at((1005, 1040), (2000, 2095), (3010, 3040)))
    assert "from 2 to 2.094 s (3 times, 0.16 s in all)" in finding.sentence
    assert finding.numbers["duration"] == pytest.approx(0.16)


def test_samples_that_a_log_repeats_are_counted_among_those_in_motion():
    """One in twenty is worth knowing, one in five needs care; what rests does not count."""
    x = np.concatenate([np.zeros(3000), 10.0 * np.arange(1000)])
    for every, concern, share in ((20, "note", 0.05), (5, "warning", 0.2)):
        y = x.copy()
        at = np.arange(3025, 3975, every)
        y[at] = y[at - 1]
        (finding,) = repeated(channel(y, step=1.0))
        assert finding.concern == concern
        assert finding.numbers["count"] == len(at)
        assert finding.numbers["part"] == pytest.approx(share, abs=0.01)
    assert repeated(channel(y, "interaction_force", step=1.0)) == []


@pytest.mark.parametrize(
    ("quantity", "concern", "words"),
    [
        ("actuator_force", "note", "the command does not change"),
        ("position", "warning", "the body never moves"),
        ("interaction_force", "warning", "not connected"),
    ],
)
def test_a_channel_that_says_one_value_is_reported_with_what_that_may_mean(
    quantity, concern, words
):
    (finding,) = flat(channel(np.full(100, 2.5), quantity))
    assert finding.concern == concern and words in finding.sentence
    assert finding.numbers["value"] == 2.5
    assert flat(channel(np.arange(100.0), quantity)) == []


# limits


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("quantity", ["actuator_force", "interaction_force"])
def test_a_limit_of_a_command_may_be_meant_and_one_of_a_sensor_is_not(quantity, side):
    """Told with its share, shown from the first sample at it."""
    y = side * np.minimum(swing(4600), 0.8)[600:]
    (finding,) = clipped(channel(y, quantity, step=1e-6))
    is_command = quantity == "actuator_force"
    assert finding.concern == ("note" if is_command else "warning")
    assert ("fine if the command itself is limited" in finding.sentence) == is_command
    assert ("the channel is clipped" in finding.sentence) == (not is_command)
    at = np.flatnonzero(np.abs(y) == 0.8)
    assert finding.numbers["part"] == pytest.approx(len(at) / len(y))
    assert finding.numbers["count"] == 5
    assert ("largest" if side > 0 else "smallest") in finding.sentence
    begins = finding.graph.series[0].x[0]
    assert begins == pytest.approx((at[0] - 100) * H)


@pytest.mark.parametrize("row", [150, 450, 550])
def test_a_lone_sample_or_leap_of_a_later_stretch_is_reported_by_its_row_in_the_record(row):
    halves = (slice(0, 300), slice(300, 600))
    x = np.random.default_rng(0).normal(size=600)
    x[row] += 100.0
    (finding,) = outliers(channel(x, "actuator_force", segments=halves))
    assert finding.numbers["row"] == row + 1 and finding.numbers["time"] == pytest.approx(row * H)
    x[row] -= 100.0
    x[row:] += 100.0 * (np.arange(row, 600) < halves[row >= 300].stop)
    (finding,) = leaps(channel(x, segments=halves))
    assert finding.numbers["time"] == pytest.approx((row - 1) * H)


@pytest.mark.parametrize(
    ("lost", "is_counted"),
    [(0.45, False), (0.55, True), (1.4, True), (-3.0, False), (990.0, True)],
)
def test_a_leap_along_the_motion_says_how_many_samples_may_be_missing(lost, is_counted):
    """A cart at 1 m/s, read to a nanometre; from half a sample on."""
    x = H * np.arange(2000.0)
    x[1000:] += lost * H
    (finding,) = leaps(channel(x))
    assert finding.numbers["samples"] == pytest.approx(lost, rel=1e-6)
    assert ("if samples are missing" in finding.sentence) == is_counted
    assert ("look at the encoder or the log" in finding.sentence) != is_counted
    assert f"in {lost:.0f} samples" in finding.sentence or not is_counted


@pytest.mark.parametrize("short", [4, 15])
@pytest.mark.parametrize("where", ["before", "after"])
def test_a_stretch_too_short_to_be_judged_moves_no_finding_of_another(short, where):
    """A stretch of few samples says nothing, whatever is in it."""
    x = np.r_[swing(short), swing()] if where == "before" else np.r_[swing(), swing(short)]
    begin = short if where == "before" else 0
    cuts = (
        (slice(0, short), slice(short, len(x))) if begin else (slice(0, 2000), slice(2000, len(x)))
    )
    x[begin + 500] += 7.0
    x[(0 if begin else 2000) + short // 2] += 9.0
    (finding,) = outliers(channel(x, "actuator_force", segments=cuts))
    assert finding.numbers["row"] == begin + 501 and finding.numbers["count"] == 1
    x[begin + 500] -= 7.0
    x[begin + 900 : begin + 2000] += 3.0
    (finding,) = leaps(channel(x, segments=cuts))
    assert finding.numbers["count"] == 1 and finding.numbers["size"] == pytest.approx(3.0, abs=0.02)
    assert f"row {begin + 900}" in finding.sentence
