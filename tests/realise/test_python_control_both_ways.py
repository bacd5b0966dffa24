"""The same diagram through python-control and the kernel: every kind of block that comes in.

1e-6 of the range: two integrators at tight tolerances on the same equations.
"""

from dataclasses import replace

import control
import numpy as np
import pytest
from devices import body, two_rods

from teleopdesign.controllers import CONTROLLERS, Controller, Stage, controller, from_control
from teleopdesign.derive import transfer_function
from teleopdesign.diagrams import (
    Control,
    Diagram,
    coupled_plant_parts,
    haptic_interface,
    plant_parts,
)
from teleopdesign.realise.iosystem import to_iosystem
from teleopdesign.simulate import Sampling, simulate

DURATION, STEP = 0.2, 1e-4
LEAD = control.tf([-300.0, -9000.0], [1.0, 200.0])
FOURTH = LEAD * control.tf([1.0, 20.0, 4e3], [1.0, 120.0, 4e3]) * control.tf([50.0], [1.0, 50.0])
CROSSED = control.tf(
    [[[-200.0, -4e3], [30.0]], [[25.0, 10.0], [-150.0, -3e3]]],
    [[[1.0, 90.0], [1.0, 40.0]], [[1.0, 70.0], [1.0, 110.0]]],
)
#: an observer with state feedback: one set of states for both axes
OBSERVER = control.ss(
    [[-90.0, 40.0, 0.0], [-35.0, -70.0, 5.0], [2.0, 0.0, -30.0]],
    [[1.0, 0.2], [0.1, 1.5], [0.5, 0.5]],
    [[-2e3, 300.0, 0.0], [100.0, -2.5e3, 40.0]],
    [[-20.0, 0.0], [0.0, -15.0]],
)
PLANT = control.tf([2.0, 30.0, 9e3], [0.3, 12.0, 2500.0, 3e4, 4e5])
SISO = {
    "transfer function": LEAD,
    "transfer function of fourth order": FOURTH,
    "state space": control.ss([[-120.0]], [[1.0]], [[9e3]], [[-150.0]]),
    "static gain": control.tf([-900.0], [1.0]),
}
MIMO = {"2 x 2 transfer functions": CROSSED, "2 x 2 state space": OBSERVER}


#: python-control takes inputs as straight lines between these times: so does the kernel then
GRID = np.linspace(0.0, DURATION, 401)


def push(t):
    return np.interp(t, GRID, 0.5 * np.sin(40.0 * GRID) + 0.2)


def pull(t):
    return np.interp(t, GRID, 0.3 * np.cos(25.0 * GRID))


def one_rod(system):
    device = body(0.15, viscous__damping=2.0)
    return haptic_interface(device, cancellation=from_control(system), analog=("C",))


def with_plant(plant):
    parts, sums = plant_parts(plant, name="P", motion="x", command="u", driver="f")
    law = Control("K", from_control(control.tf([-40.0, -10.0], [0.01, 1.0])), "x", "u", "x", True)
    return Diagram("plant", (*parts, law), sums, {"f": "force"}, ("x",))


def compare(diagram, inputs, motions, step=STEP):
    """Largest difference of the motions, each over its range."""
    kernel = simulate(
        diagram, duration=DURATION, inputs=inputs, computer="continuous", step=step, jit=False
    )
    time = GRID
    system = to_iosystem(diagram)
    signals = [
        np.asarray(inputs[n](time)) if n in inputs else 0 * time for n in system.input_labels
    ]
    answer = control.input_output_response(
        system, time, signals, solve_ivp_kwargs={"rtol": 1e-10, "atol": 1e-14, "max_step": 5e-4}
    )
    at = np.rint(kernel["time"].values / GRID[1]).astype(int)  # each time of it is on the grid
    worst = 0.0
    for name in motions:
        theirs = answer.outputs[system.output_labels.index(name)][at]
        worst = max(worst, float(np.abs(kernel[name].values - theirs).max() / np.ptp(theirs)))
    return worst


@pytest.mark.slow  # 3 s each: an adaptive integrator in Python
@pytest.mark.parametrize("name", SISO)
def test_a_controller_is_the_same_through_the_kernel_and_through_python_control(name):
    assert compare(one_rod(SISO[name]), {"R_V": push}, ["L"]) < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("name", MIMO)
def test_a_controller_of_several_signals_is_the_same_through_both(name):
    diagram = two_rods(MIMO[name])
    assert compare(diagram, {"f1": push, "f2": pull}, ["x1", "x2"]) < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("plant", [PLANT, control.ss(PLANT), control.tf([1.0], [0.2, 3.0, 50.0])])
