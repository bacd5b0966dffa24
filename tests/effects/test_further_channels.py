"""Laws on channels of a record besides a body's own motion: a temperature, another motion."""

import numpy as np
import pytest
from effects.along import body_of, encoded, motion_along, signals
from effects.recorded import write_recorded

from teleopdesign import Body, Model, ModelError, find_missing, fit, load_effect, load_experiment
from teleopdesign.base.errors import ExperimentError
from teleopdesign.diagnose.candidates import candidates
from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import EFFECTS, SIGNALS
from teleopdesign.effects.viscous_temperature import REFERENCE
from teleopdesign.measurement.prepare import prepare
from teleopdesign.realise.along_motion import residual_along
from teleopdesign.simulate import simulate

BELIEVED = "coulomb = { level = 0.3 }\nviscous = { damping = 0.5 }"
OTHER = 'other_position = { column = "y", unit = "m" }'
SHARED = 0.05  # kg, inertia coupled to the other motion


def other_motion(time, drive):
    """Column of another motion, whose acceleration pulls at the device."""
    y, a = np.zeros_like(time), np.zeros_like(time)
    for f, phase in ((1.3, 0.4), (3.7, 1.9), (6.1, 0.8)):
        w = 2 * np.pi * f
        y += 0.03 / f * np.sin(w * time + phase)
        a -= 0.03 / f * w**2 * np.sin(w * time + phase)
    drive.direct[:, 0] -= SHARED * a
    return {"y": y}


@pytest.fixture
def coupled(tmp_path):
    """A device that another motion pulls at, which its user's model knows nothing of."""
    return write_recorded(
        tmp_path / "coupled", BELIEVED, channels=OTHER, more=other_motion, level=0.2, damping=0.5
    )


def test_the_other_motion_is_a_channel_and_its_inertia_is_estimated(coupled):
    experiment = load_experiment(coupled)
    estimates = fit(Model.from_experiment(experiment).with_effect("coupling"), experiment)
    # the encoder of the device alone has errors: five of its standard errors are 1 %
    assert estimates.parameters["device.coupling.inertia"].value == pytest.approx(SHARED, rel=0.01)


@pytest.mark.slow
def test_a_coupling_is_named_beside_what_it_is_mistaken_for(coupled):
    names = {"coulomb", "viscous", "coupling", "spring", "added_inertia", "bias", "cogging"}
    experiment = load_experiment(coupled)
    known = {n: e for n, e in EFFECTS.items() if n in names}
    diagnosis = find_missing(experiment, Model.from_experiment(experiment, known))
    assert [c.effect.name for c in diagnosis.missing] == ["coupling"]


@pytest.mark.slow
def test_a_law_on_a_channel_that_a_record_has_not_is_no_candidate(tmp_path):
    folder = write_recorded(tmp_path / "bare", BELIEVED, level=0.2, damping=0.5)
    experiment = load_experiment(folder)
    model = Model.from_experiment(experiment)
    motions = [s.motion for s in prepare(experiment, bandwidth=60.0).of("fit")]
    names = {c.effect.name for c in candidates(model, motions)}
    assert "stribeck" in names and names.isdisjoint({"coupling", "viscous_temperature"})
    with pytest.raises(ModelError, match='coupling: needs the channel "other_position", which fit'):
        fit(model.with_effect("coupling", values={"inertia": 0.1}), experiment)
    toml = folder / "experiment.toml"
    toml.write_text(toml.read_text().replace("coulomb =", "coupling = {}\ncoulomb ="))
    with pytest.raises(ExperimentError, match=r'effects.coupling: needs the channel "other_pos'):
        Model.from_experiment(load_experiment(folder))


def test_damping_falls_with_the_measured_temperature():
    x, u, f = signals()
    motion = motion_along(encoded(x), u, f, resolution=1e-6)  # at 300 K
    warm = body_of("viscous", "viscous_temperature")
    damping = warm.parameters["viscous.damping"].value
    less = damping * np.exp(-warm.parameters["viscous_temperature.coefficient"].value
                            * (motion.further["temperature"] - REFERENCE))  # fmt: skip
    plain = residual_along(body_of(), motion).residual.value
    force = plain - residual_along(warm, motion).residual.value
    np.testing.assert_allclose(force, less * motion.velocity, atol=1e-9 * np.abs(force).max())


@pytest.mark.parametrize("name", [n for n in EFFECTS if EFFECTS[n].channels()])
def test_a_law_on_a_channel_of_a_record_has_no_simulated_form(name):
    assert EFFECTS[name].expression().free_symbols & set(SIGNALS.values())
    needed = [*sorted(EFFECTS[name].needs), name]
    with pytest.raises(ModelError, match=f"{name} has no simulated form"):
        simulate(haptic_interface(body_of(*needed)), duration=0.01, jit=False)


def test_a_law_on_the_measured_force_of_the_hand_has_no_simulated_form(tmp_path):
    """What `describe` writes of a force that follows the hand's; it ended in a traceback."""
    file = tmp_path / "grip.py"
    file.write_text(
        '"""Grip: a share of the hand\'s force."""\n'
        "from teleopdesign import Effect, Parameter\n"
        "EFFECT = Effect(\n"
        '    role="force",\n'
        "    law=lambda now, p: p.share * now.interaction_force,\n"
        '    parameters={"share": Parameter("dimensionless", "share of the force")},\n'
        '    absent={"share": 0.0},\n'
        '    source="made for a test",\n'
        ")\n"
    )
    grip = load_effect(file)
    device = Body("prismatic", {"inertia": 0.2, "grip.share": 0.1}, (grip,))
    with pytest.raises(ModelError, match="grip has no simulated form.*interaction_force"):
        simulate(haptic_interface(device), duration=0.01, jit=False)
