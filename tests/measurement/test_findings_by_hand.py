"""Findings about single channels made by hand: what is said, with which numbers."""

import numpy as np
import pytest

from teleopdesign.measurement.channel import Channel
from teleopdesign.measurement.conversion import Conversion
from teleopdesign.measurement.record import Record
from teleopdesign.measurement.soundness.clipping import check_clipped
from teleopdesign.measurement.soundness.encoder_steps import check_steps
from teleopdesign.measurement.soundness.force_steps import check_force_steps
from teleopdesign.measurement.soundness.held_samples import (
    check_constant,
    check_repeats,
    check_stuck,
    check_update,
)
from teleopdesign.measurement.soundness.mains_hum import check_hum
from teleopdesign.measurement.soundness.noise import check_noise
from teleopdesign.measurement.soundness.outliers import check_jumps, check_outliers
from teleopdesign.measurement.soundness.segments import check_segments
from teleopdesign.measurement.soundness.signal import Signal
from teleopdesign.measurement.soundness.time_shift import check_velocity

H = 1e-3
UNITS = {"position": "m", "velocity": "m/s"}


def record_of(n, segments=None):
    whole = segments or (slice(0, n),)
    return Record("a.csv", "fit", frozenset(), H * np.arange(n), H, whole, {})


def channel(values, quantity="position", *, step=0.0, name=None, segments=None, **more):
    """A channel of one record as the checks get it."""
    unit = more.pop("unit", UNITS.get(quantity, "N"))
    described = {"resolution": None, "noise": None, **more}
    made = Channel(quantity, "device", "x", described.pop("written", unit), **described)
    y = np.asarray(values, dtype=float)
    return Signal(name or quantity, unit, made, record_of(len(y), segments), y, step)


def swing(n=2000, size=1.0):
    return size * np.sin(2 * np.pi * 1.3 * H * np.arange(n) + 0.3)


# leaps


def leaping(by, unit="rad", row=700):
    x = swing()
    x[row:] += by
    return channel(x, unit=unit)


@pytest.mark.parametrize("part", [-1.04, 0.96, 1.0])
def test_a_leap_by_about_a_turn_asks_for_an_angle_to_be_unwrapped(part):
    (found,) = check_jumps(leaping(part * 2 * np.pi))
    assert "jumps once, most at 0.699 s (row 700)" in found.sentence
    assert "a whole turn: unwrap the angle" in found.sentence
    assert found.numbers["size"] == pytest.approx(part * 2 * np.pi, abs=1e-3)


@pytest.mark.parametrize(("part", "unit"), [(1.06, "rad"), (0.94, "rad"), (2.0, "rad"), (1.0, "m")])
def test_a_leap_by_anything_else_is_no_turn(part, unit):
    (found,) = check_jumps(leaping(part * 2 * np.pi, unit))
    assert "turn" not in found.sentence and "unwrap" not in found.sentence


def test_a_leap_is_shown_with_the_samples_before_and_after_it():
    (found,) = check_jumps(leaping(3.0))
    marked = found.graph.series[1]
    assert marked.x.tolist() == pytest.approx([0.699, 0.7])
    assert marked.y[1] - marked.y[0] == pytest.approx(3.0, abs=0.02)


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("sample", ["before", "after"])
def test_a_reading_that_was_held_and_catches_up_does_not_leap(sample, way):
    """At a hundred steps a sample: a sample is held, the next one is where it would be."""
    x = way * 100.0 * np.arange(2000.0) + np.random.default_rng(0).normal(size=2000)
    assert check_jumps(channel(x)) == []
    x[700:] += way * 1000.0
    assert len(check_jumps(channel(x))) == 1
    if sample == "before":
        x[698] = x[699]
    else:
        x[701] = x[700]
    assert check_jumps(channel(x)) == []


def test_a_lone_sample_is_no_leap_whatever_its_size():
    """Of eight to ten times the noise it looks like one, but the lone sample explains it."""
    leaps = alone = 0
    for seed in range(100):
        x = np.random.default_rng(seed).normal(size=600)
        x[300] += 8.0 + 0.02 * seed
        leaps += len(check_jumps(channel(x)))
        alone += len(check_outliers(channel(x)))
    assert leaps <= 2  # by chance
    assert alone > 80


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
        (found,) = check_update(signal)
        assert f"changes only every {every} samples" in found.sentence
        assert f"the log at {1 / H:.4g} Hz" in found.sentence
        assert found.numbers == {"samples": every, "rate": pytest.approx(1 / H / every)}


