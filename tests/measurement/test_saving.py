"""An experiment that is saved reads as the same experiment: model, channels, records, units."""

import gzip

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement import load_experiment


def same(one, other):
    for (name, value), (name_2, value_2) in zip(one.items(), other.items(), strict=True):
        assert name == name_2
        if value is None:
            assert value_2 is None
        elif isinstance(value, dict):
            same(value, value_2)
        else:
            assert value.value == value_2.value and value.unit == value_2.unit
            assert (value.fixed, value.stderr) == (value_2.fixed, value_2.stderr)


@pytest.mark.parametrize("which", ["rod", "pair"])
def test_what_is_saved_is_read_as_the_same(request, which, tmp_path):
    folder = request.getfixturevalue(which)
    toml = folder / "experiment.toml"
    more = {
        "viscous = {}": 'viscous = { damping = { value = 3, unit = "N*s/m", fixed = true } }\n'
        "stribeck = { level = { value = 0.7, stderr = 0.05 } }\nbias = { force = 0.25 }",
        "contact_position =": "damping = 0.5\ncontact_position =",
    }
    text = toml.read_text()
    for before, after in more.items():
        text = text.replace(before, after)
    toml.write_text(text)
    ours = load_experiment(folder)
    again = load_experiment(ours.save(tmp_path / "deep" / "saved"))
    assert again.title == ours.title and list(again.bodies) == list(ours.bodies)
    for name, body in ours.bodies.items():
        assert again.bodies[name].axis == body.axis
        same(
            {"inertia": body.inertia, **body.effects},
            {
                "inertia": again.bodies[name].inertia,
                **again.bodies[name].effects,
            },
        )
    assert (again.environment is None) == (ours.environment is None)
    if ours.environment is not None:
        same(dict(ours.environment.values), dict(again.environment.values))
        same(dict(ours.environment.effects), dict(again.environment.effects))
    assert again.bandwidth == ours.bandwidth
    assert [(r.use, r.offset_names) for r in again.records] == [
        (r.use, r.offset_names) for r in ours.records
    ]
    for one, other in zip(ours.records, again.records, strict=True):
        assert other.sample_time == pytest.approx(one.sample_time, rel=1e-9)
        assert list(other.signals) == list(one.signals)
        for key in one.signals:
            assert np.array_equal(one.signals[key], other.signals[key]), key
    for key, channel in ours.channels.items():
        if channel.body is not None:
            kept = again.channels[key]
            assert (kept.resolution, kept.noise) == (channel.resolution, channel.noise)
    with pytest.raises(ExperimentError, match="saved/experiment.toml: is there already"):
        again.save(tmp_path / "deep" / "saved")


def test_several_records_of_a_use_are_numbered_and_one_is_not(rod, tmp_path):
    toml = rod / "experiment.toml"
    text = toml.read_text()
    toml.write_text(text + '[[records]]\nfile = "more.csv"\nuse = "fit"\n')
    (rod / "more.csv").write_text((rod / "fit.csv").read_text())
    names = sorted(p.name for p in load_experiment(rod).save(tmp_path / "s").iterdir())
    assert names == ["check.csv.gz", "experiment.toml", "fit_1.csv.gz", "fit_3.csv.gz"]
    with gzip.open(tmp_path / "s" / "fit_1.csv.gz", "rt") as file:
        assert file.readline().startswith("t,device.")


def test_segments_and_a_measured_force_are_kept(rod, tmp_path):
    lines = (rod / "fit.csv").read_text().splitlines()
    half = len(lines) // 2
    for name in ("fit.csv", "check.csv"):
        rows = (rod / name).read_text().splitlines()
        labels = ["part", *("1" if k < half else "4" for k in range(1, len(rows)))]
        (rod / name).write_text("\n".join(f"{r},{p}" for r, p in zip(rows, labels, strict=True)))
    toml = rod / "experiment.toml"
    text = toml.read_text().replace(
        '{ column = "u", unit = "N" }', '{ column = "u", unit = "N", measured = true }'
    )
    toml.write_text(text.replace("[channels]", '[channels]\nsegment = { column = "part" }'))
    ours = load_experiment(rod)
    again = load_experiment(ours.save(tmp_path / "s"))
    assert [r.segments for r in again.records] == [r.segments for r in ours.records]
    assert len(ours.records[0].segments) == 2
    assert "2 segments" in repr(ours.records[0])
    assert again.channels["device.actuator_force"].measured


def test_a_folder_that_cannot_be_made_is_named(rod, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(ExperimentError, match="^s: cannot be written: Not a directory"):
        load_experiment(rod).save(tmp_path / "file" / "s")
