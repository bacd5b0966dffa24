"""The forms of a block agree: linear form, python-control system, kernel; for every effect."""

import control
import numpy as np
import pytest
from clock import in_time
from devices import body
from effects.along import KNOWN, axis_of

from teleopdesign.base.errors import ModelError
from teleopdesign.blocks import Body, Value
from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import CONTACT_ROLES, EFFECTS
from teleopdesign.frequency import transfer_function
from teleopdesign.realise.iosystem import to_iosystem
from teleopdesign.realise.simulated import without_absent
from teleopdesign.simulate import simulate

#: a value of the right order for each quantity; a device of 0.15 kg moved by some newtons
TYPICAL = {
    "force": 0.3,
    "inertia": 0.1,
    "damping": 2.0,
    "stiffness": 2e3,
    "velocity": 0.05,
    "time": 2e-3,
    "dimensionless": 0.2,
    "position": 0.01,
    "drag": 1.0,
    "cubic_stiffness": 1e5,
    "per_square_of_position": 500.0,
    "angle": 0.3,
    "frequency": 10.0,
}
LEVEL = 0.5  # N; above every effect that lowers it
#: those of one body: of two, `test_tips`
NAMES = sorted(
    n
    for n, e in EFFECTS.items()
    if e.role not in ("structure", "tip_level") and not e.channels()  # only records have those
)
LINEAR = [n for n in NAMES if EFFECTS[n].linear]


def device(*names, absent=False):
    """A body with these effects and what they need, at typical values or absent."""
    wanted = dict.fromkeys(names)
    while missing := {n for w in wanted for n in KNOWN[w].needs} - set(wanted):
        wanted |= dict.fromkeys(sorted(missing))
    values = {"inertia": Value(0.15)}
    for name in wanted:
        effect = KNOWN[name]
        for parameter, declared in effect.parameters.items():
            value = LEVEL if name == "coulomb" else TYPICAL[declared.quantity]
            if name == "maxwell_slip" and declared.quantity == "force":
                value = 0.2 * LEVEL  # four elements together
            value = max(value, declared.lower)
            if absent and name in names:
                value = effect.absent.get(parameter, value)
            values[f"{name}.{parameter}"] = Value(value)
    return Body(axis_of(*wanted), values, tuple(KNOWN[n] for n in wanted))


def push(t):
    return 2.0 * np.sin(2 * np.pi * 4 * t)


def simulated(made, **arguments):
    arguments = {"duration": 0.1, "inputs": {"R_V": push}, "jit": False} | arguments
    return simulate(haptic_interface(made), **arguments)


@pytest.mark.slow
@pytest.mark.parametrize(
    "names",
    # of two: elements whose slip levels follow the load, what the tip touches
    [
        *((name,) for name in NAMES),
        ("load_dependent_friction", "maxwell_slip"),
        ("contact_damping", "transmission_compliance"),
        ("coulomb_asymmetry", "spring"),  # held at rest, between the levels of both directions
    ],
    ids="-".join,
)
def test_kernel_and_python_control_move_alike(names):
    """A hand pushes with 2 N at 4 Hz: two codes, one law."""
    diagram = haptic_interface(device(*names))
    if "actuation_delay" in names:  # python-control holds no dead time
        with pytest.raises(ModelError, match="no python-control form"):
            to_iosystem(diagram)
        return
    kernel = simulate(
        diagram, duration=0.1, inputs={"R_V": push}, computer="continuous", jit=False, step=1e-4
    )
    system = to_iosystem(diagram)
    time = kernel["L"]["time"].values
    fine = np.linspace(0, time[-1], 4001)  # it takes inputs as linear between these
    inputs = np.zeros((len(system.input_labels), len(fine)))
    inputs[system.input_labels.index("R_V")] = push(fine)
    options = {"rtol": 1e-9, "atol": 1e-12, "max_step": 1e-3}
    with in_time(60):  # one second, where its rates are smooth enough
        response = control.input_output_response(
            system, fine, inputs, t_eval=time, solve_ivp_method="LSODA", solve_ivp_kwargs=options
        )
    x = response.outputs[system.output_labels.index("L")]
    # 1e-5: inputs linear over 25 us leave 5e-8, LSODA at kinks of abs(v) some 1e-6. A touch falls
    # within a step of the kernel, 1e-4 s: half a step of the damper's first force, 2 N s/m at
    # 0.3 m/s on 0.15 kg, moves 1e-5 m of 0.015 m in the time left
    most = 5e-4 if any(EFFECTS[n].role in CONTACT_ROLES for n in names) else 1e-5
    if names[1:] == ("spring",):  # begins to hold within a step
        most = 1e-4
    if "maxwell_slip" in names:  # an element begins to slip within a step: late by K v h = 0.06 N
        most = 2e-3
    assert np.abs(x - kernel["L"].values).max() < most * np.abs(x).max()


@pytest.mark.parametrize("name", LINEAR)
def test_kernel_steps_as_the_declared_linear_form(name):
    """Desired force of 1 N at once on a hand of spring and damper: sampled and held is exact."""
    hand = body(0.2, viscous__damping=3.0, spring__stiffness=500.0)
    diagram = haptic_interface(device(name), hand=hand)
    system, left_out = transfer_function(diagram, output="L", input="R_D", delay_order=4)
    simulation = simulate(diagram, duration=0.2, inputs={"R_D": 1.0}, jit=False, step=1e-4)
    _, expected = control.step_response(system, simulation["L"]["time"].values)
    assert left_out == ()
    # order four at 1e-4 s leaves 1e-8; a dead time as a Pade of order 4 leaves 6e-6 in position
    bound = 2e-5 if name == "actuation_delay" else 1e-7
    assert np.abs(simulation["L"].values - expected).max() < bound * np.abs(expected).max()


@pytest.mark.parametrize("name", NAMES)
def test_an_effect_at_zero_strength_changes_nothing(name):
    """At its declared absent values the effect leaves the trajectory as it was, to the last bit."""
    effect = EFFECTS[name]
    with_it, needed = device(name, absent=True), sorted(effect.needs)
    assert name not in [e.name for e in without_absent(with_it).effects]
    without = simulated(device(*needed), duration=0.02)["L"].values
    np.testing.assert_array_equal(simulated(with_it, duration=0.02)["L"].values, without)
