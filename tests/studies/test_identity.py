"""A study counts as another one if a record or folder that it reads has changed."""

import shutil
from pathlib import Path

import pytest

import teleopdesign as td


def samples(experiment):
    """Of the records of a folder."""
    return sum(len(r.time) for r in td.load_experiment(experiment).records)


@pytest.fixture
def rod(tmp_path):
    return Path(shutil.copytree(td.example("rod"), tmp_path / "rod"))


def test_a_folder_that_does_not_vary_counts_as_well(rod):
    def identity():
        axes = {"experiment": str(rod)}
        measures = {"samples": lambda count: count}
        return td.study(samples, axes, measures=measures, workers=1).data.attrs["study"]

    before = identity()
    toml = rod / "experiment.toml"
    toml.write_text(toml.read_text() + "\n# a remark\n")
    assert identity() != before
