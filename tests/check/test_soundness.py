"""Findings about channels and clock: none on a sound record, the right one on a spoilt record."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from check.made_channels import ask, channel, strange_velocity
from shared_data import shared_folder

from teleopdesign import example, load_experiment
from teleopdesign.check import CheckedRecording, findings_of

RATE = 1000.0
T = np.arange(12_000) / RATE
STEP = 1e-5


@pytest.fixture(scope="module")
def rod():
    return load_experiment(example("rod"))


def spoilt(experiment, quantity, change):
    """The experiment with one channel of its first record changed."""
    first, *others = experiment.records
    key = f"device.{quantity}"
    values = change(first.signals[key].copy())
    record = replace(first, signals={**first.signals, key: values})
    return replace(experiment, records=(record, *others))


def put(places, values):
    def change(x):
        x[places] = values(x) if callable(values) else values
        return x

    return change


def check_signals(experiment):
    """What needs no comparison with a model."""
    return findings_of(CheckedRecording(experiment))


def warnings(experiment, topic=None):
    findings = [f for f in check_signals(experiment) if f.concern != "fine"]
    return [f for f in findings if topic is None or f.topic == topic]


def the_only(experiment, topic):
    findings = warnings(experiment)
    assert [f.topic for f in findings] == [topic], list(map(str, findings))
    return findings[0]


def motion(seed=0):
    """A smooth motion of several sines, as a body makes it."""
    rng = np.random.default_rng(seed)
    return sum(
        rng.uniform(0.2, 1.0) * 0.01 / f * np.sin(2 * np.pi * f * T + rng.uniform(0, 6))
        for f in (0.7, 1.9, 5.3, 11.0)
    )


def read(x):
    return STEP * np.round(x / STEP)


def test_a_sound_record_gives_no_warning_and_no_note(rod):
    assert warnings(rod) == []
    assert {f.concern for f in check_signals(rod)} == {"fine"}


def test_lone_samples_of_a_command_out_of_its_range_are_counted_where_they_are(rod):
    size = 3.0 * np.ptp(rod.records[0].signals["device.actuator_force"])
    finding = the_only(
        spoilt(rod, "actuator_force", put([3000, 5000], [size, 2 * size])), "outliers"
    )
    assert finding.numbers["count"] == 2 and finding.numbers["row"] == 5001
    assert "2 samples lie" in finding.sentence and "at 5 s (row 5001)" in finding.sentence
    inside = put(3000, lambda x: x.max())  # a command may have any value within its range
    assert warnings(spoilt(rod, "actuator_force", inside), "outliers") == []


def test_lost_samples_are_counted_where_a_position_leaps(rod):
    first, *others = rod.records
    x = first.signals["device.position"]
    fastest = int(np.argmax(np.abs(np.gradient(x))))
    kept = np.delete(np.arange(len(x)), np.arange(fastest, fastest + 12))
    record = replace(
        first,
        time=first.time[: len(kept)],
        segments=(slice(0, len(kept)),),
        signals={k: v[kept] for k, v in first.signals.items()},
    )
    findings = warnings(replace(rod, records=(record, *others)), "jumps")
    assert len(findings) == 1
    assert findings[0].numbers["samples"] == pytest.approx(12, abs=1.5)  # speed before and after
    assert findings[0].numbers["time"] == pytest.approx(fastest / 1000, abs=2e-3)


def test_a_wrapped_angle_is_called_a_whole_turn():
    turning = load_experiment(example("rod"))
    bodies = {n: replace(b, axis="revolute") for n, b in turning.bodies.items()}
    unwrapped = 4.0 * T + 0.2 * np.sin(9 * T)
    wrapped = np.angle(np.exp(1j * unwrapped))
    spoiled = spoilt(replace(turning, bodies=bodies), "position", lambda x: wrapped)
    findings = warnings(spoiled, "jumps")
    assert "unwrap" in findings[0].sentence
    assert abs(findings[0].numbers["size"]) == pytest.approx(2 * np.pi, rel=0.01)


def test_a_clipped_force_sensor_is_detected_with_its_limit_and_share(rod):
    x = rod.records[0].signals["device.interaction_force"]
    limit = float(np.round(np.quantile(x, 0.97), 4))
    spoiled = spoilt(rod, "interaction_force", lambda x: np.minimum(x, limit))
    findings = warnings(spoiled, "clipped channels")
    assert [f.concern for f in findings] == ["warning"]
    assert findings[0].numbers["value"] == limit
    assert findings[0].numbers["part"] == pytest.approx(0.03, abs=0.002)


def test_a_clipped_position_is_detected_but_a_body_that_rests_is_not(rod):
    x = rod.records[0].signals["device.position"]
    limit = x[np.argsort(x)[int(0.9 * len(x))]]
    findings = warnings(spoilt(rod, "position", lambda x: np.minimum(x, limit)), "clipped channels")
    assert findings[0].numbers["value"] == limit
    resting = np.repeat(np.tile([0.0, 0.01], 6), 1000)  # held at its ends, moved gently
    smooth = np.convolve(resting, np.hanning(400) / np.hanning(400).sum(), mode="same")
    assert warnings(spoilt(rod, "position", lambda x: read(smooth)), "clipped channels") == []


@pytest.mark.parametrize("quantity", ["position", "interaction_force"])
def test_a_channel_that_sticks_is_detected_from_when_to_when(rod, quantity):
    x = rod.records[0].signals["device.position"]
    speed = np.abs(np.gradient(x))
    start = 2000 + int(np.argmax(speed[2000:6000]))
    spoiled = spoilt(rod, quantity, put(slice(start, start + 600), lambda x: x[start]))
    findings = [f for f in warnings(spoiled, "stuck channels")]
    assert len(findings) == 1
    assert findings[0].numbers["from"] == pytest.approx(start / RATE, abs=2e-3)
    assert findings[0].numbers["duration"] == pytest.approx(0.6, abs=2e-3)


def test_a_channel_that_never_changes_is_named(rod):
    findings = warnings(spoilt(rod, "interaction_force", lambda x: 0 * x), "stuck channels")
    assert findings[0].numbers["value"] == 0.0
    assert "throughout" in findings[0].sentence


def test_an_averaged_log_of_a_coarse_encoder_neither_repeats_samples_nor_runs_flat(rod):
    """Near its turns the body stays within a step; averages lie between the encoder's steps."""
    rate, averaged_over = 50.0, 4
    t = np.arange(averaged_over * len(T)) / (averaged_over * rate)
    position = read(40 * STEP * np.sin(2 * np.pi * 0.5 * t)).reshape(len(T), -1).mean(axis=1)
    first = rod.records[0]
    channel = replace(rod.channels["device.position"], resolution=STEP)
    experiment = replace(
        rod,
        records=(
            replace(
                first,
                time=np.arange(len(T)) / rate,
                sample_time=1 / rate,
                segments=(slice(0, len(T)),),
                signals={"device.position": position, "device.actuator_force": np.cos(t[::4])},
            ),
        ),
        channels={k: c for k, c in rod.channels.items() if k != "time"}
        | {"device.position": channel},
    )
    assert [f for f in check_signals(experiment) if f.concern == "warning"] == []


