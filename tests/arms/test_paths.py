"""Paths of all joints that tell an arm's parameters: within limits, from rest, better than poor."""

from __future__ import annotations

import arms.arm_simulator as simulator
import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.cli import main
from teleopdesign.diagnose.answer import write_answer
from teleopdesign.diagnose.search_plan import QUICK
from teleopdesign.next_experiment import propose_paths, shown_limits


@pytest.fixture(scope="module")
def poor(tmp_path_factory):
    """An arm whose joints were moved by one slow sine each: they tell few combinations."""
    generator = np.random.default_rng(5)
    arm = simulator.random_arm(generator, 2)
    with pytest.MonkeyPatch.context() as patch:
        whole = simulator.path
        patch.setattr(simulator, "path", lambda g, k, t: whole(g, k, t, harmonics=1, base=0.2))
        folder = tmp_path_factory.mktemp("poor") / "arm"
        simulator.write_experiment(folder, arm, generator, seconds=10.0)
    diagnosis = td.find_missing(td.load_experiment(folder), plan=QUICK, among=("quadratic_drag",))
    return diagnosis, folder


@pytest.mark.slow
def test_paths_tell_more_than_one_sine_a_joint_within_its_limits(poor):
    diagnosis, _ = poor
    paths = propose_paths(diagnosis, duration=20.0)
    assert paths.is_useful and paths.gain < 0.8
    assert paths.condition < paths.recorded
    time = paths.reference.time
    for joint, position in paths.reference.position.items():
        limit = shown_limits(diagnosis.joints[joint].prepared)[joint]
        velocity = np.gradient(position, time)
        acceleration = np.gradient(velocity, time)
        assert limit.low <= position.min() and position.max() <= limit.high
        assert np.abs(velocity).max() <= limit.speed
        # differences at both ends of the record are one-sided: left out
        assert np.abs(acceleration[2:-2]).max() <= limit.acceleration
        # at rest at the beginning: half a step of jerk is what a difference sees
        assert abs(velocity[0]) < 1e-3 * limit.speed
        assert position[0] == pytest.approx(position[-1], abs=1e-9)


@pytest.mark.slow
def test_the_command_writes_a_reference_with_the_columns_of_the_records(poor, tmp_path, capsys):
    diagnosis, _ = poor
    answer, reference = tmp_path / "answer.json", tmp_path / "next.csv"
    write_answer(diagnosis, answer)
    limit = ["--limit", "joint1.speed=0.2rad/s"]
    assert main(["next", str(answer), "--output", str(reference), *limit]) == 0
    assert "paths of 2 joints" in capsys.readouterr().out.replace("\n", " ")
    rows = np.genfromtxt(reference, delimiter=",", names=True)
    assert rows.dtype.names == ("t", "q1", "q2")
    assert np.abs(np.gradient(rows["q1"], rows["t"])).max() <= 0.2
