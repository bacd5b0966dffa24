"""An experiment from arrays: which column, unit, rows and first values, as the arguments say."""

import re

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.bandwidth import default_bandwidth

H = 0.005
T = H * np.arange(4000)
X = 0.1 * np.sin(2 * np.pi * 0.6 * T) + 0.05 * np.sin(2 * np.pi * 1.9 * T + 1.0)
V = np.gradient(X, T)
FORCE = 0.4 * np.gradient(V, T) + 0.6 * np.sign(V) + 2.0 * V
DATA = {"t": T, "x": X, "u": FORCE}


def made(data=None, axis="prismatic", position="x", actuator_force="u", **more):
    return td.experiment(
        DATA if data is None else data,
        axis=axis,
        position=position,
        actuator_force=actuator_force,
        **more,
    )


def test_without_an_inertia_the_model_starts_from_the_motion():
    device = made().bodies["device"]
    assert device.inertia.value == pytest.approx(0.4, rel=0.05) and not device.inertia.fixed
    assert device.effects["coulomb"]["level"].value == pytest.approx(0.6, rel=0.1)
    assert device.effects["viscous"]["damping"].value == pytest.approx(2.0, rel=0.1)
    assert float(f"{device.inertia.value:.3g}") == device.inertia.value
    assert device.inertia.where.endswith("inertia")
    known = made(inertia=0.7, effects=("coulomb", "bias")).bodies["device"]
    assert known.inertia.value == 0.7 and known.effects == {"coulomb": {}, "bias": {}}
    other = made(effects=("viscous", "bias")).bodies["device"]
    assert list(other.effects) == ["viscous", "bias"] and other.effects["bias"] == {}
    # the fitted rows alone tell the first values
    spoilt = {**DATA, "u": np.where(T < 10, FORCE, -FORCE)}
    half = made(spoilt, fit=(0, 9.9)).bodies["device"]
    assert half.inertia.value == pytest.approx(0.4, rel=0.05)
    with pytest.raises(
        ExperimentError, match=r"the motion tells no inertia of device \(-0\.399 kg"
    ):
        made({**DATA, "u": -FORCE})


@pytest.mark.parametrize(
    ("name", "unit", "axis", "factor"),
    [
        ("x", None, "prismatic", 1.0),
        ("x (mm)", None, "prismatic", 1e-3),
        ("angle_deg", None, "revolute", np.pi / 180),
        ("angle_deg", "rad", "revolute", 1.0),
        ("q", "turns", "revolute", 2 * np.pi),
    ],
)
def test_the_unit_is_the_stated_one_that_of_the_name_or_si(name, unit, axis, factor):
    data = {"t": T, name: X, "u": FORCE}
    units = {} if unit is None else {name: unit}
    record = made(data, axis, position=name, units=units, inertia=1.0).records[0]
    assert record.signals["device.position"] == pytest.approx(factor * X)
    written = {"column": name, "unit": "m" if axis == "prismatic" else "rad"}
    record = made(data, axis, position=written, units=units, inertia=1.0).records[0]
    assert record.signals["device.position"] == pytest.approx(X)


def test_a_time_is_the_column_that_sounds_like_one_or_a_rate():
    assert made(inertia=1.0).records[0].sample_time == pytest.approx(H)
    ms = {"time_ms": 1e3 * T, "x": X, "u": FORCE}
    assert made(ms, inertia=1.0).records[0].sample_time == pytest.approx(H)
    assert made(ms, time="time_ms", inertia=1.0).records[0].sample_time == pytest.approx(H)
    table = {"column": "time_ms", "unit": "s"}
    assert made(ms, time=table, inertia=1.0).records[0].sample_time == pytest.approx(1e3 * H)
    counted = made({"x": X, "u": FORCE}, sample_rate=100.0, inertia=1.0).records[0]
    assert counted.sample_time == 0.01 and len(counted.time) == 4000
    with pytest.raises(ExperimentError, match="time: no column sounds like a time, found x, u"):
        made({"x": X, "u": FORCE}, inertia=1.0)


def test_spans_are_records_and_all_rows_are_one_where_there_are_none():
    (whole,) = made(inertia=1.0).records
    assert (whole.file, whole.use, len(whole.time)) == ("fit", "fit", 4000)
    first, second, check = made(inertia=1.0, fit=[(0, 5), (6, 11)], check=(12, 20)).records
    assert [r.use for r in (first, second, check)] == ["fit", "fit", "check"]
    assert [len(r.time) for r in (first, second, check)] == [1000, 1000, 1600]
    assert first.file == "fit 0-5 s" and check.file == "check 12-20 s"
    assert check.signals["device.position"] == pytest.approx(X[2400:])
    one, other = made(inertia=1.0, check=(3, 8)).records
    assert one.use == "fit" and len(one.time) == 4000 and len(other.time) == 1000
    twice = made(inertia=1.0, fit=[(0, 5), (0, 5)]).records
    assert [r.file for r in twice] == ["fit 0-5 s", "fit 0-5 s (2)"]
    # spans may touch, and spans of one use may overlap
    made(inertia=1.0, fit=[(0, 5), (4, 8)], check=(8, 12))