def test_a_plant_is_the_same_through_both_and_its_transfer_function(plant):
    diagram = with_plant(plant)
    assert compare(diagram, {"f": push}, ["x"]) < 1e-6
    alone = diagram.without("K")
    transfer, left_out = transfer_function(alone, output="x", input="f")
    points = 1j * np.array([0.3, 20.0, 70.0, 400.0])
    np.testing.assert_allclose(transfer(points), control.tf(plant)(points), rtol=1e-6)
    assert left_out == ()


PERIOD = 1e-3


def test_transfer_functions_join_by_the_names_of_signals():
    """A loop closed by control.interconnect is the diagram's own closed transfer function."""
    diagram = one_rod(LEAD)
    rod, _ = transfer_function(diagram.open_at("C"), output="L", input="R_MBC")
    law = control.tf(LEAD, inputs=["L"], outputs=["R_MBC"])
    push_to_rod, _ = transfer_function(diagram.open_at("C"), output="L", input="R_V")
    assert (rod.input_labels, rod.output_labels) == (["R_MBC"], ["L"])
    loop = control.interconnect(
        [control.ss(rod, name="rod"), control.ss(law, name="law")],
        inplist=["rod.R_MBC"],
        inputs=["F"],
        outputs=["L"],
    )
    whole, _ = transfer_function(diagram, output="L", input="R_V")
    for point in (2j, 40j, 300j):
        direct = complex(push_to_rod(point)) / complex(rod(point))
        assert direct * complex(loop(point)) == pytest.approx(complex(whole(point)), rel=1e-6)


def probe(law):
    """The law with 2 for every parameter, or the nearest within its bounds."""
    values = {n: min(max(2.0, p.lower), p.upper) for n, p in law.parameters.items()}
    return Controller((Stage(law, values),))


BUDGET = {"budget": 1e-4, "recovery_rate": 300.0, "largest_damping": 20.0}
#: values in the place of 2, of laws that follow a bristle or count energy
VALUES = {
    "delay": {"time": 2.3e-3},
    "dahl": {"level": 0.05, "stiffness": 4e3},
    "dahl_forward_euler": {"level": 0.05, "stiffness": 4e3},
    "lugre": {"level": 0.05, "stiffness": 4e3, "bristle_damping": 2.0},
    "friction_budget": {"counted_level": 0.01, **BUDGET},
    "passivity_controller": BUDGET,
}


def law_of(name):
    """The law with values, and where the haptic interface has it."""
    law = probe(CONTROLLERS[name])
    if name in VALUES:
        known = {k: v for k, v in VALUES[name].items() if k in CONTROLLERS[name].parameters}
        law = law.with_values({f"{name}.{k}": v for k, v in known.items()})
    if name == "friction_budget":  # behind a law that helps the motion
        return controller("dahl", {"level": 0.5, "stiffness": 4e3}).then(law), "cancellation"
    if name == "passivity_controller":
        return law, "passivity"
    return law, "force_feedback" if CONTROLLERS[name].takes == "force" else "cancellation"


def with_law(name):
    """A haptic interface with that law; one that reads a force has a hand to read it from."""
    law, place = law_of(name)
    device = body(0.15, viscous__damping=9.0, spring__stiffness=900.0)
    hand = body(0.1) if place == "force_feedback" else None
    return haptic_interface(device, hand=hand, **{place: law})


IN_COMPUTER = list(CONTROLLERS)


@pytest.mark.parametrize("name", IN_COMPUTER)
def test_every_law_of_the_catalogue_is_the_same_in_a_computer_through_both(name):
    """The sampled system of python-control's stepping and the simulation's samples; 1e-9."""
    diagram = with_law(name)
    forces = {"R_V": 1.5, "R_D": 0.5}
    computer = Sampling(period=PERIOD)
    simulation = simulate(diagram, duration=0.02, inputs=forces, computer=computer, jit=False)
    time = PERIOD * np.arange(21)
    system = to_iosystem(diagram, dt=PERIOD)
    inputs = [np.full(21, forces[n]) for n in system.input_labels]
    answer = control.input_output_response(system, time, inputs)
    theirs = answer.outputs[system.output_labels.index("L")]
    assert np.abs(simulation["L"].values - theirs).max() < 1e-9 * np.ptp(theirs)


