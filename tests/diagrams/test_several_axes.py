"""Diagrams of several axes: matrices of blocks, geometry, arms with changing inertia."""

import numpy as np
import pytest
import sympy as sp
from devices import body

from teleopdesign.blocks import Body, Value, matrix_impedance
from teleopdesign.controllers import controller
from teleopdesign.derive import block_symbol, transfer_functions
from teleopdesign.diagrams import (
    ANY,
    Arm,
    haptic_interface,
    joint,
    parallel_rods,
    teleoperator_of_arms,
)
from teleopdesign.effects import EFFECTS
from teleopdesign.frequency import matrix_response
from teleopdesign.simulate import simulate

FREQUENCY = np.array([0.5, 3.0, 20.0])
G = np.array([[1.0, 0.2, 0.0], [-0.3, 0.9, 0.1], [0.0, 0.4, 1.2]])
MASSES, DAMPINGS = (0.1, 0.15, 0.2), (1.0, 2.0, 0.5)


def rods():
    return [body(m, viscous__damping=b) for m, b in zip(MASSES, DAMPINGS, strict=True)]


def a_hand():
    mass = np.array([[0.4, 0.1, 0.0], [0.1, 0.3, 0.05], [0.0, 0.05, 0.5]])
    return matrix_impedance(mass=mass, damping=8 * mass, stiffness=600 * mass)


LOW_PASS = controller("low_pass", {"bandwidth": 20.0})
SPRING = controller("spring_damper", {"stiffness": -40.0, "damping": -0.2})


def values(symbolic, blocks):
    """An expression of blocks with matrices over frequency (n, k, k) in their place."""
    if symbolic.is_Number:
        return float(symbolic) * np.eye(3)
    if symbolic.is_Symbol:
        return blocks[symbolic]
    if symbolic.is_Pow:
        return np.linalg.matrix_power(values(symbolic.base, blocks), int(symbolic.exp))
    parts = [values(a, blocks) for a in symbolic.args]
    out = parts[0]
    for part in parts[1:]:
        out = out + part if symbolic.is_Add else out @ part
    return out


def test_the_formulas_of_one_axis_hold_for_matrices_that_do_not_commute():
    """T_H of three rods solved from the wiring is the symbolic T_H with matrices for its blocks."""
    cross = {(1, 1): LOW_PASS, (2, 2): LOW_PASS, (3, 3): LOW_PASS, (1, 2): LOW_PASS}
    diagram = parallel_rods(
        rods(), G, hand=a_hand(), cancellation=[SPRING] * 3, force_feedback=cross
    )
    names = [[f"{s}{n}" for n in (1, 2, 3)] for s in ("R_M", "R_D")]
    response = matrix_response(diagram, *names, FREQUENCY).data.values
    s = 2j * np.pi * FREQUENCY
    low_pass = 1 / (1 + s / (2 * np.pi * 20))
    shape = np.array([[1, 1, 0], [0, 1, 0], [0, 0, 1]])
    inverse = np.linalg.inv(G)
    mass, damping = np.diag(MASSES), np.diag(DAMPINGS)
    blocks = {
        "Z_M": s[:, None, None] ** 2 * mass + s[:, None, None] * damping,
        "Z_H": inverse.T @ a_hand().over(s) @ inverse,
        "C": (-40.0 - 0.2 * s)[:, None, None] * np.eye(3),
        "H": low_pass[:, None, None] * shape,
    }
    form = haptic_interface(hand=ANY, cancellation=ANY, force_feedback=ANY)
    symbolic = transfer_functions(form)["T_H"]
    expected = values(symbolic, {block_symbol(n): z for n, z in blocks.items()})
    np.testing.assert_allclose(response, expected, rtol=1e-10, atol=1e-12)


