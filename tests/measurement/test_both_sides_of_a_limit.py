"""Rules of reading from both sides: what counts as noise, as a source, as too many; and errors."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from check.made_channels import wrong_steps
from hypothesis import given
from hypothesis import strategies as st
from scipy.io import savemat

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError
from teleopdesign.check import CheckedRecording
from teleopdesign.measurement.bandwidth import LOWEST, default_bandwidth
from teleopdesign.measurement.doors import _log, json_records, matlab
from teleopdesign.measurement.doors.bag import _check_field
from teleopdesign.measurement.doors.text import open_text
from teleopdesign.measurement.reading import ReadingStep
from teleopdesign.measurement.record_clock import RecordClock
from teleopdesign.measurement.repeated_rows import rows_between_readings
from teleopdesign.measurement.resample import commands_on_clock
from teleopdesign.measurement.tables import open_log
from teleopdesign.measurement.time_grid import stamps_are_true
from teleopdesign.measurement.zero_phase import filter_both_ways, margin, sections
from teleopdesign.measurement.zero_phase_spans import reach, windows

# stamps


def clock_with(stamps, h):
    n = len(stamps)
    places, whole = np.arange(n), (slice(0, n),)
    time = h * places
    return RecordClock(places, stamps, places, time, h, whole, whole)


@pytest.mark.parametrize("truth", [0.0, 1.0])
@pytest.mark.parametrize("noise", [0.3, 1.0])
def test_whether_stamps_are_true_is_as_sure_as_they_scatter(truth, noise):
    """Over draws, the coefficient scatters about the truth by the error that is given with it."""
    h, n, off = 1e-3, 1500, []
    for seed in range(25):
        random = np.random.default_rng(seed)
        late = 0.1 * h * random.standard_normal(n)
        when = h * np.arange(n) + truth * late
        x = np.sin(2 * np.pi * 1.5 * when) + noise * 1e-3 * random.standard_normal(n)
        are_true, error = stamps_are_true(clock_with(h * np.arange(n) + late, h), [x])
        off.append((are_true - truth) / error)
    spread = float(np.sqrt(np.mean(np.square(off))))
    # 25 draws tell a spread to 14 %; six samples count as one, for neighbours share readings
    assert 0.3 < spread < 1.5


def test_stamps_of_a_body_that_rests_tell_nothing():
    clock = clock_with(1e-3 * np.arange(100.0), 1e-3)
    assert stamps_are_true(clock, [np.zeros(100)]) == (1.0, math.inf)


@pytest.mark.parametrize("phase", [-0.3, 0.0, 0.2, 0.4])
@pytest.mark.parametrize("scatter", [0.0, 0.1])
def test_a_command_that_changes_between_rows_is_its_mean_over_each_sample(phase, scatter):
    """It holds from n + phase on; a row near k has what held at its time."""
    h, n = 1e-3, 400
    random = np.random.default_rng(3)
    held = random.standard_normal(n + 2)  # of cell -1, 0, 1, ...
    at = np.arange(n) + scatter * random.uniform(-1.0, 1.0, n)
    values = held[np.floor(at - phase).astype(int) + 1]
    commands, _ = commands_on_clock(values, clock_with(h * at, h), phase)
    fine = (np.arange(200) + 0.5) / 200
    times = np.arange(n)[:, None] + fine
    mean = held[np.floor(times - phase).astype(int) + 1].mean(axis=1)
    rows = np.isin(np.arange(-1, n + 1), np.floor(at - phase))
    # where a row or its neighbour came too late to see a command, a line stands for it
    whole = rows[:-2] & rows[1:-1] & rows[2:]
    inside = np.flatnonzero(whole)[2:-2]
    assert len(inside) > (0.25 if scatter else 0.98) * n
    assert commands[inside] == pytest.approx(mean[inside], abs=1e-9)


# rows of a slower source


def test_rows_that_repeat_at_random_are_those_of_no_slower_source():
    """One in two stays, but in step with nothing."""
    random = np.random.default_rng(2)
    stamps = 0.002 * np.arange(4000)
    source = np.maximum.accumulate(np.where(random.random(4000) < 0.5, np.arange(4000), 0))
    x, u = 10.0 * np.sin(stamps[source]), np.cos(3 * stamps[source])
    x = 1e-4 * np.round(x / 1e-4)
    assert not rows_between_readings([x, u], [x], stamps).any()
    in_step = 2 * (np.arange(4000) // 2)
    x, u = 10.0 * np.sin(stamps[in_step]), np.cos(3 * stamps[in_step])
    x = 1e-4 * np.round(x / 1e-4)
    assert rows_between_readings([x, u], [x], stamps).mean() == pytest.approx(0.5, abs=0.01)


# the steps of an encoder


@pytest.mark.parametrize("interpolates", [True, False])
@pytest.mark.parametrize("coarser", [True, False])
def test_readings_between_the_stated_steps_are_reported_unless_they_were_interpolated(
    interpolates, coarser
):
    random = np.random.default_rng(1)
    t = np.arange(3000) / 500
    x = 0.05 * np.sin(2 * np.pi * 0.7 * t) + 1e-4 * random.random(3000)
    experiment = td.experiment(
        {"t": t, "x": x, "F": np.cos(t)},
        axis="prismatic",
        time="t",
        position={"column": "x", "resolution": 1e-3},
        actuator_force="F",
        inertia=0.1,
    )
    (position,) = (
        s for s in CheckedRecording(experiment).signals if s.channel.quantity == "position"
    )
    step = ReadingStep("log.csv", "stamps", "read", "none", interpolates=interpolates)
    position = replace(position, record=replace(position.record, reading=(step,)))
    if coarser:  # what lies further apart than the stated steps was not made by interpolation
        position = replace(position, step=2e-3)
    findings = wrong_steps(position)
    if interpolates and not coarser:
        assert findings == []
    else:
        assert "is not read in steps of the stated 0.001 m" in findings[0].sentence
        assert findings[0].concern == ("warning" if coarser else "note")


# tables


@pytest.mark.parametrize("trailing", [0, 1, 3])
@pytest.mark.parametrize("units", [True, False])
def test_names_of_a_table_may_be_followed_by_empty_cells(tmp_path, trailing, units):
    path = tmp_path / "log.csv"
    more = "," * trailing
    head = f"time,pos,current{more}\n" + (f"s,mm,A{more}\n" if units else "")
    path.write_text(head + "".join(f"{k / 100},{k % 7},{k % 5}\n" for k in range(200)))
    log = open_text(path, "log.csv")
    assert log.names == ("time", "pos", "current")
    assert log.units == ({"time": "s", "pos": "mm", "current": "A"} if units else {})


def test_a_table_may_have_as_many_columns_and_letters_as_are_allowed_and_no_more(monkeypatch):
    monkeypatch.setattr(_log, "MOST_COLUMNS", 5)
    monkeypatch.setattr(_log, "LONGEST_NAME", 3)
    monkeypatch.setattr(_log, "MOST_ROWS", 10)

    def log(*names):
        return _log.Log(names, lambda wanted: {})

    _log.refuse_odd_names(log(*"abcd", "eee"), "log.csv")
    for names in ((*"abcdef",), ("abcd",)):
        with pytest.raises(ExperimentError, match="expected at most"):
            _log.refuse_odd_names(log(*names), "log.csv")
    _log.refuse_size(10, "log.csv")
    with pytest.raises(ExperimentError, match="found 11 rows"):
        _log.refuse_size(11, "log.csv")


@pytest.mark.parametrize("depth", [1, 4, 5])
def test_structs_within_structs_are_columns_to_a_depth_of_four(tmp_path, depth):
    value = {"q": np.arange(100.0)}
    for k in range(depth - 1):
        value = {f"inner{k}": value}
    savemat(tmp_path / "log.mat", {"log": value, "t": np.arange(100.0)})
    log = matlab.open_matlab(tmp_path / "log.mat", "log.mat")
    assert any(name.endswith(".q") for name in log.names) == (depth <= 4)
    assert "t" in log.names


@pytest.mark.parametrize("more", [0, 1])
@pytest.mark.parametrize("as_records", [False, True])
def test_objects_within_objects_of_a_json_file_are_columns_to_a_depth(tmp_path, more, as_records):
    """As a record of lists, and as a list of records."""
    value = 1.5 if as_records else [0.5 * k for k in range(100)]
    for _ in range(json_records.DEPTH + more):
        value = {"in": value}
    path = tmp_path / "log.json"
    path.write_text(json.dumps([{"t": k, **value} for k in range(100)] if as_records else value))
    name = ".".join(["in"] * (json_records.DEPTH + more))
    names = open_log(path, "log.json").names if as_records or not more else ()
    assert (name in names) == (more == 0)
    if not names:
        with pytest.raises(ExperimentError):
            open_log(path, "log.json")


@pytest.mark.parametrize(
    "kind", ["float64", ("sequence", (0, "float64")), [1, ("array", ["geometry_msgs/msg/Pose", 3])]]
)
def test_types_of_a_bag_may_hold_words_and_sizes_at_any_depth(kind):
    _check_field("position", kind, "bag")


@pytest.mark.parametrize(
    "kind",
    ["a b", "x/../y", "a\nimport os", ("sequence", (0, "__import__('os')")), [1, [2, [3, "a;b"]]]],
)
def test_a_type_of_a_bag_that_is_no_word_is_refused_at_any_depth(kind):
    with pytest.raises(ExperimentError, match="expected words joined by slashes"):
        _check_field("position", kind, "bag")
    with pytest.raises(ExperimentError, match="as its type"):
        _check_field("position", [kind[:0] or 1.5, 2.5], "bag")


# frequencies


def moved(frequency, seconds, rate=100.0, noise=0.0):
    t = np.arange(int(seconds * rate)) / rate
    x = np.sin(2 * np.pi * frequency * t)
    x += noise * np.random.default_rng(0).standard_normal(len(t))
    return td.experiment(
        {"t": t, "x": x, "F": np.cos(t)},
        axis="prismatic",
        time="t",
        position="x",
        actuator_force="F",
        inertia=0.1,
    )


def test_no_bandwidth_below_one_hertz_is_chosen():
    assert default_bandwidth(moved(0.05, 100.0, noise=1e-3)) == LOWEST == 1.0


def test_the_bandwidth_of_a_wide_motion_is_a_tenth_of_the_sample_rate():
    random = np.random.default_rng(0)
    wide = moved(1.0, 60.0)
    record = wide.records[0]
    tones = sum(
        np.sin(2 * np.pi * f * record.time + random.uniform(0, 6)) / f**2
        for f in np.arange(0.5, 12.0, 0.5)
    )
    signals_ = {**record.signals, "device.position": tones}
    wide = replace(wide, records=(replace(record, signals=signals_),))
    assert default_bandwidth(wide) == pytest.approx(10.0, rel=0.03)


@pytest.mark.parametrize("cutoff", [2.0, 20.0, 200.0])
def test_beyond_its_reach_nothing_is_left_of_a_row_and_within_half_of_it_something(cutoff):
    h = 1e-3
    far = reach(cutoff, h)
    n = 4 * far + 1
    m = margin(n, h)
    y, out = np.zeros((n, 1)), np.empty((n + 2 * m, 1))
    y[n // 2] = 1.0
    filter_both_ways(y, out, *sections(cutoff, h))
    answer = np.abs(out[m : m + n, 0])
    away = np.abs(np.arange(n) - n // 2)
    assert answer[away > far].max() < 1e-15 * answer.max()
    assert answer[away > far // 3].max() > 1e-15 * answer.max()


@given(
    rows=st.lists(st.integers(0, 499), min_size=1, max_size=6, unique=True),
    far=st.integers(1, 40),
    m=st.integers(1, 60),
)
def test_windows_hold_every_row_with_what_it_reaches_and_do_not_overlap(rows, far, m):
    rows = np.array(sorted(rows))
    spans = windows(rows, 500, m, far)
    for row in rows:
        (inside,) = [w for w in spans if w[0] <= row < w[1]]
        assert inside[0] <= max(row - far, 0) and inside[1] >= min(row + far + 1, 500)
    assert all(a[1] <= b[0] for a, b in zip(spans, spans[1:], strict=False))
    # what is mirrored at an end lies within the window there
    if spans[0][0] == 0:
        assert spans[0][1] >= min(m + 1, 500)
    if spans[-1][1] == 500:
        assert spans[-1][0] <= max(499 - m, 0)
    assert spans == [(0, 500)] or sum(b - a for a, b in spans) <= 0.7 * 500
    assert json.dumps(spans)  # plain numbers
