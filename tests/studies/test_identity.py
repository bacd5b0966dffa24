"""A study counts as another one if a record or folder that it reads has changed."""

import shutil
from pathlib import Path

import pytest

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError


def samples(experiment):
    """Of the records of a folder."""
    return sum(len(r.time) for r in td.load_experiment(experiment).records)


@pytest.fixture
def rod(tmp_path):
    return Path(shutil.copytree(td.example("rod"), tmp_path / "rod"))


@pytest.mark.slow
def test_a_record_that_has_changed_makes_another_study(rod, tmp_path):
    out = tmp_path / "study.nc"

    def study():
        measures = {"samples": lambda count: count}
        axes = {"experiment": [str(rod)]}
        return td.study(samples, axes, measures=measures, out=out, workers=1)

    first = study()
    assert study().data.attrs["study"] == first.data.attrs["study"]
    shutil.copy(rod / "check.csv.gz", rod / "fit.csv.gz")
    with pytest.raises(ExperimentError, match="holds another study"):
        study()


def test_a_folder_that_does_not_vary_counts_as_well(rod):
    def identity():
        axes = {"experiment": str(rod)}
        measures = {"samples": lambda count: count}
        return td.study(samples, axes, measures=measures, workers=1).data.attrs["study"]

    before = identity()
    toml = rod / "experiment.toml"
    toml.write_text(toml.read_text() + "\n# a remark\n")
    assert identity() != before
