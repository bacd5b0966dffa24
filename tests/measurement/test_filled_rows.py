"""What fills lost rows, and by how much it errs: exactly, where that is known by hand."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.measurement.record_clock import RecordClock
from teleopdesign.measurement.resample import filling_error, interpolate_by_rule

H = 0.01


def clock_of(places, segments=None):
    """A clock whose rows lie at these samples."""
    places = np.asarray(places)
    n = int(places[-1]) + 1
    whole = segments or (slice(0, n),)
    rows = tuple(slice(*np.searchsorted(places, [s.start, s.stop]).tolist()) for s in whole)
    return RecordClock(places, H * places, places, H * np.arange(n), H, whole, rows, 0.0)


@given(
    c=st.lists(st.floats(-3.0, 3.0), min_size=4, max_size=4),
    lost=st.lists(st.integers(3, 56), max_size=6),
)
def test_a_position_that_moves_as_a_cubic_is_filled_without_error(c, lost):
    places = np.setdiff1d(np.arange(60), lost)
    x = np.polyval(c, places / 30.0 - 1.0)
    assume(np.all(np.diff(x)) and np.all(x[2:] != x[:-2]))  # else it stands, as far as rows tell
    assert filling_error(x, clock_of(places), "position", step=0.0) == pytest.approx(0.0, abs=1e-12)
    filled = interpolate_by_rule(x, places * 1.0, np.arange(60.0), "position", step=0.0)
    assert filled == pytest.approx(np.polyval(c, np.arange(60) / 30.0 - 1.0), abs=1e-9)


@pytest.mark.parametrize("step", [0.5, 1.0, 2.0])
def test_steps_of_an_encoder_are_filled_by_steps(step):
    """Half a step a row: between two that differ by a step, it reads the first or the second."""
    even, slow = np.arange(80), np.arange(80) // 2
    assert filling_error(step * even, clock_of(even), "position", step=step) == 0.0
    error = filling_error(step * slow, clock_of(even), "position", step=step)
    assert error == pytest.approx(step / np.sqrt(2), rel=0.02)
    # three steps a row are no longer seen one by one
    fast = 3 * even + even % 2
    error = filling_error(step * fast, clock_of(even), "position", step=step)
    assert error == pytest.approx(step * 4 / 3, rel=1e-9)


@given(
    gaps=st.lists(st.integers(1, 8), min_size=2, max_size=20),
    begin=st.integers(-6, 6),
    seed=st.integers(0, 99),
)
def test_a_command_acts_in_a_sample_with_its_mean_and_before_its_first_row_as_in_it(
    gaps, begin, seed
):
    """At eighths of a sample; no two rows are further apart than one."""
    at = (begin + np.cumsum([0, *gaps])) / 8.0
    values = np.random.default_rng(seed).normal(size=len(at))
    grid = np.arange(int(np.ceil(at[-1])) + 2.0)
    made = interpolate_by_rule(values, at, grid, "held", step=0.0, slower_clock=True)
    times = grid[:, None] + (np.arange(8) + 0.5) / 8.0
    which = np.maximum(np.searchsorted(at, times, side="right") - 1, 0)
    assert made == pytest.approx(values[which].mean(axis=1), abs=1e-12)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_a_record_fills_each_signal_by_its_rule_and_says_by_how_much_that_errs(size):
    """In any unit: positions by a curve, forces by a line; the error is a part of the force."""
    t = H * np.arange(1000)
    x, u = size * np.sin(2 * np.pi * 1.37 * t + 0.3), size * np.cos(2 * np.pi * 0.9 * t)
    kept = np.setdiff1d(np.arange(1000), np.arange(50, 950, 50))
    f = size * np.sin(2 * np.pi * 2.1 * t)
    table = {"t": t[kept], "x": x[kept], "u": u[kept], "f": f[kept]}
    made = td.experiment(
        table, axis="prismatic", position="x", actuator_force="u", interaction_force="f",
        inertia=1.0,
    )  # fmt: skip
    (record,) = made.records
    off = {k: record.signals[f"device.{k}"] - y for k, y in
           (("position", x), ("actuator_force", u), ("interaction_force", f))}  # fmt: skip
    assert np.abs(off["position"]).max() < 2e-5 * size
    bend = (2 * np.pi * 2.1 * H) ** 2 / 2 * np.abs(f[50:950:50]).max()
    assert np.abs(off["interaction_force"]).max() == pytest.approx(bend, rel=0.02)
    (note,) = (s for s in record.reading if s.topic == "lost rows")
    lost = 18 / 1000
    rms = [(2 * np.pi * k * H) ** 2 / 2 * size / np.sqrt(2) for k in (0.9, 2.1)]
    error = np.sqrt(lost * sum(r**2 for r in rms) / (np.mean(u**2) + np.mean(f**2)))
    assert note.size == pytest.approx(error, rel=0.02)
    assert "18 rows lost, 1.8 %" in note.observed
    assert f"adds at most {100 * note.size:.2g} % of the force" in note.effect
