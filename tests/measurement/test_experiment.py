import re

import numpy as np
import pytest
from clock import takes_less_than
from measurement.rod_example import rod_columns, rows

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement import load_experiment


def test_a_record_is_in_si_units(rod):
    record = load_experiment(rod).records[0]
    columns = rod_columns()
    np.testing.assert_allclose(record.signals["device.position"], columns["x"] * 1e-3, rtol=1e-5)
    np.testing.assert_allclose(record.signals["device.actuator_force"], columns["u"], rtol=1e-5)
    assert set(record.signals) == {
        "device.position",
        "device.actuator_force",
        "device.interaction_force",
    }
    assert record.sample_time == 0.01
    np.testing.assert_allclose(record.time, columns["t"], atol=1e-12)
    assert record.segments == (slice(0, 150),)
    assert all(signal.shape == record.time.shape for signal in record.signals.values())


def test_what_is_known_of_a_channels_error_is_in_si_units(rod):
    channels = load_experiment(rod).channels
    assert channels["device.position"].resolution == pytest.approx(5e-6)
    assert channels["device.position"].noise is None
    assert channels["device.interaction_force"].noise == 0.01


def test_an_experiment_knows_its_records_and_model(rod):
    experiment = load_experiment(rod)
    assert [record.file for record in experiment.fit_records] == ["fit.csv"]
    assert [record.file for record in experiment.check_records] == ["check.csv"]
    assert [set(record.offset_names) for record in experiment.records] == [set(), {"position_zero"}]
    assert experiment.bandwidth == 20
    assert experiment.axis("device") == "prismatic"
    body = experiment.bodies["device"]
    assert (body.inertia.value, body.inertia.unit, body.inertia.fixed) == (0.15, "kg", False)
    assert body.effects["coulomb"]["level"].value == 0.5
    assert body.effects["coulomb"]["level"].where == (
        "rod/experiment.toml: model.device.effects.coulomb.level"
    )
    assert body.effects["viscous"] == {}
    with pytest.raises(ExperimentError, match="no body"):
        experiment.axis("slave")


def test_one_column_is_scaled_and_moved_as_its_channel_says(rod, edit):
    before = load_experiment(rod).records[0].signals["device.position"]
    edit(rod / "experiment.toml", 'unit = "mm", ', 'unit = "mm", scale = -2, offset = 3, ')
    after = load_experiment(rod).records[0].signals["device.position"]
    np.testing.assert_allclose(after, 3e-3 - 2 * before, rtol=1e-12)
    edit(rod / "experiment.toml", "offset = 3, ", "")
    after = load_experiment(rod).records[0].signals["device.position"]
    np.testing.assert_allclose(after, -2 * before, rtol=1e-12)


def test_two_bodies_have_separate_axes_and_units(pair):
    experiment = load_experiment(pair)
    signals = experiment.records[0].signals
    ramp = np.arange(150.0)
    np.testing.assert_allclose(signals["master.position"], ramp)
    np.testing.assert_allclose(signals["slave.position"], np.deg2rad(ramp))
    np.testing.assert_allclose(signals["slave.actuator_force"], ramp * 1e-3)
    assert experiment.channels["slave.actuator_force"].noise == pytest.approx(2e-3)
    assert (experiment.axis("master"), experiment.axis("slave")) == ("prismatic", "revolute")
    assert experiment.environment.values["contact_position"].unit == "deg"
    assert experiment.environment.effects == {"contact_damping": {}}
    assert experiment.check_records == ()
    assert experiment.records[0].sample_time == 0.01


def test_quotes_around_a_channel_with_a_point_may_be_left_out(pair):
    quoted = load_experiment(pair).channels
    file = pair / "experiment.toml"
    file.write_text(re.sub(r'^"(\w+\.\w+)"', r"\1", file.read_text(), flags=re.MULTILINE))
    assert load_experiment(pair).channels == quoted