def test_a_channel_that_changes_at_odd_times_or_always_has_no_rate():
    assert check_update(held_in_turn(1)) == []
    assert check_update(held_in_turn(10, off=1, part=0.4)) == []
    assert check_update(held_in_turn(10, n=500)) == []  # fifty changes, 49 distances
    assert len(check_update(held_in_turn(10, n=520))) == 1


def stuck_at(*holds):
    x = 100.0 * np.sin(2 * np.pi * 3.0 * H * np.arange(4000))
    for a, b in holds:
        x[a:b] = x[a]
    return channel(x)


def test_a_stuck_channel_is_told_from_its_first_to_its_last_sample():
    (found,) = check_stuck(stuck_at((1005, 1100)))
    assert (found.numbers["from"], found.numbers["to"]) == (
        pytest.approx(1.005),
        pytest.approx(1.099),
    )
    assert "from 1.005 to 1.099 s: cut that out" in found.sentence
    assert found.numbers["duration"] == pytest.approx(0.095) and found.numbers["count"] == 1


def test_of_several_stuck_stretches_the_longest_is_told_and_all_are_counted():
    (found,) = check_stuck(stuck_at((1005, 1040), (2000, 2095), (3010, 3040)))
    assert "from 2 to 2.094 s (3 times, 0.16 s in all)" in found.sentence
    assert found.numbers["duration"] == pytest.approx(0.16)


def test_samples_that_a_log_repeats_are_counted_among_those_in_motion():
    """One in twenty is worth knowing, one in ten needs care; what rests does not count."""
    x = np.concatenate([np.zeros(3000), 10.0 * np.arange(1000)])
    for every, concern, share in ((20, "note", 0.05), (10, "warning", 0.1)):
        y = x.copy()
        at = np.arange(3025, 3975, every)
        y[at] = y[at - 1]
        (found,) = check_repeats(channel(y, step=1.0))
        assert found.concern == concern
        assert found.numbers["count"] == len(at)
        assert found.numbers["part"] == pytest.approx(share, abs=0.005)
    assert check_repeats(channel(y, "interaction_force", step=1.0)) == []


@pytest.mark.parametrize(
    ("quantity", "concern", "words"),
    [
        ("actuator_force", "note", "the actuator drives nothing"),
        ("position", "warning", "the body never moves"),
        ("interaction_force", "warning", "not connected"),
    ],
)
def test_a_channel_that_says_one_value_is_told_with_what_that_may_mean(quantity, concern, words):
    (found,) = check_constant(channel(np.full(100, 2.5), quantity))
    assert found.concern == concern and words in found.sentence
    assert found.numbers["value"] == 2.5
    assert check_constant(channel(np.arange(100.0), quantity)) == []


# limits


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("quantity", ["actuator_force", "interaction_force"])
def test_a_limit_of_a_command_may_be_meant_and_one_of_a_sensor_is_not(quantity, side):
    """Told with its share, shown from the first sample at it."""
    y = side * np.minimum(swing(4600), 0.8)[600:]
    (found,) = check_clipped(channel(y, quantity, step=1e-6))
    is_command = quantity == "actuator_force"
    assert found.concern == ("note" if is_command else "warning")
    assert ("fine if the command itself is limited" in found.sentence) == is_command
    assert ("the channel is clipped" in found.sentence) == (not is_command)
    at = np.flatnonzero(np.abs(y) == 0.8)
    assert found.numbers["part"] == pytest.approx(len(at) / len(y))
    assert found.numbers["count"] == 5
    assert ("largest" if side > 0 else "smallest") in found.sentence
    begins = found.graph.series[0].x[0]
    assert begins == pytest.approx((at[0] - 100) * H)


# steps