def mechanical(masses, damping, stiffness):
    """x'' = M^-1 (F - B x' - K x) in state space, forces in and positions out."""
    m, b, k = (np.array(x, dtype=float) for x in (masses, damping, stiffness))
    n, inverse = len(m), np.linalg.inv(np.array(masses, dtype=float))
    zero, same = np.zeros((n, n)), np.eye(n)
    return control.ss(
        np.block([[zero, same], [-inverse @ k, -inverse @ b]]),
        np.vstack([zero, inverse]),
        np.hstack([same, zero]),
        zero,
    )


TWO_AXES = mechanical(
    [[0.3, 0.05], [0.05, 0.2]], [[4.0, -1.0], [-1.0, 3.0]], [[900, -200], [-200, 700]]
)
COUPLED = {
    "masses": TWO_AXES,
    "free masses": mechanical([[0.3, 0.05], [0.05, 0.2]], [[4, -1], [-1, 3]], np.zeros((2, 2))),
    "more states than two an axis": control.tf(
        [[[1.0, 60.0], [2.0]], [[1.0], [1.0]]],
        [
            [[0.2, 15.0, 420.0, 9e3], [0.02, 2.3, 60.0, 900.0]],
            [[0.05, 4.0, 90.0, 1500.0], [0.25, 4.0, 500.0]],
        ],
    ),
}  # fmt: skip


def with_axes(plant, name="P"):
    numbers = range(1, plant.ninputs + 1)
    named = {key: [f"{letter}{i}" for i in numbers] for key, letter in
             (("motions", "x"), ("commands", "u"), ("drivers", "f"))}  # fmt: skip
    parts, sums = coupled_plant_parts(plant, name=name, **named)
    law = from_control(control.tf([-40.0, -10.0], [0.01, 1.0]))
    laws = [Control(f"K{i}", law, f"x{i}", f"u{i}", f"x{i}", True) for i in numbers]
    outside = {f"f{i}": "force" for i in numbers}
    return Diagram("plant", (*parts, *laws), sums, outside, tuple(named["motions"]))


def opened(diagram):
    """The plant alone: what its controllers make is zero."""
    silent = from_control(control.tf([0.0], [1.0]))
    for part in diagram.controls:
        if part.name.startswith("K"):
            diagram = replace(
                diagram,
                blocks=tuple(replace(b, controller=silent) if b.name == part.name else b
                             for b in diagram.blocks),
            )  # fmt: skip
    return diagram


@pytest.mark.parametrize(
    "name",
    ["masses", "free masses", pytest.param("more states than two an axis", marks=pytest.mark.slow)],
)
def test_a_plant_of_several_axes_has_its_transfer_functions(name):
    """Matrices in, transfer functions out: 1e-6 of each entry, over four decades."""
    alone = opened(with_axes(COUPLED[name]))
    points = 1j * np.array([0.3, 20.0, 70.0, 400.0])
    for i in range(COUPLED[name].noutputs):
        for j in range(COUPLED[name].ninputs):
            transfer, left_out = transfer_function(alone, output=f"x{i + 1}", input=f"f{j + 1}")
            expected = np.array([COUPLED[name](p)[i, j] for p in points])
            np.testing.assert_allclose(transfer(points), expected, rtol=1e-6)
            assert left_out == ()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["masses", "more states than two an axis"])
def test_a_plant_of_several_axes_is_the_same_through_both(name):
    diagram = with_axes(COUPLED[name])
    motions = [f"x{i + 1}" for i in range(COUPLED[name].noutputs)]
    assert compare(diagram, {"f1": push, "f2": pull}, motions) < 1e-6


def test_a_plant_of_several_axes_in_discrete_time_is_the_one_before_its_hold():
    """Held forces: each sample of the diagram is that of the discrete plant; 1e-6 of the range."""
    sampled = control.sample_system(TWO_AXES, PERIOD, method="zoh")
    diagram = opened(with_axes(sampled))
    forces = {"f1": 1.5, "f2": -0.7}
    computer = Sampling(period=PERIOD)
    simulation = simulate(
        diagram, duration=0.1, inputs=forces, computer=computer, step=1e-4, jit=False
    )
    time = PERIOD * np.arange(101)
    held = np.tile([[1.5], [-0.7]], (1, 101))
    answer = control.forced_response(sampled, time, held).outputs
    at = np.searchsorted(simulation["time"].values, time - PERIOD / 1e3)
    for k, motion in enumerate(("x1", "x2")):
        assert np.abs(simulation[motion].values[at] - answer[k]).max() < 1e-6 * np.ptp(answer[k])
