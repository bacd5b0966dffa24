"""Steps, noise, stretches and velocities of single channels: what is said, with which numbers."""

import numpy as np
import pytest
from check.made_channels import (
    H,
    channel,
    coarse_force,
    hums,
    interruptions,
    record_of,
    strange_velocity,
    swing,
    wrong_noise,
    wrong_steps,
)

from teleopdesign.check.stated_accuracy import measured_noise
from teleopdesign.measurement.conversion import Conversion

# steps


def test_a_resolution_to_write_is_reported_in_the_unit_of_the_channel():
    """Of counts behind a gear, of degrees, and of one's own unit."""
    x = 4e-3 * np.round(swing(4000, 250.0))
    texts = {"m": "0.004", "mm": "4"}
    for unit, step in texts.items():
        (finding,) = wrong_steps(channel(x, step=4e-3, resolution=1e-3, written=unit))
        assert f"write resolution = {step} at channels.position" in finding.sentence
        assert finding.numbers == {"stated": 1e-3, "seen": pytest.approx(4e-3)}
        assert "4 times the stated" in finding.sentence
    turned = Conversion(("x",), (1.0,), factor=-2e-3)
    (finding,) = wrong_steps(channel(x, step=4e-3, resolution=1e-3, conversion=turned))
    assert "write resolution = 2 at channels.position" in finding.sentence


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
        (finding,) = wrong_steps(smooth, other(step))
        assert ("but velocity is: are the two columns swapped?" in finding.sentence) == is_swapped
        assert finding.concern == ("warning" if is_swapped else "note")
        assert finding.numbers == {"stated": 1e-3, "seen": 3.7e-4}
    assert "but in finer" in finding.sentence
    (coarse,) = wrong_steps(channel(random.normal(size=3000), step=2e-3, resolution=1e-3))
    assert coarse.concern == "warning" and "but of 0.002" in coarse.sentence


@pytest.mark.parametrize("zero", [0.0, 0.3, -17.7])
@pytest.mark.parametrize(("step", "is_coarse"), [(0.2, True), (0.05, False)])
def test_a_coarse_force_is_detected_from_whatever_zero_its_steps_count(zero, step, is_coarse):
    random = np.random.default_rng(0)
    y = step * np.round((swing(4000) + 0.02 * random.normal(size=4000)) / step) + zero * step
    findings = coarse_force(channel(y, "interaction_force", step=step))
    assert [f.numbers["step"] for f in findings] == [step] * is_coarse
    if findings:
        assert f"{100 * step / np.sqrt(12) / y.std():.1f} % of what it does" in findings[0].sentence


def test_positions_relays_and_scatter_are_no_coarse_forces():
    y = 0.2 * np.round(5 * swing(4000))
    assert coarse_force(channel(y, "position", step=0.2)) == []
    for levels in ((-1.0, 1.0), (0.0, 0.2, 0.4, 0.6)):
        relay = np.random.default_rng(1).choice(levels, 4000)
        assert coarse_force(channel(relay, "actuator_force", step=levels[1] - levels[0])) == []
    scatter = np.random.default_rng(1).normal(size=4000)
    assert coarse_force(channel(scatter, "actuator_force", step=0.5)) == []
    jumping = np.random.default_rng(1).integers(-5, 6, 4000) * 1.0
    assert coarse_force(channel(jumping, "actuator_force", step=1.0)) == []
    assert coarse_force(channel(np.ones(100), "actuator_force")) == []


# noise


def noisy(size, name="interaction_force", **more):
    random = np.random.default_rng(len(name))
    return channel(size * random.normal(size=4000) + swing(4000), name, step=1e-9, **more)


@pytest.mark.parametrize(
    ("stated", "words"), [(0.4, "hides effects"), (0.05, "makes noise look like an effect")]
)
def test_noise_that_is_stated_wrong_says_what_it_does_to_the_answer(stated, words):
    (finding,) = wrong_noise(noisy(0.1, noise=stated))
    assert words in finding.sentence and finding.sentence.count("effect") == 1
    assert finding.numbers["seen"] == pytest.approx(0.1, rel=0.1)
    assert finding.numbers["stated"] == stated
    assert finding.numbers["ratio"] == pytest.approx(0.1 / stated, rel=0.1)
    assert wrong_noise(noisy(0.1, noise=0.11)) == [] == wrong_noise(noisy(0.1))


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
    (finding,) = wrong_noise(noisy(0.1, noise=stated), beside)
    assert ("actuator_force has it: are the two columns swapped?" in finding.sentence) == swapped


# stretches


