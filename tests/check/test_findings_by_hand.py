"""Leaps, held samples and limits of single channels: what is said, with which numbers."""

import numpy as np
import pytest
from check.made_channels import H, channel, clipped, flat, leaps, repeated, slower, swing

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