def test_a_resolution_to_write_is_said_in_the_unit_of_the_channel():
    """Of counts behind a gear, of degrees, and of one's own unit."""
    x = 4e-3 * np.round(swing(4000, 250.0))
    said = {"m": "0.004", "mm": "4"}
    for unit, step in said.items():
        (found,) = check_steps(channel(x, step=4e-3, resolution=1e-3, written=unit), [])
        assert f"write resolution = {step} at channels.position" in found.sentence
        assert found.numbers == {"stated": 1e-3, "seen": pytest.approx(4e-3)}
        assert "4 times the stated" in found.sentence
    turned = Conversion(("x",), (1.0,), factor=-2e-3)
    (found,) = check_steps(channel(x, step=4e-3, resolution=1e-3, conversion=turned), [])
    assert "write resolution = 2 at channels.position" in found.sentence


def test_a_channel_off_its_stated_steps_names_the_one_that_lies_on_them():
    random = np.random.default_rng(0)
    smooth = channel(random.normal(size=3000), step=3.7e-4, resolution=1e-3)

    def other(step):
        return channel(step * np.round(swing(3000) / step), "velocity", step=step)

    for step, is_swapped in (
        (1e-3, True),
        (5e-3, True),
        (1e-4, False),
        (1.4e-3, False),
        (0.2, False),
    ):
        (found,) = check_steps(smooth, [other(step)])
        assert ("but velocity is: are the two columns swapped?" in found.sentence) == is_swapped
        assert found.concern == ("warning" if is_swapped else "note")
        assert found.numbers == {"stated": 1e-3, "seen": 3.7e-4}
    assert "but finer" in found.sentence
    (coarse,) = check_steps(channel(random.normal(size=3000), step=2e-3, resolution=1e-3), [])
    assert coarse.concern == "warning" and "but of 0.002" in coarse.sentence


@pytest.mark.parametrize("zero", [0.0, 0.3, -17.7])
@pytest.mark.parametrize(("step", "is_coarse"), [(0.2, True), (0.05, False)])
def test_a_coarse_force_is_told_from_whatever_zero_its_steps_count(zero, step, is_coarse):
    random = np.random.default_rng(0)
    y = step * np.round((swing(4000) + 0.02 * random.normal(size=4000)) / step) + zero * step
    found = check_force_steps(channel(y, "interaction_force", step=step))
    assert [f.numbers["step"] for f in found] == [step] * is_coarse
    if found:
        assert f"{100 * step / np.sqrt(12) / y.std():.1f} % of what it does" in found[0].sentence


def test_positions_relays_and_scatter_are_no_coarse_forces():
    y = 0.2 * np.round(5 * swing(4000))
    assert check_force_steps(channel(y, "position", step=0.2)) == []
    for levels in ((-1.0, 1.0), (0.0, 0.2, 0.4, 0.6)):
        relay = np.random.default_rng(1).choice(levels, 4000)
        assert check_force_steps(channel(relay, "actuator_force", step=levels[1] - levels[0])) == []
    scatter = np.random.default_rng(1).normal(size=4000)
    assert check_force_steps(channel(scatter, "actuator_force", step=0.5)) == []
    jumping = np.random.default_rng(1).integers(-5, 6, 4000) * 1.0
    assert check_force_steps(channel(jumping, "actuator_force", step=1.0)) == []
    assert check_force_steps(channel(np.ones(100), "actuator_force")) == []


# noise


def noisy(size, name="interaction_force", **more):
    random = np.random.default_rng(len(name))
    return channel(size * random.normal(size=4000) + swing(4000), name, step=1e-9, **more)


@pytest.mark.parametrize(
    ("stated", "words"), [(0.4, "hides effects"), (0.05, "makes noise look like an effect")]
)
def test_noise_that_is_stated_wrong_says_what_it_does_to_the_answer(stated, words):
    (found,) = check_noise(noisy(0.1, noise=stated), [])
    assert words in found.sentence and found.sentence.count("effect") == 1
    assert found.numbers["seen"] == pytest.approx(0.1, rel=0.1)
    assert found.numbers["stated"] == stated
    assert found.numbers["ratio"] == pytest.approx(0.1 / stated, rel=0.1)
    assert check_noise(noisy(0.1, noise=0.11), []) == [] == check_noise(noisy(0.1), [])


