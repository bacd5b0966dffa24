import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from measurement.rod_example import rod_columns, rows

from teleopdesign.measurement import load_experiment


def with_segments(folder, labels, stamps=None):
    text = (folder / "experiment.toml").read_text()
    text = text.replace("[comparison]", 'segment = { column = "s" }\n[comparison]')
    (folder / "experiment.toml").write_text(text)
    columns = rod_columns() | {"s": labels}
    if stamps is not None:
        columns["t"] = stamps
    for name in ("fit.csv", "check.csv"):
        (folder / name).write_text(rows(columns))
    return load_experiment(folder).records[0]


def test_samples_of_different_segments_are_not_consecutive(rod):
    labels = np.repeat([3, 4, 3], 50)
    stamps = np.arange(150) / 100 + np.repeat([0.0, 7.0, 20.0], 50)
    record = with_segments(rod, labels, stamps)
    assert record.segments == (slice(0, 50), slice(50, 100), slice(100, 150))
    assert record.sample_time == 0.01
    np.testing.assert_allclose(record.time, stamps, atol=1e-12)


def test_a_pause_within_a_segment_parts_it(rod):
    stamps = np.arange(150) / 100
    stamps[30:] += 0.3
    record = with_segments(rod, np.repeat([0, 1], 75), stamps)
    assert record.segments == (slice(0, 30), slice(30, 75), slice(75, 150))
    np.testing.assert_allclose(record.time, stamps, atol=1e-9)
    assert "1 pause, the longest 0.31 s" in record.reading[0].observed


def with_stamps(folder, stamps, digits=9):
    columns = rod_columns() | {"t": stamps}
    columns = {name: np.resize(values, len(stamps)) for name, values in columns.items()}
    lines = [",".join(columns)]
    for t, *others in zip(*columns.values(), strict=True):
        lines.append(",".join([f"{t:.{digits}f}", *(f"{v:.6g}" for v in others)]))
    (folder / "fit.csv").write_text("\n".join(lines))
    return load_experiment(folder).records[0]


@pytest.mark.slow
@given(
    rate=st.floats(70.0, 2000.0),
    start=st.floats(-100.0, 1e6),
    seed=st.integers(0, 2**32 - 1),
)
@settings(
    max_examples=30,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
def test_jitter_below_a_tenth_of_a_sample_does_not_change_the_rate(rod, rate, start, seed):
    count = 300 if rate < 200 else 2500
    jitter = np.random.default_rng(seed).uniform(-0.09, 0.09, count)  # two make one step's error
    record = with_stamps(rod, start + (np.arange(count) + jitter) / rate)
    # the slope has a standard deviation of 0.18 / count^1.5: nearly seven of them
    assert record.sample_time * rate == pytest.approx(1, abs=1.2 / count**1.5)
    np.testing.assert_allclose(np.diff(record.time), 1 / rate, rtol=1e-3)


@pytest.mark.parametrize(("rate", "digits"), [(1024, 3), (2000, 3), (60, 2), (333.3, 3), (3000, 4)])
def test_stamps_that_are_rounded_give_the_true_rate(rod, rate, digits):
    count = int(3 * rate)
    record = with_stamps(rod, np.arange(count) / rate, digits)
    assert record.sample_time * rate == pytest.approx(1, abs=10.0**-digits)
    assert len(record.time) == count
