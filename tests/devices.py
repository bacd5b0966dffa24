"""Devices that the design tests share; few structures, so that few kernels are compiled."""

import numpy as np

from teleopdesign.blocks import Body, Value
from teleopdesign.controllers import controller, scheduled_force_feedback
from teleopdesign.diagrams import Diagram, Moving, controller_parts, teleoperator
from teleopdesign.effects import EFFECTS


def body(inertia=0.15, **parameters):
    """A body with the effects that `effect__parameter=value` names."""
    numbers = {n.replace("__", "."): v for n, v in parameters.items()}
    effects = tuple(dict.fromkeys(n.split(".")[0] for n in numbers))
    values = {"inertia": Value(inertia)} | {n: Value(v) for n, v in numbers.items()}
    return Body("prismatic", values, tuple(EFFECTS[e] for e in effects))


LUGRE = {
    "coulomb__level": 0.5,
    "stribeck__extra_static_level": 0.1,
    "stribeck__stribeck_velocity": 0.005,
    "presliding__stiffness": 1e5,
    "viscous__damping": 0.1,
}
CANCELLATION = controller("smoothed_coulomb", {"level": 0.5, "smoothing_velocity": 0.015})
FEEDBACK = scheduled_force_feedback(gain=5.0, scheduling_velocity=0.08, bandwidth=20.0)
LOOP = controller("lead", {"gain": 2e4, "zero": 2 * np.pi, "pole": 100 * np.pi})
DAHL = controller("dahl", {"level": 0.4, "stiffness": 1e4})
LINK = controller("spring_damper", {"stiffness": 200.0, "damping": 3.0})


def coupled(**friction):
    """Two devices on a link, the master's friction cancelled;  friction: default: with bristles.

    One structure, whether friction is ideal or deflects before it slides.
    """
    rubbing = friction or {"coulomb__level": 0.5, "presliding__stiffness": 2e4}
    master, slave = (body(0.15, **rubbing, viscous__damping=0.4) for _ in range(2))
    hand = body(0.1, viscous__damping=2.0)
    return teleoperator(master, slave, coupling=LINK, hand=hand, master_cancellation=DAHL)


def two_rods(system, analog=True):
    """Two rods on one axis, and a law of two inputs and outputs."""
    rods = tuple(
        Moving(
            f"Z{i}", body(0.1 * i, viscous__damping=3.0), f"x{i}", f"u{i}", {f"f{i}": 1.0}, f"f{i}"
        )
        for i in (1, 2)
    )
    controls, sums = controller_parts(
        system, name="C", inputs=("x1", "x2"), outputs=("u1", "u2"), motion="x1", analog=analog
    )
    outside = {"f1": "force", "f2": "force"}
    return Diagram("two rods", (*rods, *controls), sums, outside, ("x1", "x2"))