def test_the_impedance_felt_by_the_hand_is_that_of_the_rods_through_the_geometry():
    """G^T Zhat_M G: two hands' coordinates move all rods."""
    diagram = parallel_rods(rods(), G, hand=None)
    numbers = (1, 2, 3)
    lengths = [f"L{n}" for n in numbers]
    response = matrix_response(
        diagram, [f"F{n}" for n in numbers], lengths, FREQUENCY, given=lengths
    ).data.values
    s = 2j * np.pi * FREQUENCY[:, None, None]
    z = s**2 * np.diag(MASSES) + s * np.diag(DAMPINGS)
    np.testing.assert_allclose(response @ G, G.T @ z @ G, rtol=1e-10, atol=1e-12)


def revolute(inertia, damping=0.0):
    parameters = {"inertia": Value(inertia), "viscous.damping": Value(damping)}
    return Body("revolute", parameters, (EFFECTS["viscous"],))


LENGTHS = (0.4, 0.3)


def planar(cancellations=(), *, inertia=0.02, mass=0.5, damping=0.0):
    """Two links in a plane with a mass at the tip."""
    a, b = joint(1), joint(2)
    x = LENGTHS[0] * sp.cos(a) + LENGTHS[1] * sp.cos(a + b)
    y = LENGTHS[0] * sp.sin(a) + LENGTHS[1] * sp.sin(a + b)
    return Arm(
        (revolute(inertia, damping), revolute(inertia, damping)),
        (x, y),
        cancellations,
        load=matrix_impedance(mass=mass * np.eye(2)),
        pose=(0.3, 1.1),
    )


@pytest.mark.slow
def test_an_arm_that_swings_freely_keeps_its_energy_and_angular_momentum():
    """Coriolis forces of the tip's mass follow from the kinematics alone."""
    diagram = teleoperator_of_arms(planar(), planar(), stiffness=np.zeros((2, 2)))
    start = {"q_m1": 0.3, "q_m2": 1.1, "q_m1_velocity": 2.0, "q_m2_velocity": -3.0, "q_s2": 1.0}
    simulation = simulate(diagram, duration=1.0, initial=start, computer="continuous", step=1e-3)
    q, w = ([simulation[f"q_m{n}{end}"].values for n in (1, 2)] for end in ("", "_velocity"))
    angle = q[0] + q[1]
    rate = w[0] + w[1]
    vx = -LENGTHS[0] * np.sin(q[0]) * w[0] - LENGTHS[1] * np.sin(angle) * rate
    vy = LENGTHS[0] * np.cos(q[0]) * w[0] + LENGTHS[1] * np.cos(angle) * rate
    energy = 0.5 * 0.02 * (w[0] ** 2 + w[1] ** 2) + 0.25 * (vx**2 + vy**2)
    # order four at 1 ms and some 10 rad/s
    assert np.ptp(energy) < 1e-6 * energy[0]


def test_two_arms_are_one_linear_system_at_their_pose():
    damped = planar(damping=0.4)
    stiffness = np.array([[900.0, 100.0], [100.0, 700.0]])
    diagram = teleoperator_of_arms(damped, damped, stiffness=stiffness)
    response = matrix_response(diagram, ["X_s1", "X_s2"], ["F_u1", "F_u2"], FREQUENCY).data.values
    a, b = damped.pose
    jacobian = np.array(
        [
            [-LENGTHS[0] * np.sin(a) - LENGTHS[1] * np.sin(a + b), -LENGTHS[1] * np.sin(a + b)],
            [LENGTHS[0] * np.cos(a) + LENGTHS[1] * np.cos(a + b), LENGTHS[1] * np.cos(a + b)],
        ]
    )
    s = 2j * np.pi * FREQUENCY[:, None, None]
    inverse = np.linalg.inv(jacobian)
    z = s**2 * (0.5 * np.eye(2) + inverse.T @ (0.02 * np.eye(2)) @ inverse)
    z = z + s * inverse.T @ (0.4 * np.eye(2)) @ inverse
    joined = z + stiffness - stiffness @ np.linalg.inv(z + stiffness) @ stiffness
    expected = np.linalg.inv(z + stiffness) @ stiffness @ np.linalg.inv(joined)
    np.testing.assert_allclose(response, expected, rtol=1e-9)