def test_a_force_sampled_at_a_tenth_of_the_rate_is_noticed(rod):
    spoiled = spoilt(rod, "interaction_force", lambda x: np.repeat(x[::10], 10))
    findings = warnings(spoiled, "held samples")
    assert findings[0].numbers["rate"] == pytest.approx(100.0)


def rounded(part):
    """To steps of that part of the largest value."""

    def change(x):
        step = part * np.abs(x).max()
        return np.round(x / step) * step

    return change


@pytest.mark.parametrize("quantity", ["actuator_force", "interaction_force"])
def test_a_force_that_is_logged_in_coarse_steps_is_reported_with_the_step(rod, quantity):
    (finding,) = warnings(spoilt(rod, quantity, rounded(0.1)), "force steps")
    largest = np.abs(rod.records[0].signals[f"device.{quantity}"]).max()
    assert finding.numbers["step"] == pytest.approx(0.1 * largest, rel=1e-9)
    assert finding.numbers["error"] == pytest.approx(0.1 * largest / np.sqrt(12), rel=1e-9)
    assert quantity in finding.sentence and finding.concern == "warning"


def test_fine_steps_and_a_relay_are_no_coarse_steps(rod):
    assert warnings(spoilt(rod, "actuator_force", rounded(0.01)), "force steps") == []
    relay = np.random.default_rng(1).integers(-3, 4, 40).repeat(1000).astype(float)
    for levels in (relay, np.sign(relay)):
        experiment = spoilt(rod, "actuator_force", lambda x, y=levels: np.resize(y, len(x)))
        assert warnings(experiment, "force steps") == []


def with_channel(experiment, quantity, **changes):
    key = f"device.{quantity}"
    channel = replace(experiment.channels[key], **changes)
    return replace(experiment, channels={**experiment.channels, key: channel})


def test_an_encoder_coarser_than_stated_is_detected_with_its_step(rod):
    findings = warnings(with_channel(rod, "position", resolution=7.2e-6 / 4), "encoder steps")
    assert findings and all(f.concern == "warning" for f in findings)
    assert findings[0].numbers["seen"] == pytest.approx(7.2e-6, rel=1e-9)
    findings = warnings(with_channel(rod, "position", resolution=7.2e-9), "encoder steps")
    assert findings[0].numbers["seen"] == pytest.approx(7.2e-6, rel=1e-9)


@pytest.mark.parametrize("factor", [0.3, 3.0])
def test_noise_that_is_not_the_stated_one_is_measured(rod, factor):
    findings = warnings(with_channel(rod, "interaction_force", noise=factor * 0.0116), "noise")
    # half a second of samples tells a scatter to 6 %, the median of forty pieces better
    assert findings[0].numbers["seen"] == pytest.approx(0.0116, rel=0.1)
    assert findings[0].numbers["ratio"] == pytest.approx(1 / factor, rel=0.1)


