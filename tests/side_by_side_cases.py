"""Diagrams, and cases of them, that run side by side and one by one."""

import numpy as np
from devices import DAHL, LINK, body

from teleopdesign.controllers import controller
from teleopdesign.diagrams import Control, Diagram, Junction, Moving, teleoperator
from teleopdesign.realise.program import CompiledLoop, module_source
from teleopdesign.simulate import Sampling, prepare

RUBBING = {"coulomb__level": 0.5, "presliding__stiffness": 2e4, "viscous__damping": 0.4}


def plain_loop(laws, lanes):
    """The loop in plain Python."""
    module = {"__name__": "plain"}
    exec(compile(module_source(laws, jit=False, lanes=lanes), "<generated>", "exec"), module)
    return CompiledLoop(lanes, module["run"], module["follow"], module["differentiate_at_rest"])


def push(t):
    return 3.0 * np.sin(300.0 * t + 0.3)


def with_a_computer(duration, **sampling):
    """Two devices with friction, actuators that are late, and a controller that delays."""
    bodies = [body(m, **RUBBING, actuation_delay__delay=2e-4) for m in (0.15, 0.2)]
    coupling = controller("delay", {"time": 2.4e-3}).then(LINK)
    diagram = teleoperator(
        *bodies, coupling=coupling, hand=body(0.1, viscous__damping=2.0), master_cancellation=DAHL
    )
    setting = Sampling(encoder_step=1e-5, delay=3e-4, **sampling)
    return prepare(diagram, duration=duration, inputs={"F_u": push}, computer=setting, jit=False)


def with_late_signals(duration, lateness):
    """Two bodies with friction on springs, each of which feels the other body late.

    lateness: s, of the first body
    """
    bodies = (
        Moving("M", body(0.1, **RUBBING), "x", "u", {"f": 1}, "f"),
        Moving("N", body(0.3, **RUBBING), "y", "w", {"g": 1}, "g"),
    )
    diagram = Diagram(
        "late",
        (
            *bodies,
            Control("T", controller("delay", {"time": lateness}), "x", "x_late", analog=True),
            Control("S", controller("delay", {"time": 0.77e-3}), "y", "y_late", analog=True),
            Control("P", LINK, "d", "u", "x", analog=True),
            Control("Q", LINK, "y_late", "v", "y", analog=True),
        ),
        (Junction("d", {"x_late": -1, "y": 1}), Junction("w", {"u": -1, "v": -1})),
        {"f": "force", "g": "force"},
        measured=("x", "y"),
    )
    inputs = {"f": push, "g": lambda t: 2.0 - 500.0 * t}
    return prepare(diagram, duration=duration, inputs=inputs, computer="continuous", jit=False)


def cases_of(setup, count):
    """Parameters of cases that differ in each; the second has a bristle too stiff for the step."""
    values, names = setup.diagram.values, setup.program.layout.parameters
    one = np.array([values[n] for n in names])
    cases = one * (1.0 + 0.1 * np.sin(np.arange(count)[:, None] + 3 * np.arange(len(one))))
    late = [i for i, n in enumerate(names) if n.endswith((".delay", ".time"))]
    cases[:, late] = one[late]
    cases[1, [i for i, n in enumerate(names) if n.endswith("presliding.stiffness")]] *= 300.0
    return cases
