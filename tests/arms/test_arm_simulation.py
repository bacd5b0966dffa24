"""An arm driven by its recorded commands: against an independent simulator, and one body alone."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from arms.arm_simulator import forces, random_arm, urdf, write_experiment

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.diagnose import RecordedLoop
from teleopdesign.diagnose.by_simulation import compare_by_simulation, simulation_data
from teleopdesign.diagnose.parts import PreparedParts, links_of

SECONDS = 6.0
LOOP = RecordedLoop(200.0, 20.0)


def known(folder, arm, seed=3, hidden=None):
    """An experiment on an arm whose links are known, and its true model."""
    generator = np.random.default_rng(seed)
    write_experiment(folder, arm, generator, hidden, seconds=SECONDS)
    (folder / "arm.urdf").write_text(urdf(arm, inertial=True))
    text = (folder / "experiment.toml").read_text()
    (folder / "experiment.toml").write_text(text.replace('"base parameters"', '"as given"'))
    experiment = td.load_experiment(folder)
    values = {}
    for i in range(arm.count):
        values[f"joint{i + 1}.coulomb.level"] = arm.coulomb[i]
        values[f"joint{i + 1}.viscous.damping"] = arm.viscous[i]
    return experiment, td.Model.from_experiment(experiment).with_values(values)


@pytest.fixture(scope="module")
def two(tmp_path_factory):
    arm = random_arm(np.random.default_rng(2), 2)
    return arm, *known(tmp_path_factory.mktemp("two") / "arm", arm)


def test_the_links_need_what_an_independent_simulator_says(two):
    arm, experiment, _ = two
    generator = np.random.default_rng(0)
    q, v, a = generator.normal(size=(3, 2, 5))
    bodies = np.diag([0.3, 0.1])
    links = replace(links_of(experiment, ()), carried=bodies)
    inertia, force = links.needed(q, v)
    assert np.allclose(inertia, np.swapaxes(inertia, 1, 2))
    needed = np.einsum("nij,jn->in", inertia + bodies, a) + force
    assert np.allclose(needed, forces(arm, q, v, a), rtol=1e-9)


def test_a_loop_of_a_joint_that_is_not_there_is_one_line(two):
    _, experiment, model = two
    with pytest.raises(ModelError, match=r'no joint "joint3".*joint1, joint2.*did you mean'):
        td.compare(model, experiment, by="simulation", loop={"joint3": LOOP})


@pytest.mark.slow
def test_the_true_arm_moves_as_the_recorded_one_and_another_does_not(two):
    _, experiment, model = two
    held = td.compare(model, experiment, by="simulation", loop=LOOP)
    free = td.compare(model, experiment, by="simulation")
    assert held.check_error < 0.008
    for joint in model.bodies:
        # commands are held, so a reversal lies anywhere in a row: 10 ms of friction
        assert held.error(np.inf, at=joint).of_travel < 1e-3
        assert held.error(np.inf, at=joint).of_speed < 0.01
        assert free.error(0.1, at=joint).of_travel < 1e-3
        errors = [e.position for e in free.errors if (e.use, e.at) == ("check", joint)]
        assert errors == sorted(errors)
    stiffer = model.with_values(
        {"joint2.coulomb.level": 1.3 * model.parameters["joint2.coulomb.level"].value}
    )
    wrong = td.compare(stiffer, experiment, by="simulation", loop={j: LOOP for j in model.bodies})
    before, after = (c.error(np.inf, at="joint2").position for c in (held, wrong))
    assert after > 5.0 * before
    data = json.loads(json.dumps(simulation_data(wrong), allow_nan=False))
    assert data["loop"] == {j: {"stiffness": 200.0, "damping": 20.0} for j in model.bodies}


@pytest.mark.slow
def test_an_arm_of_one_joint_about_the_vertical_is_one_body(tmp_path):
    arm = random_arm(np.random.default_rng(4), 1)
    arm = replace(arm, axes=[np.array([0.0, 0.0, 1.0])], angles=[np.zeros(3)])
    experiment, model = known(tmp_path / "arm", arm)
    alone = compare_by_simulation(model, experiment, loop=LOOP)
    # about the vertical no gravity acts and the inertia is the same at every pose
    rest = np.zeros((1, 1))
    links = links_of(experiment, ())
    inertia, force = links.needed(rest, rest)
    assert force == pytest.approx(0.0, abs=1e-12)
    records = alone.prepared.parts["joint1"]
    bare = [replace(s, motion=replace(s.motion, links=None)) for s in records.stretches]
    one = td.Model({"joint1": model.bodies["joint1"]}).with_values(
        {"joint1.inertia": float(inertia[0, 0, 0])}
    )
    records = replace(records, stretches=tuple(bare))
    body = compare_by_simulation(
        one, PreparedParts(records.experiment, records.bandwidth, None, {"": records})
    )
    free = compare_by_simulation(model, experiment)
    for horizon in (0.3, 3.0, np.inf):
        for quantity in ("position", "velocity"):
            of_arm, of_body = (
                getattr(c.error(horizon, use="check"), quantity) for c in (free, body)
            )
            # rows are divided into other steps, each of which the scheme resolves: 0.1 % apart here
            assert of_arm == pytest.approx(of_body, rel=5e-3)