def test_a_clock_that_jitters_is_reported_with_its_size_in_time_and_place(rod):
    rng = np.random.default_rng(4)
    late, moves = 1e-4 * rng.standard_normal(len(T)), 10 * motion()
    jitters = spoilt(rod, "position", lambda x: read(np.interp(T + late, T, moves)))
    (finding,) = (f for f in ask("sample_clock", jitters) if f.concern == "warning")
    assert finding.numbers["jitter"] == pytest.approx(1e-4, rel=0.2)
    assert finding.numbers["part"] == pytest.approx(finding.numbers["jitter"] * RATE)
    speed = np.sqrt(np.mean(np.gradient(moves, T) ** 2))
    # the jitter itself adds to the speed of the readings
    assert finding.numbers["position"] == pytest.approx(1e-4 * speed, rel=0.3)
    assert "rms early or late" in finding.sentence


def rewritten(folder, stamps):
    """The rod in a folder of its own, its first record with these time stamps."""
    import gzip
    import shutil

    shutil.copytree(example("rod"), folder, dirs_exist_ok=True)
    path = folder / "fit.csv.gz"
    head, *lines = gzip.open(path, "rt").read().splitlines()
    column = head.split(",").index("t")
    out = [head]
    for line, stamp in zip(lines, stamps, strict=True):
        parts = line.split(",")
        parts[column] = f"{stamp:.7f}"
        out.append(",".join(parts))
    with gzip.open(path, "wt") as file:
        file.write("\n".join(out) + "\n")
    return load_experiment(folder)


def test_stamps_that_jitter_are_measured(tmp_path):
    jitter = 1e-4 * np.random.default_rng(5).uniform(-0.9, 0.9, 12_000)
    finding = the_only(rewritten(tmp_path, np.arange(12_000) / RATE + jitter), "sample clock")
    assert finding.concern == "note"
    assert finding.numbers["jitter"] == pytest.approx(0.9e-4 / np.sqrt(3), rel=0.05)
    assert finding.numbers["rate"] == pytest.approx(RATE, rel=1e-6)


def test_segments_and_what_is_too_short_to_be_compared_are_counted(rod):
    first, *others = rod.records
    time = first.time + np.where(np.arange(12_000) >= 6000, 3.0, 0.0)
    segments = (slice(0, 6000), slice(6000, 6300), slice(6300, 12_000))
    record = replace(first, time=time, segments=segments)
    # in a folder without files no stamps can be read again
    apart = replace(rod, folder=Path("nowhere"), records=(record, *others))
    finding = the_only(apart, "gaps")
    assert finding.numbers["longest_gap"] == pytest.approx(3.0, abs=1e-9)
    assert finding.numbers["too_short"] == 1
    assert finding.numbers["left_out"] == pytest.approx(0.3)
    assert finding.concern == "note"  # a fortieth of the record


@pytest.mark.slow
def test_the_known_oddities_of_real_recordings_are_detected_and_no_others():
    """What their READMEs say: jitter of psm and mtm, rows twice in mtm, a finer emps file."""
    data = shared_folder("data")
    findings = {
        name: {(f.topic, f.where) for f in warnings(load_experiment(data / name))}
        for name in ("emps", "hsm150", "mtm_wrist", "psm_insertion")
    }
    assert findings["emps"] == {("encoder steps", "emps_pulses.csv.gz")}
    assert findings["hsm150"] == set()
    topics = ("gaps", "held samples", "lost rows", "reading")
    assert findings["mtm_wrist"] == {(topic, "mtm_joint4_sweep.csv.gz") for topic in topics}
    (repeated, *_) = load_experiment(data / "mtm_wrist").reading
    assert "rows the same as the one before" in repeated.observed
    runs = [f"psm1_fourier{k}.csv.gz" for k in (1, 2, 3)]
    sparse = {(topic, run) for topic in ("lost rows", "reading", "sample clock") for run in runs}
    assert sparse <= findings["psm_insertion"]
    more = {topic for topic, _ in findings["psm_insertion"] - sparse}
    assert more <= {"held samples", "outliers"}


@pytest.mark.slow
def test_simulated_measurements_raise_no_warning():
    cases = shared_folder("hidden/cases")
    assert {f.name: w for f in sorted(cases.iterdir()) if (w := warnings(load_experiment(f)))} == {}


def test_a_body_that_rests_is_not_held_against_its_velocity_channel():
    position = channel(np.zeros(2000))
    assert strange_velocity(position, channel(np.sin(np.arange(2000)), "velocity")) == []


def test_what_is_in_order_is_reported_beside_what_is_not_and_never_of_the_same(rod, tmp_path):
    def topics(experiment):
        return sorted((f.topic, f.concern) for f in check_signals(experiment))

    assert topics(rod) == [("channels", "fine"), ("sample clock", "fine")]
    lone = spoilt(rod, "actuator_force", put(5000, lambda x: 4 * np.abs(x).max()))
    assert topics(lone) == [("outliers", "warning"), ("sample clock", "fine")]
    jitter = 1e-4 * np.random.default_rng(5).uniform(-0.9, 0.9, 12_000)
    late = rewritten(tmp_path, np.arange(12_000) / RATE + jitter)
    assert topics(late) == [("channels", "fine"), ("sample clock", "note")]
