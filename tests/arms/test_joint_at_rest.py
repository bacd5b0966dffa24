"""A joint that rests throughout the records of an arm: its friction is not tested."""

import csv
import gzip

import numpy as np
import pytest
from arms.arm_simulator import random_arm, write_experiment

import teleopdesign as td
from teleopdesign.diagnose.search_plan import QUICK


def hold(file, joint):
    """Write a constant position and a small command of one joint into a record."""
    with gzip.open(file, "rt", newline="") as stream:
        names, *rows = csv.reader(stream)
    for k, row in enumerate(rows):
        row[names.index(f"q{joint}")] = "0.3"
        row[names.index(f"u{joint}")] = f"{0.05 * np.sin(k / 50):.6f}"
    with gzip.open(file, "wt", newline="") as stream:
        csv.writer(stream).writerows([names, *rows])


@pytest.mark.slow
def test_a_joint_at_rest_has_no_adequate_model(tmp_path):
    """The verdict on joint 2 was `model_adequate`, with an error of 0.00 %."""
    generator = np.random.default_rng(5)
    arm = random_arm(generator, 2)
    folder = write_experiment(tmp_path / "two", arm, generator, None, seconds=10.0)
    for use in ("fit", "check"):
        hold(folder / f"{use}.csv.gz", 2)
    diagnosis = td.find_missing(
        td.load_experiment(folder), plan=QUICK, among=("spring", "quadratic_drag")
    )
    assert diagnosis.joints["joint2"].verdict == "undecided"
    assert "cannot check a model" in str(diagnosis.joints["joint2"])