@pytest.mark.parametrize("stamps", [T, T + 1000.0, T + 1.7e9, None], ids=str)
def test_a_record_counts_its_time_from_the_first_row_of_its_log(stamps):
    """A warm-up begins there, whatever the clock shows and whichever span is read."""
    data = {"x": X, "u": FORCE} | ({} if stamps is None else {"t": stamps})
    rate = {"sample_rate": 200.0} if stamps is None else {}
    records = made(data, inertia=1.0, fit=(0, 5), check=(12, 20), **rate).records
    assert [r.time[0] for r in records] == pytest.approx([0.0, 12.0], abs=1e-5)
    assert [r.time[-1] for r in records] == pytest.approx([4.995, 19.995], abs=1e-5)


@pytest.mark.parametrize(
    ("spans", "message"),
    [
        ({"fit": (0, 5), "check": (4.9, 9)}, "which overlaps fit (0, 5)"),
        ({"fit": (5, 9), "check": (4, 5.1)}, "which overlaps fit (5, 9)"),
        ({"fit": [(0, 5), 6]}, "expected (begin, end) in s, or several"),
        ({"fit": [(0, 5, 6)]}, "expected (begin, end) in s, or several"),
        ({"fit": (0, 5, 9)}, "expected (begin, end) in s, or several"),
        ({"fit": [7]}, "expected (begin, end) in s, or several"),
        ({"fit": []}, "fit: found no span, expected at least one (begin, end)"),
        ({"fit": (5, 5)}, "expected [begin, end]"),
        ({"fit": (30, 40)}, "found no row from 30 to 40 s, the log ends at 19.995 s"),
    ],
)
def test_spans_that_make_no_records_are_refused(spans, message):
    with pytest.raises(ExperimentError, match=re.escape(message)):
        made(inertia=1.0, **spans)


def test_names_that_are_not_there_are_answered_with_the_nearest():
    with pytest.raises(ExperimentError, match='units: no column "xx", has t, x, u'):
        made(inertia=1.0, units={"xx": "mm"})
    with pytest.raises(ExperimentError, match='axis: found "prismatc".*did you mean "prismatic"'):
        made(axis="prismatc", inertia=1.0)
    with pytest.raises(ExperimentError, match="data: found list, expected a DataFrame"):
        made([1, 2, 3], inertia=1.0)
    with pytest.raises(ExperimentError, match="found str, .* of a file: teleopdesign new FILE"):
        made("log.csv", inertia=1.0)
    with pytest.raises(ExperimentError, match="found list, .* dict of arrays$"):
        made([1], inertia=1.0)


def test_the_index_of_a_table_is_a_column_where_it_is_a_time_or_has_a_name():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"x": X, "u": FORCE})
    for index in (pandas.Index(T, name="t"), pandas.Index(T), pandas.to_timedelta(T, unit="s")):
        record = made(frame.set_index(index), inertia=1.0).records[0]
        assert record.sample_time == pytest.approx(H)
    with pytest.raises(ExperimentError, match="no column sounds like a time, found x, u"):
        made(frame, inertia=1.0)  # the number of a row is none
    dated = frame.assign(time_ms=pandas.Timestamp("2026-11-22") + pandas.to_timedelta(T, unit="s"))
    assert made(dated, inertia=1.0).records[0].sample_time == pytest.approx(H)


def test_a_dataset_says_its_units():
    xarray = pytest.importorskip("xarray")
    data = xarray.Dataset(
        {"x": ("time", 1e3 * X, {"units": "mm"}), "u": ("time", FORCE, {"unit": "N"})},
        {"time": ("time", 1e3 * T, {"units": "ms"})},
    )
    record = made(data, inertia=1.0).records[0]
    assert record.signals["device.position"] == pytest.approx(X)
    assert record.sample_time == pytest.approx(H)


@pytest.mark.parametrize(("empty", "is_read"), [(800, True), (801, False)])
def test_up_to_a_fifth_of_the_rows_may_lack_a_number(empty, is_read):
    rows = np.random.default_rng(0).choice(np.arange(1, 3999), empty, replace=False)
    data = {"t": T.copy(), "x": X.copy(), "u": FORCE}
    data["x"][rows] = np.nan
    if is_read:
        steps = [s.observed for s in made(data, inertia=1.0).reading]
        assert f"{empty} rows with a cell that holds no number" in steps
        return
    with pytest.raises(
        ExperimentError, match=r"no number in 20% of the rows, expected at most 20%"
    ):
        made(data, inertia=1.0)


def test_rows_lost_in_a_log_leave_its_bandwidth():
    """The jump of the position across the gap is no motion."""
    t = 1e-3 * np.arange(20_000)
    x = 5e-6 * np.round((0.1 * np.sin(4 * t) + 0.05 * np.sin(12 * t + 1.0)) / 5e-6)
    data = {"t": t, "x": x, "u": np.sin(4 * t)}
    kept = (t < 6.0) | (t >= 6.5)
    cut = {name: column[kept] for name, column in data.items()}
    whole, parted = (default_bandwidth(made(one, inertia=1.0)) for one in (data, cut))
    assert parted == pytest.approx(whole, rel=0.2)


def test_units_that_nothing_states_are_guesses_also_in_a_saved_folder(tmp_path):
    data = {"t": T, "x": X, "force_N": FORCE}
    names = {"position": "x", "actuator_force": "force_N"}
    experiment = td.experiment(data, axis="prismatic", inertia=1.0, **names)
    assert set(experiment.guesses) == {"channels.time.unit", "channels.position.unit"}
    loaded = td.load_experiment(experiment.save(tmp_path / "saved"))
    assert loaded.guesses == experiment.guesses
    stated = td.experiment(data, axis="prismatic", inertia=1.0, units={"t": "s", "x": "m"}, **names)
    assert not stated.guesses