def test_stretches_shorter_than_are_compared_are_reported_with_how_much_they_are():
    def findings_for(*lengths):
        ends = np.cumsum(lengths)
        segments = tuple(slice(int(b - n), int(b)) for b, n in zip(ends, lengths, strict=True))
        return interruptions(record_of(int(ends[-1]), segments))

    assert findings_for(5000) == []
    (whole,) = findings_for(5000, 2000)
    assert "left out" not in whole.sentence and whole.concern == "note"
    assert "2 segments of 2 to 5 s" in whole.sentence and whole.numbers["too_short"] == 0
    (short,) = findings_for(5000, 100, 2000, 200)
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
        (hum,) = hums(channel(y, "interaction_force", segments=segments), position)
        assert hum.numbers["frequency"] == 50.0
        assert hum.numbers["rms"] == pytest.approx(0.5**0.5, rel=0.2)
        velocity = channel(1.2 * np.gradient(swing(6000), H), "velocity", segments=segments)
        (units,) = strange_velocity(position, velocity)
        assert units.numbers["factor"] == pytest.approx(1.2, rel=0.01)


@pytest.mark.parametrize(("factor", "late", "concerns"), [
    (1.0, 0.0, []), (1.04, 0.0, []), (1.06, 0.0, ["warning"]), (0.94, 0.0, ["warning"]),
    (1.0, 1.5 * H, ["note"]), (1.0, -1.5 * H, ["note"]), (1.0, 0.7 * H, []),
    (-1.0, 2 * H, ["warning", "note"]),
])  # fmt: skip
def test_a_velocity_is_doubted_by_factor_and_by_lag(factor, late, concerns):
    t = H * np.arange(4000)
    x = np.sin(2 * np.pi * 1.3 * t) + 0.3 * np.sin(2 * np.pi * 4.1 * t)
    v = factor * np.gradient(
        np.sin(2 * np.pi * 1.3 * (t - late)) + 0.3 * np.sin(2 * np.pi * 4.1 * (t - late)), H
    )
    findings = strange_velocity(channel(x), channel(v, "velocity"))
    assert [f.concern for f in findings] == concerns
    for one in findings:
        assert one.numbers["shift"] == pytest.approx(late, abs=0.02 * H)
        assert one.numbers["factor"] == pytest.approx(factor, rel=1e-3)
    if concerns == ["note"]:
        assert ("lags" if late > 0 else "leads") in findings[0].sentence and "1.5 ms" in findings[
            0
        ].sentence


def test_a_velocity_of_another_body_does_not_follow():
    t = H * np.arange(4000)
    (finding,) = strange_velocity(channel(np.sin(9 * t)), channel(np.cos(23 * t), "velocity"))
    assert "does not follow the position's derivative" in finding.sentence
    assert finding.concern == "warning"
    (finding,) = strange_velocity(channel(np.sin(9 * t)), channel(t < 0.1, "velocity"))
    assert "does not follow" in finding.sentence  # where both are compared it is zero


@pytest.mark.parametrize("rows", [16, 499, 501, 20_000, 61_234])
def test_the_noise_of_a_record_of_any_length_is_that_of_its_usual_pieces(rows):
    """Also where it is cut into many pieces, a fifth of which are ten times as noisy."""
    random = np.random.default_rng(0)
    x = 0.1 * random.normal(size=rows)
    if rows > 10_000:
        x[: rows // 5] *= 10.0
        x += swing(rows, 5.0)
    assert measured_noise(channel(x)) == pytest.approx(0.1, rel=0.8 if rows < 100 else 0.12)


def test_stretches_too_short_to_show_noise_are_left_out():
    x = np.r_[100.0 * np.arange(15) ** 2, 0.1 * np.random.default_rng(0).normal(size=600)]
    cut = (slice(0, 15), slice(15, len(x)))
    assert measured_noise(channel(x, segments=cut)) == pytest.approx(0.1, rel=0.15)
    assert measured_noise(channel(x[:15])) == 0.0
    # the remainder of a stretch counts from sixteen rows on
    x = np.r_[0.1 * np.random.default_rng(1).normal(size=1000), 50.0 * np.arange(15.0) ** 4]
    assert measured_noise(channel(x)) == pytest.approx(0.1, rel=0.15)


@pytest.mark.parametrize(("short", "concern"), [(500, "note"), (501, "warning")])
def test_a_tenth_of_a_record_in_short_segments_is_a_note_and_more_a_warning(short, concern):
    """At 1 kHz: half a second is too short; 5 s in all."""
    record = record_of(5000, (slice(0, 5000 - short), slice(5000 - short, 5000)))
    (finding,) = interruptions(record)
    assert finding.concern == concern and finding.numbers["too_short"] == 1
    assert finding.numbers["left_out"] == pytest.approx(1e-3 * short)
