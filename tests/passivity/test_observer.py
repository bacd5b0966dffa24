"""The passivity observer on motions that refute, on proved cases, and on a recording."""

import numpy as np
import pytest
from devices import body
from hypothesis import given, settings
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.passivity import (
    Strokes,
    confirmed_motion,
    observe,
    observe_record,
    observe_simulation,
)
from teleopdesign.simulate import simulate, sine

STROKES = Strokes((2e-3, -2e-3), speed=0.3, rounds=12)


def joint(level, stiffness):
    body = td.Body("prismatic", {"inertia": td.Value(1e-3)})
    body = body.with_effect(td.EFFECTS["coulomb"], {"level": 0.5})
    presliding = td.EFFECTS["presliding"].without("bristle_damping")
    body = body.with_effect(presliding, {"stiffness": 2e4})
    law = controller("dahl", {"level": level, "stiffness": stiffness})
    return haptic_interface(body, cancellation=law)


def moved(diagram, strokes=STROKES):
    """The diagram along the strokes, with a row at every step."""
    return simulate(
        diagram,
        duration=np.ceil(strokes.duration / 1e-3) * 1e-3,
        motion={"L": strokes.motion()},
        computer="continuous",
        step=5e-5,
        every_step=True,
    )


@pytest.mark.parametrize(("level", "stiffness", "size"), [(0.6, 1.5e4, 2e-3), (0.2, 1.5e4, 1e-5)])
def test_energy_comes_out_along_a_motion_that_refutes(level, stiffness, size):
    diagram = joint(level, stiffness)
    motion = confirmed_motion(diagram, Strokes((size, -size), speed=150 * size))
    assert motion is not None
    simulation = observe_simulation(moved(diagram, motion.strokes))
    assert simulation.certain
    # trapezoids of steps of another length than those of the search
    assert float(simulation.data["energy"][-1]) == pytest.approx(-motion.energy, rel=0.05)
    assert simulation.given_out()


def test_a_held_force_is_counted_exactly():
    """Two samples of 3 N along 0.1 m and back with -1 N: 0.3 + 0.1 J, whatever lies between."""
    t, x, f = np.arange(3.0), np.array([0.0, 0.1, 0.0]), np.array([3.0, -1.0, 9.0])
    energy = observe(t, x, f, held=True)
    assert energy.data["energy"].values == pytest.approx([0.0, 0.3, 0.4])


def test_energy_into_a_recorded_device_covers_its_friction_and_is_certain():
    """The hand works on the rod; its motor's work is observed as well, held between samples."""
    experiment = td.load_experiment(td.example("rod"))
    record = experiment.fit_records[0]
    hand = observe_record(experiment, record)
    motor = observe_record(experiment, record, force="actuator_force")
    total = float(hand.data["energy"][-1] + motor.data["energy"][-1])
    travelled = float(np.abs(np.diff(record.signals["device.position"])).sum())
    # all that both put in is lost: at 0.55 N of Coulomb friction and more at speed
    assert total > 0.5 * travelled
    assert 0 < float(hand.data["stderr"][-1]) < 0.05 * total
    with pytest.raises(ExperimentError, match="has no device.torque"):
        observe_record(experiment, record, force="torque")


@settings(max_examples=20)
@given(seed=st.integers(0, 999), n=st.integers(3, 9), held=st.booleans())
def test_the_error_of_the_energy_is_what_noise_of_each_sample_makes_of_it(seed, n, held):
    """The energy is linear in each reading: one more unit of one says by how much it errs."""
    random = np.random.default_rng(seed)
    position, force, time = random.normal(size=n), random.normal(size=n), 0.1 * np.arange(n)

    def energy(position, force):
        return observe(time, position, force, held=held).data["energy"].values

    now, variance = energy(position, force), np.zeros(n)
    for k in range(n):
        more = np.eye(n)[k]
        variance += (0.3 * (energy(position + more, force) - now)) ** 2
        variance += (0.7 * (energy(position, force + more) - now)) ** 2
    observation = observe(time, position, force, held=held, position_noise=0.3, force_noise=0.7)
    assert observation.data["stderr"].values == pytest.approx(np.sqrt(variance), abs=1e-12)
    assert now[0] == 0.0 and observation.data["stderr"].values[0] == 0.0


@pytest.mark.parametrize("every_step", [True, False])
@pytest.mark.parametrize(("phase", "at_speed"), [(0.0, True), (1.2, True), (np.pi / 2, False)])
def test_energy_of_a_motion_that_begins_at_speed_is_not_called_released(
    phase, at_speed, every_step
):
    """A mass with a damper is passive: what comes out of it was in it at the start."""
    mass, damping, led = 0.2, 0.1, sine(amplitude=0.01, frequency=2.0, phase=phase)
    moved = simulate(
        haptic_interface(body(mass, viscous__damping=damping)),
        duration=1.0,
        motion={"L": led},
        every_step=every_step,
        jit=False,
    )
    energy = observe_simulation(moved)
    kinetic = mass / 2 * float(led.velocity(np.zeros(1))[0]) ** 2
    assert energy.lowest >= -1.001 * kinetic - 1e-12
    assert energy.certain == energy.moves_at_start == at_speed
    assert repr(energy).endswith("did not begin at rest") == at_speed
