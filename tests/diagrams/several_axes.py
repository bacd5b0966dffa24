"""Diagrams of several axes that tests draw, write and judge."""

import numpy as np
import sympy as sp

from teleopdesign.blocks import Body, Value, matrix_impedance
from teleopdesign.controllers import controller
from teleopdesign.diagrams import Arm, joint, parallel_rods, teleoperator_of_arms
from teleopdesign.effects import EFFECTS

CANCELLATION = controller("smoothed_coulomb", {"level": 0.4, "smoothing_velocity": 0.01})


def body(inertia, axis="prismatic", *, damping=2.0, friction=0.0):
    made = Body(axis, {"inertia": Value(inertia)})
    made = made.with_effect(EFFECTS["viscous"], {"damping": damping})
    return made.with_effect(EFFECTS["coulomb"], {"level": friction}) if friction else made


def two_rods(*, friction=0.5, cancelled=True):
    """Two rods at an angle that hold one hand."""
    rod = body(0.15, friction=friction)
    return parallel_rods(
        [rod, rod],
        [[1.0, 0.0], [0.6, 0.8]],
        hand=matrix_impedance(stiffness=[[300.0, 40.0], [40.0, 200.0]], damping=3.0),
        cancellation=[CANCELLATION, CANCELLATION] if cancelled else (),
    )


def two_jointed_arm(*, friction=0.1, load=True):
    q1, q2 = joint(1), joint(2)
    return Arm(
        (body(0.02, "revolute", damping=0.1, friction=friction),) * 2,
        (0.3 * sp.cos(q1) + 0.2 * sp.cos(q1 + q2), 0.3 * sp.sin(q1) + 0.2 * sp.sin(q1 + q2)),
        load=matrix_impedance(mass=[[0.1, 0.0], [0.0, 0.1]]) if load else None,
        pose=(0.3, 0.9),
    )


def two_armed_teleoperator(**held):
    """Two arms of two joints, coupled at the tips."""
    arm = two_jointed_arm()
    held = held or {"hand": matrix_impedance(stiffness=[[100.0, 10.0], [10.0, 50.0]])}
    return teleoperator_of_arms(arm, arm, stiffness=200 * np.eye(2), damping=np.eye(2), **held)
