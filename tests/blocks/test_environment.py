"""A modelled environment: a one-sided spring and damper that the slave runs into."""

import json

import numpy as np
import pytest
from measurement.rod_example import COUNT, rows
from shared_data import shared_folder

from teleopdesign import ExperimentError, Model, ModelError, load_experiment
from teleopdesign.blocks import CONTACT
from teleopdesign.blocks.body_equation import contact_force
from teleopdesign.diagnose.candidates import candidates
from teleopdesign.diagnose.fit import estimate
from teleopdesign.effects import SIGNALS
from teleopdesign.measurement.prepare import prepare

TEXT = """\
title = "Master and slave"
sample_rate = { value = 100, unit = "Hz" }

[model.master]
axis = "prismatic"
inertia = { value = 0.3, unit = "kg" }
[model.slave]
axis = "prismatic"
inertia = { value = 0.2, unit = "kg" }
[model.environment]
stiffness = { value = 0.5, unit = "N/mm" }
contact_position = { value = 3, unit = "mm" }

[channels]
"master.position" = { column = "x_m", unit = "m" }
"master.actuator_force" = { column = "u_m", unit = "N" }
"slave.position" = { column = "x_s", unit = "m" }
"slave.actuator_force" = { column = "u_s", unit = "N" }

[[records]]
file = "fit.csv"
use = "fit"
"""


@pytest.fixture
def folder(tmp_path):
    """A teleoperator whose model has an environment; one record of ramps."""
    (tmp_path / "experiment.toml").write_text(TEXT)
    columns = {name: np.arange(COUNT) for name in ("x_m", "u_m", "x_s", "u_s", "f_s")}
    (tmp_path / "fit.csv").write_text(rows(columns))
    return tmp_path


def edited(folder, old, new):
    file = folder / "experiment.toml"
    assert old in file.read_text()
    file.write_text(file.read_text().replace(old, new, 1))
    return Model.from_experiment(load_experiment(folder))


@pytest.mark.parametrize(
    ("depth", "velocity", "force"),
    [
        (-1e-3, 0.5, 0.0),
        (0.0, 0.5, 0.0),
        (2e-3, 0.5, 100 * 2e-3 + 3 * 0.5),
        (2e-3, -0.05, 100 * 2e-3 - 3 * 0.05),
        (2e-3, -0.5, 0.0),  # the damper would pull with more than the spring pushes
    ],
)
def test_it_pushes_only_beyond_the_contact_position_and_never_pulls(depth, velocity, force):
    numbers = {"stiffness": 100.0, "damping": 3.0, "contact_position": 0.01}
    symbols = CONTACT.symbols()
    here = {SIGNALS["position"]: 0.01 + depth, SIGNALS["velocity"]: velocity}
    law = contact_force([CONTACT]).subs(here | {symbols[n]: v for n, v in numbers.items()})
    assert float(law) == pytest.approx(force, abs=1e-12)


def test_a_measured_force_takes_its_place(folder):
    measured = '"slave.interaction_force" = { column = "f_s", unit = "N" }\n"slave.position"'
    assert not edited(folder, '"slave.position"', measured).body("slave").has("environment")


def test_an_environment_without_stiffness_is_named(folder):
    with pytest.raises(ExperimentError, match=r"model\.environment: no stiffness given"):
        edited(folder, 'stiffness = { value = 0.5, unit = "N/mm" }\n', "")


def test_effects_of_an_environment_stand_in_its_table_and_at_its_place(folder):
    more = """[model.environment.effects]
contact_damping = { damping = { value = 2, unit = "N*s/m" } }

[channels]"""
    model = edited(folder, "[channels]", more)
    assert model.parameters["environment.contact_damping.damping"].value == 2.0
    assert model.locate("environment.contact_damping.damping") == (
        "slave",
        "contact_damping.damping",
    )
    assert ("contact_damping", "environment") in model.effects
    assert model.places == ("master", "slave", "environment")
    bare = model.without_effect("contact_damping")
    again = bare.with_effect("contact_damping", values={"damping": 2.0})
    assert again.parameters == model.parameters


@pytest.mark.parametrize(
    ("effect", "table", "message"),
    [
        ("viscous", "environment", "acts at a body, not at an environment"),
        ("contact_damping", "slave", r"see \[model\.environment\.effects\]"),
        ("contact_dumping", "environment", 'did you mean "contact_damping"'),
    ],
)
def test_an_effect_in_the_wrong_table_is_named(folder, effect, table, message):
    more = f"[model.{table}.effects]\n{effect} = {{}}\n\n[channels]"
    with pytest.raises(ExperimentError, match=message):
        edited(folder, "[channels]", more)


def test_effects_of_a_contact_are_candidates_where_one_is_modelled_only(folder):
    model = Model.from_experiment(load_experiment(folder))
    keys = {c.key for c in candidates(model)}
    assert {("contact_damping", "environment"), ("contact_hardening", "environment")} <= keys
    assert not {("viscous", "environment"), ("contact_damping", "slave")} & keys
    with pytest.raises(ModelError, match="acts at the environment"):
        model.with_effect("contact_damping", at="slave")
    with pytest.raises(ModelError, match="acts at a body"):
        model.with_effect("viscous", at="environment")


@pytest.mark.parametrize("case", ["018", pytest.param("025", marks=pytest.mark.slow)])
def test_a_right_model_in_contact_leaves_what_the_reference_leaves(case):
    """Two teleoperators in soft contact with nothing missing; figures of the cases' own truth."""
    hidden = shared_folder("hidden")
    truth = json.loads((hidden / "truth" / f"{case}.json").read_text())
    experiment = load_experiment(hidden / "cases" / case)
    fit = estimate(Model.from_experiment(experiment), prepare(experiment))
    # the reference knows the true motion; along an encoder's, friction takes up some of the noise
    # wherever no direction is told
    assert 0.8 < fit.check_error / truth["check_error_base"] < 1.1
    true = truth["model_parameters"]["environment.stiffness"]
    assert fit.model.parameters["environment.stiffness"].value == pytest.approx(true, rel=0.1)
