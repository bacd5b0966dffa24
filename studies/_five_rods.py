"""Five rods that hold a stylus: the machine of the study of isotropy.

An example, not a measurement, with the arrangement of Lee, Lawrence, Pao (2004): three rods meet at
one point of the stylus, two at another. Coordinates of the hand: x, y, z of the grip and the
rotations about x and y, times LEVER so that all five are lengths; z is along the stylus, the spin
about it is free.
"""

from __future__ import annotations

import control
import numpy as np

from teleopdesign.blocks import Body, MatrixImpedance, Value, matrix_impedance
from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import Diagram, parallel_rods
from teleopdesign.effects import EFFECTS
from teleopdesign.frequency import matrix_response

RODS = 5
COORDINATES = ("x", "y", "z", "rotation about x", "rotation about y")
LEVER = 0.06  # m; a rotation is that of a point so far from the grip
#: where each rod holds the stylus, from the grip, and its direction at this pose (any length)
POINTS = np.array([[0, 0, -0.05]] * 3 + [[0, 0, 0.08]] * 2)  # m
DIRECTIONS = np.array([[3, 0, 4], [-2, 3, 4], [-2, -3, 4], [4, 3, 0], [-1, 4, 1]])

INERTIA, DAMPING = 0.15, 1.0  # of each rod, kg and N s/m
FRICTION, GIVE = 0.5, 5e-5  # f_C of each rod, N, and its bristle length, m
SHARE = 0.9  # of the friction that is cancelled
GAIN, FEEDBACK_BANDWIDTH = 5.0, 20.0  # of the force feedback, 1 and Hz

HAND_INERTIA = np.diag([0.20, 0.20, 0.25, 0.05, 0.05])  # stylus and fingers, kg
HAND_DAMPING = np.diag([8.0, 8.0, 10.0, 3.0, 3.0])  # N s/m
HAND_STIFFNESS = np.diag([300.0, 400.0, 500.0, 150.0, 150.0])  # N/m
# fingers hold above the grip's point: there a turn about y moves by +x, one about x by -y
HAND_STIFFNESS[[0, 4], [4, 0]] = 60.0
HAND_STIFFNESS[[1, 3], [3, 1]] = -80.0


def geometry(points: np.ndarray, directions: np.ndarray, lever: float) -> np.ndarray:
    """G (n, 5): motion of each rod for a motion of the hand, L = G X, at one pose.

    A rod of direction d that holds the point p moves by d . (x + theta x p).
    points, directions: (n, 3), m and any length;  lever: m, that multiplies rotations
    """
    unit = directions / np.linalg.norm(directions, axis=1)[:, None]
    turns = np.cross(points, unit)[:, :2] / lever
    return np.hstack([unit, turns])


G = geometry(POINTS, DIRECTIONS, LEVER)


def hand(firmness: float = 1.0) -> MatrixImpedance:
    """The hand in its own coordinates; firmness: factor of its stiffness and damping."""
    return matrix_impedance(
        mass=HAND_INERTIA, damping=firmness * HAND_DAMPING, stiffness=firmness * HAND_STIFFNESS
    )


def machine(
    *, gain: float = 0.0, share: float = 0.0, friction: bool = True, firmness: float = 1.0
) -> Diagram:
    """The rods with analog force feedback and a sampled Dahl cancellation on each.

    gain, share: 0 leaves the controller wired, without effect: one kernel serves every case
    friction: False takes away the stiffness of the contacts, which then never pull
    Bristles of the cancellation are the stiffest for which it is passive beside the friction:
    (sigma_D/sigma_p)^2 = f_D/f_C.
    """
    contact = FRICTION / GIVE if friction else 0.0
    rod = Body("prismatic", {"inertia": Value(INERTIA)})
    rod = rod.with_effect(EFFECTS["viscous"], {"damping": DAMPING})
    rod = rod.with_effect(EFFECTS["coulomb"], {"level": FRICTION})
    rod = rod.with_effect(EFFECTS["presliding"], {"stiffness": contact})
    law = {"level": (share or SHARE) * FRICTION, "stiffness": FRICTION / GIVE * share**0.5}
    pole = 2 * np.pi * FEEDBACK_BANDWIDTH  # a state space, for a transfer function 0 has no order
    feedback = from_control(control.ss([[-pole]], [[pole]], [[gain]], [[0]]), name="feedback")
    return parallel_rods(
        [rod] * RODS,
        G,
        hand=hand(firmness),
        cancellation=[controller("dahl", law)] * RODS,
        force_feedback=[feedback] * RODS,
        analog=("H",),
    )


def rod_response(frequency: np.ndarray, *, gain: float, firmness: float = 1.0) -> np.ndarray:
    """T, R_D -> R_M of the rods without friction, (frequencies, 5, 5); frequency: (n,), Hz."""
    names = [[f"{signal}{n + 1}" for n in range(RODS)] for signal in ("R_M", "R_D")]
    diagram = machine(gain=gain, firmness=firmness)
    return np.asarray(matrix_response(diagram, *names, frequency).data.values)


def at_hand(rods: np.ndarray) -> np.ndarray:
    """A response between forces of the rods (..., 5, 5) as one between forces on the hand.

    R_D = G^-T F_want and F = G^T R_M
    """
    return np.asarray(G.T @ rods @ np.linalg.inv(G.T))
