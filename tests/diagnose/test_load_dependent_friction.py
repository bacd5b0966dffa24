"""A gear that rubs with what it carries: whether it drives or is driven back."""

import numpy as np
import pytest
from diagnose.made_records import write_made

import teleopdesign as td
from teleopdesign import Model, load_experiment
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.plausibility import implausible_effects, record_facts
from teleopdesign.effects import EFFECTS
from teleopdesign.measurement.prepare import prepare

EFFECT = EFFECTS["load_dependent_friction"]
INERTIA, GRAVITY, LEVEL, DAMPING = 0.05, 2.0, 0.2, 0.05
MU, DRIVING = 0.15, 0.6
USER = """coulomb = { level = { value = 0.3, unit = "N*m" } }
viscous = { damping = { value = 0.1, unit = "N*m*s/rad" } }
gravity = { amplitude = { value = 1.8, unit = "N*m" }, phase = { value = 0.0, unit = "rad" } }
load_dependent_friction = { coefficient = { value = 0.1 }, driving_difference = { value = 0.2 } }
"""


def needed(t, x, v):
    """Force beside the inertia of a link on a gear: u = load + sgn v (F_C + mu |u| (1 + d w))."""
    inertial = INERTIA * np.gradient(v, t)
    way = np.sign(v)
    load = inertial + GRAVITY * np.sin(x) + DAMPING * v + way * LEVEL
    # with the sign of u given the law is linear in u: the sign that the solution has itself
    u = np.zeros_like(load)
    for sign in (1.0, -1.0):
        here = load / (1.0 - way * sign * MU * (1.0 + DRIVING * sign * way))
        u = np.where(np.sign(here) == sign, here, u)
    return u - inertial


def swing(*parts):
    return lambda t: sum(a * np.sin(2 * np.pi * f * t + p) for a, f, p in parts)


@pytest.fixture(scope="module")
def geared(tmp_path_factory):
    records = {
        "fit": [(20.0, swing((1.4, 0.23, 0.3), (0.5, 0.61, 1.0), (0.2, 1.3, 2.0)))],
        "check": [(15.0, swing((1.2, 0.31, 1.3), (0.6, 0.47, 0.2), (0.15, 1.7, 0.0)))],
    }
    folder = tmp_path_factory.mktemp("made") / "geared"
    write_made(
        folder, records, needed, effects=USER, step=1e-5, noise=0.005, inertia=INERTIA, rate=200
    )
    return load_experiment(folder)


def test_its_direction_is_estimated_where_the_model_states_it(geared):
    """Started at a third of the truth; at the turns friction is not told, which costs percents."""
    prepared = prepare(geared)
    p = estimate(Model.from_experiment(geared), prepared).model.parameters
    ours = {
        n: p[f"device.load_dependent_friction.{n}"] for n in ("coefficient", "driving_difference")
    }
    assert ours["coefficient"].value == pytest.approx(MU, rel=0.1)
    assert ours["driving_difference"].value == pytest.approx(DRIVING, rel=0.25)


def test_a_search_leaves_its_direction_to_the_actuators_gain():
    """mu d takes the command as a gain does: a candidate has the coefficient alone."""
    body = td.Body("revolute", {"inertia": INERTIA}).with_effect(EFFECTS["coulomb"])
    parameters = body.with_effect(EFFECT).parameters
    held = {n for n in EFFECT.parameters if parameters[f"{EFFECT.name}.{n}"].fixed}
    assert held == set(EFFECT.parameters) - {"coefficient"}


#: friction that grows with something, and a command that does not arrive whole
ALIKE = (
    "load_dependent_friction", "actuator_gain", "position_dependent_friction", "stribeck",
    "coulomb_asymmetry", "quadratic_drag", "spring", "bias",
)  # fmt: skip
#: N m s/rad; back-EMF of a motor that is driven by a voltage
BACK_EMF = 1.2


def needed_by_voltage(t, x, v):
    """Force beside the inertia, where the gear rubs with what its output carries."""
    load = INERTIA * np.gradient(v, t) + GRAVITY * np.sin(x)
    return GRAVITY * np.sin(x) + BACK_EMF * v + np.sign(v) * (LEVEL + MU * np.abs(load))


@pytest.mark.slow
def test_a_motor_driven_by_a_voltage_has_load_dependent_friction_at_its_output(tmp_path):
    """The acting force contains the back-EMF there, and is the wrong load."""
    user = "".join(line + "\n" for line in USER.splitlines() if not line.startswith("load"))
    records = {
        "fit": [(20.0, swing((1.4, 0.23, 0.3), (0.5, 0.61, 1.0), (0.2, 1.3, 2.0)))],
        "check": [(15.0, swing((1.2, 0.31, 1.3), (0.6, 0.47, 0.2), (0.15, 1.7, 0.0)))],
    }
    write_made(
        tmp_path / "servo", records, needed_by_voltage, effects=user, step=1e-5, noise=0.005,
        inertia=INERTIA, rate=200,
    )  # fmt: skip
    answer = td.diagnose(load_experiment(tmp_path / "servo"), among=ALIKE)
    assert [(c.effect.name, c.at) for c in answer.named] == [(EFFECT.name, "device")]
    p = answer.model.parameters
    assert p[f"device.{EFFECT.name}.output_share"].value == 1.0
    mu = p[f"device.{EFFECT.name}.coefficient"]
    assert mu.value == pytest.approx(MU, abs=max(4 * mu.stderr, 0.02))


def test_a_bristle_is_judged_by_the_friction_that_acts_whatever_effects_make_it(geared):
    """At a Coulomb level of nothing, friction of the load bends the bristle by many steps."""
    prepared = prepare(geared)
    alone = {"device.coulomb.level": 1e-7, "device.load_dependent_friction.coefficient": 0.25}
    loaded = Model.from_experiment(geared).with_values(alone)
    facts = record_facts(loaded, "device", prepared)
    usual = 0.25 * np.median(
        np.abs(np.concatenate([r.signals["device.actuator_force"] for r in geared.records]))
    )
    assert facts.friction == pytest.approx(usual, rel=0.3)
    bristle = loaded.with_effect(
        EFFECTS["presliding"], values={"stiffness": 100.0 * facts.friction}
    )
    assert implausible_effects(bristle, prepared) == {}
    stiff = bristle.with_values({"device.presliding.stiffness": 1e6 * facts.friction})
    assert "sgn friction" in implausible_effects(stiff, prepared)["presliding", "device"]
    without = bristle.with_values({"device.load_dependent_friction.coefficient": 0.0})
    assert "sgn friction" in implausible_effects(without, prepared)["presliding", "device"]