@pytest.mark.parametrize("place", ["[channels]\n", "[model.device]\n"])
def test_a_sample_rate_stands_for_the_time(rod, edit, place):
    timed = load_experiment(rod).records[0]
    file = rod / "experiment.toml"
    edit(file, 'time = { column = "t", unit = "s" }', "")
    rate = 'sample_rate = { value = 0.1, unit = "kHz" }\n'
    edit(file, place, place + rate if place == "[channels]\n" else rate + place)
    counted = load_experiment(rod).records[0]
    np.testing.assert_allclose(counted.time, timed.time, atol=1e-12)


def test_an_experiment_can_be_loaded_from_inside_its_folder(rod, monkeypatch):
    monkeypatch.chdir(rod)
    assert load_experiment(".").folder.name == "rod"


def test_spaces_quotes_and_a_byte_order_mark_in_the_header_do_no_harm(rod):
    plain = load_experiment(rod).records[0]
    text = (rod / "fit.csv").read_text().replace("t,u,x,f_h", ' t , "u",x ,"f_h"')
    (rod / "fit.csv").write_text("\ufeff" + text.replace("\n", "\r\n") + "\r\n\r\n")
    other = load_experiment(rod).records[0]
    for name, signal in plain.signals.items():
        np.testing.assert_array_equal(other.signals[name], signal)


def test_columns_that_no_channel_uses_may_hold_anything(rod):
    lines = (rod / "fit.csv").read_text().splitlines()
    remarks = [f"{lines[0]},remark", *(f'{line},"start, then stop"' for line in lines[1:])]
    (rod / "fit.csv").write_text("\n".join(remarks))
    assert len(load_experiment(rod).records[0].time) == 150


@pytest.mark.parametrize("ending", [".csv.gz", ".parquet", ".mat", ".h5"])
def test_all_formats_hold_the_same_record(rod, edit, ending):
    plain = load_experiment(rod).records[0]
    columns = {name: np.array([float(f"{v:.6g}") for v in c]) for name, c in rod_columns().items()}
    write_table(rod / f"fit{ending}", columns)
    edit(rod / "experiment.toml", "fit.csv", f"fit{ending}")
    other = load_experiment(rod).records[0]
    assert other.sample_time == plain.sample_time
    np.testing.assert_array_equal(other.time, plain.time)
    for name, signal in plain.signals.items():
        np.testing.assert_array_equal(other.signals[name], signal)


def write_table(path, columns):
    import gzip

    from scipy.io import savemat

    if path.suffix == ".gz":
        path.write_bytes(gzip.compress(rows(columns).encode()))
    elif path.suffix == ".mat":
        savemat(path, columns | {"unused": np.zeros((2, 3))})
    elif path.suffix == ".parquet":
        parquet = pytest.importorskip("pyarrow.parquet")
        import pyarrow

        parquet.write_table(pyarrow.table(columns), path)
    else:
        h5py = pytest.importorskip("h5py")
        with h5py.File(path, "w") as file:
            for name, values in columns.items():
                file[name] = values[:, None]


def test_a_dataset_in_a_group_is_named_by_its_path(rod, edit):
    h5py = pytest.importorskip("h5py")
    with h5py.File(rod / "fit.h5", "w") as file:
        for name, values in rod_columns().items():
            file[f"run1/{name}"] = values
    text = (rod / "experiment.toml").read_text()
    text = re.sub(r'column = "(\w+)"', r'column = "run1/\1"', text).replace("fit.csv", "fit.h5")
    text = text[: text.rindex("[[records]]")]
    (rod / "experiment.toml").write_text(text)
    assert len(load_experiment(rod).records[0].time) == 150


@pytest.mark.slow
def test_ten_minutes_at_1_khz_are_read_in_seconds(rod):

    block = [
        f"%s,{u:.5f},{x:.7f},{f:.4f}" for u, x, f in np.random.default_rng(1).normal(size=(1000, 3))
    ]
    with (rod / "fit.csv").open("w") as file:
        file.write("t,u,x,f_h\n")
        for second in range(600):
            for i, line in enumerate(block):
                file.write(line % f"{second + i / 1000:.3f}" + "\n")
    with takes_less_than(10):  # s; the whole test takes 2 on a quiet machine
        record = load_experiment(rod).records[0]
    assert len(record.time) == 600_000
