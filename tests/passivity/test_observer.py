"""The passivity observer on motions that refute, on proved cases, and on a recording."""

import numpy as np
import pytest
import xarray
from devices import body
from hypothesis import given, settings
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError, ModelError
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.passivity import (
    Strokes,
    confirmed_motion,
    observe,
    observe_record,
    observe_simulation,
    passivity_controlled,
)
from teleopdesign.passivity.observer import PortEnergy
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


@pytest.mark.parametrize(("level", "stiffness"), [(0.4, 1.5e4), (0.5, 1.9e4), (0.3, 1e4)])
def test_no_energy_comes_out_where_the_claim_is_proved(level, stiffness):
    simulation = observe_simulation(moved(joint(level, stiffness)))
    # the inertia's energy is held in between; rounding of the steps is a part in 1e6 of it
    assert simulation.lowest >= -1e-6 * float(simulation.data["energy"].max())


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


@pytest.mark.parametrize("held", [True, False])
def test_the_error_of_the_energy_is_that_of_noisy_sensors(held):
    rng = np.random.default_rng(3)
    t = np.linspace(0, 1, 301)
    x, f = 0.01 * np.sin(9 * t), 2 * np.cos(9 * t + 0.3)

    def energy(a, b):
        return observe(t, x + a, f + b, held=held).data["energy"].values[-1]

    drawn = [energy(rng.normal(0, 1e-5, 301), rng.normal(0, 0.02, 301)) for _ in range(600)]
    with_noise = observe(t, x, f, held=held, position_noise=1e-5, force_noise=0.02)
    # 600 draws know a standard deviation to 3 %: three of those
    assert float(with_noise.data["stderr"][-1]) == pytest.approx(np.std(drawn), rel=0.09)


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


def test_the_passivity_controller_adds_damping_only_where_energy_would_come_out():
    simulation = moved(joint(0.6, 1.5e4))
    period = float(np.diff(simulation.data["time"].values[:2])[0])
    velocity = np.diff(simulation["L"].values) / period
    force = simulation["R_V"].values[:-1]
    assert np.cumsum(period * force * velocity)[-1] < 0
    controlled = passivity_controlled(velocity, force, period=period)
    assert controlled.energy.min() >= -1e-12
    assert (controlled.damping > 0).any()
    assert np.sum(period * controlled.force * velocity) == pytest.approx(controlled.energy[-1])
    quiet = passivity_controlled(velocity, np.abs(force) * np.sign(velocity), period=period)
    assert not quiet.damping.any()


def test_what_cannot_be_observed_is_refused():
    with pytest.raises(ModelError, match="three samples or more"):
        observe(np.arange(2.0), np.arange(2.0), np.arange(2.0))
    with pytest.raises(ModelError, match="a period > 0"):
        passivity_controlled(np.ones(2), np.ones(2), period=0.0)


@pytest.mark.parametrize(
    ("stderr", "falls"),
    [(0.0, [(1.0, 2.5, 3.0), (3.0, 3.5, 1.0)]), (0.6, [(1.0, 2.5, 3.0)]), (1.6, [])],
)
def test_each_time_in_which_energy_came_out_is_reported_with_how_much_beyond_doubt(stderr, falls):
    """From 5 J to 2 J in three steps, from 4 J to 3 J in one; 1.96 errors are in doubt."""
    time = 0.5 * np.arange(9)
    energy = np.array([0.0, 3.0, 5.0, 4.5, 4.0, 2.0, 4.0, 3.0, 3.0])
    data = {"energy": ("time", energy), "stderr": ("time", np.linspace(0.0, stderr, 9))}
    energies = PortEnergy(xarray.Dataset(data, coords={"time": time}))
    assert energies.given_out() == falls
    assert (energies.lowest, energies.when, energies.certain) == (0.0, 0.0, False)


@pytest.mark.parametrize(("lowest", "is_certain"), [(-1.95, False), (-1.97, True), (0.5, False)])
def test_energy_is_surely_below_zero_from_196_errors_of_it(lowest, is_certain):
    energy, stderr = np.array([2.0, 1.0, lowest, 1.5]), np.array([0.0, 0.5, 1.0, 9.0])
    data = {"energy": ("time", energy), "stderr": ("time", stderr)}
    energies = PortEnergy(xarray.Dataset(data, coords={"time": 0.1 * np.arange(4)}))
    assert energies.certain == is_certain
    assert (energies.lowest, energies.when) == (lowest, pytest.approx(0.2))


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


@pytest.mark.parametrize("pushed", [-2.0, 2.0])
@pytest.mark.parametrize("noise", [0.0, 10.0])
def test_what_an_observer_states_is_the_energy_its_error_and_whether_it_is_certain(pushed, noise):
    """A force of 2 N along a metre, or against it, and back over half of that."""
    time = np.linspace(0.0, 3.0, 301)
    position = np.interp(time, [0.0, 2.0, 3.0], [0.0, 1.0, 0.5])
    made = observe(time, position, np.full(301, pushed), force_noise=noise)
    text = repr(made)
    least = min(0.0, pushed)
    assert f"least {least:.4g} J at {2.0 if pushed < 0 else 0.0:.4g} s" in text
    assert text.startswith(f"Energy into the port: {'1' if pushed > 0 else '-1'}")
    assert made.certain == (pushed < 0)  # the error of 301 forces averages out
    word = "energy was released" if made.certain else "no energy was certainly released"
    assert f": {word}" in text
    wide = observe(time, position, np.full(301, pushed), force_noise=20.0 * noise)
    assert wide.certain == (pushed < 0 and noise == 0.0)


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


def test_rounding_of_a_simulation_is_no_released_energy():
    time = np.linspace(0.0, 1.0, 101)
    position = 1 - np.cos(2 * np.pi * time)
    spring = observe(time, position, 100.0 * position - 1e-9 * np.sin(40 * time))
    assert not spring.certain


def test_encoder_steps_at_rest_are_no_motion():
    time = np.linspace(0.0, 1.0, 1001)
    step = 1e-5
    reading = step * np.round(0.01 * (1 - np.cos(2 * np.pi * time)) / step + (np.arange(1001) % 2))
    assert not observe(time, reading, np.zeros(1001)).moves_at_start