@pytest.mark.parametrize(
    ("stated", "other", "swapped"),
    [
        (0.4, {"size": 0.4}, True),
        (0.4, {"size": 0.1}, False),  # as quiet
        (0.4, {"size": 0.4, "noise": 0.4}, False),  # its noise is stated, and there
        (0.4, {"size": 0.4, "unit": "N*m"}, False),
        (0.05, {"size": 0.05}, False),  # both are noisy enough
    ],
)
def test_another_column_with_the_stated_noise_is_a_swap_only_where_it_may_be(
    stated, other, swapped
):
    beside = noisy(other.pop("size"), "actuator_force", **other)
    (found,) = check_noise(noisy(0.1, noise=stated), [beside])
    assert ("actuator_force has it: are the two columns swapped?" in found.sentence) == swapped


# stretches


def test_stretches_shorter_than_are_compared_are_told_with_how_much_they_are():
    def found_of(*lengths):
        ends = np.cumsum(lengths)
        segments = tuple(slice(int(b - n), int(b)) for b, n in zip(ends, lengths, strict=True))
        return check_segments(record_of(int(ends[-1]), segments))

    assert found_of(5000) == []
    (whole,) = found_of(5000, 2000)
    assert "left out" not in whole.sentence and whole.concern == "note"
    assert "2 segments of 2 to 5 s" in whole.sentence and whole.numbers["too_short"] == 0
    (short,) = found_of(5000, 100, 2000, 200)
    assert "; 2 of them, 0.3 s in all, are shorter than" in short.sentence
    assert short.numbers["left_out"] == pytest.approx(0.3)


def test_hum_and_velocity_are_looked_at_in_the_longest_stretch():
    """The tone and the motion lie in it alone, first or last."""
    t = H * np.arange(6000)
    random = np.random.default_rng(0)
    for longest in (slice(0, 4000), slice(2000, 6000)):
        others = [slice(4000, 6000)] if longest.start == 0 else [slice(0, 2000)]
        segments = tuple(sorted([longest, *others], key=lambda s: s.start))
        y = random.normal(size=6000)
        y[longest] += np.sin(2 * np.pi * 50.0 * t[longest])
        position = channel(
            np.where(np.isin(np.arange(6000), np.arange(6000)[longest]), swing(6000), 0),
            segments=segments,
        )
        (hum,) = check_hum(channel(y, "interaction_force", segments=segments), [position])
        assert hum.numbers["frequency"] == 50.0
        assert hum.numbers["rms"] == pytest.approx(0.5**0.5, rel=0.2)
        velocity = channel(1.2 * np.gradient(swing(6000), H), "velocity", segments=segments)
        (units,) = check_velocity(position, velocity)
        assert units.numbers["factor"] == pytest.approx(1.2, rel=0.01)


@pytest.mark.parametrize(("factor", "late", "topics"), [
    (1.0, 0.0, []), (1.04, 0.0, []), (1.06, 0.0, ["units"]), (0.94, 0.0, ["units"]),
    (1.0, 1.5 * H, ["time shift"]), (1.0, -1.5 * H, ["time shift"]), (1.0, 0.7 * H, []),
    (-1.0, 2 * H, ["units", "time shift"]),
])  # fmt: skip
def test_a_velocity_is_doubted_by_factor_and_by_lag(factor, late, topics):
    t = H * np.arange(4000)
    x = np.sin(2 * np.pi * 1.3 * t) + 0.3 * np.sin(2 * np.pi * 4.1 * t)
    v = factor * np.gradient(
        np.sin(2 * np.pi * 1.3 * (t - late)) + 0.3 * np.sin(2 * np.pi * 4.1 * (t - late)), H
    )
    found = check_velocity(channel(x), channel(v, "velocity"))
    assert [f.topic for f in found] == topics
    for one in found:
        assert one.numbers["shift"] == pytest.approx(late, abs=0.02 * H)
        assert one.numbers["factor"] == pytest.approx(factor, rel=1e-3)
    if topics == ["time shift"]:
        assert ("lags" if late > 0 else "leads") in found[0].sentence and "1.5 ms" in found[
            0
        ].sentence


def test_a_velocity_of_another_body_does_not_follow():
    t = H * np.arange(4000)
    (found,) = check_velocity(channel(np.sin(9 * t)), channel(np.cos(23 * t), "velocity"))
    assert "does not follow the position's derivative" in found.sentence
    assert found.concern == "warning"
    (found,) = check_velocity(channel(np.sin(9 * t)), channel(t < 0.1, "velocity"))
    assert "does not follow" in found.sentence  # where both are compared it is zero
