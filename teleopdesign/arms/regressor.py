"""Regressor of an arm: joint forces of a motion, linear in the inertial parameters.

    force = Y(q, q', q'') x inertial parameters

Recursive Newton-Euler algorithm for all samples at once. First velocities and accelerations of the
frames, from the base to the tip; gravity is an opposite acceleration of the base. Then force and
moment per unit of each inertial parameter of a link, which all joints between the base and the link
carry.

Many of the ten parameters of a link act only together with those of other links, and some not at
all: a mass on an axis that never tilts causes no torque. The kinematics alone decide which columns
of the regressor are independent. So these are selected at random poses, by orthogonalisation:
moments first, then masses, motors last. Each base parameter has the name of the inertial parameter
whose column is selected.

Source: Gautier, Khalil, Direct calculation of minimum set of inertial parameters of serial robots,
IEEE Trans. Robotics and Automation 6 (1990) 368.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ModelError
from ..base.frozen import ByValue
from .chain import INERTIAL, UNITS, Array, Chain, Link, tensor

#: for each axis x, y, z the indices of the two other axes, in cyclic order
_NEXT, _LAST = np.array([1, 2, 0]), np.array([2, 0, 1])
#: unit vectors (3, 1, 3), and what one unit of each moment of inertia is as a tensor (6, 3, 3)
_UNITS = np.eye(3)[:, None]
_MOMENTS = np.array([tensor(unit) for unit in np.eye(6)])


@dataclass(frozen=True)
class _Frames:
    """Frame of a link along a motion, in the base: rotation (n, 3, 3), origin (n, 3).

    spin, turn: angular velocity and acceleration (n, 3);  lift: acceleration of the origin less
    gravity (n, 3); all three in the axes of the link
    """

    rotation: Array
    origin: Array
    spin: Array
    turn: Array
    lift: Array


def force_columns(arm: Chain, position: Array, velocity: Array, acceleration: Array) -> Array:
    """Force at each joint per unit of each inertial parameter (k, 10 k, n), SI.

    position, velocity, acceleration: (k, n) of the k joints, in the order of the arm
    raises ModelError: the shapes differ, or do not fit the arm
    """
    frames = _frames(arm, position, velocity, acceleration)
    force, moment = (np.stack(x) for x in zip(*map(_link_columns, frames), strict=True))
    columns = np.zeros((len(frames), *force.shape[:3]))
    for j in range(len(frames)):
        columns[j, j:] = _carried_load(arm.links[j], frames[j], force[j:], moment[j:])
    return columns.reshape(len(frames), -1, position.shape[1])


def _carried_load(link: Link, frame: _Frames, force: Array, moment: Array) -> Array:
    """Joint force (..., n) that carries forces and moments about the base's origin (..., n, 3).

    All in the axes of the base;  link, frame: of that joint
    """
    axis = frame.rotation @ link.axis
    if link.kind == "prismatic":
        return np.asarray(np.einsum("nc,...nc->...n", axis, force))
    lever = _cross(axis, frame.origin)
    turning = np.einsum("nc,...nc->...n", axis, moment)
    return np.asarray(turning - np.einsum("nc,...nc->...n", lever, force))


def _frames(arm: Chain, position: Array, velocity: Array, acceleration: Array) -> list[_Frames]:
    k = len(arm.links)
    if position.shape[0] != k or not position.shape == velocity.shape == acceleration.shape:
        raise ModelError(
            f"found a motion of {position.shape[0]} joints, expected {k}, with n samples each"
        )
    n = position.shape[1]
    here = _Frames(
        np.broadcast_to(np.eye(3), (n, 3, 3)),
        np.zeros((n, 3)),
        np.zeros((n, 3)),
        np.zeros((n, 3)),
        np.broadcast_to(-np.asarray(arm.gravity), (n, 3)),
    )
    frames = []
    for link, q, v, a in zip(arm.links, position, velocity, acceleration, strict=True):
        here = _next_frame(here, link, q, v, a)
        frames.append(here)
    return frames


def _next_frame(before: _Frames, link: Link, q: Array, v: Array, a: Array) -> _Frames:
    """The frame of a link from the frame of the link before it; q, v, a: (n,) of its joint."""
    axis = link.axis
    if link.kind == "prismatic":
        relative = np.broadcast_to(link.rotation, (len(q), 3, 3))
        offset = link.origin + q[:, None] * (link.rotation @ axis)
    else:
        relative = link.rotation @ _rotation_about(axis, q)
        offset = np.broadcast_to(link.origin, (len(q), 3))
    spin, turn = before.spin, before.turn
    lift = before.lift + _cross(turn, offset) + _cross(spin, _cross(spin, offset))
    spin, turn, lift = (np.einsum("nij,ni->nj", relative, x) for x in (spin, turn, lift))
    if link.kind == "prismatic":
        lift = lift + 2.0 * _cross(spin, v[:, None] * axis) + a[:, None] * axis
    else:
        joint_spin = v[:, None] * axis
        turn = turn + _cross(spin, joint_spin) + a[:, None] * axis
        spin = spin + joint_spin
    return _Frames(
        before.rotation @ relative,
        before.origin + np.einsum("nij,nj->ni", before.rotation, offset),
        spin,
        turn,
        lift,
    )


def _rotation_about(axis: Array, angle: Array) -> Array:
    """Rotations (n, 3, 3) about an axis (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.asarray(np.eye(3) + s * cross + (1.0 - c) * (cross @ cross))


def _link_columns(frame: _Frames) -> tuple[Array, Array]:
    """Force, and moment about the origin of the base, per inertial parameter of a link (10, n, 3).

    Both in the axes of the base.
    """
    w, t, lift = frame.spin, frame.turn, frame.lift
    force, moment = np.zeros((2, 10, *lift.shape))
    force[0] = lift
    force[1:4] = _cross(t, _UNITS) + _cross(w, _cross(w, _UNITS))
    moment[1:4] = _cross(_UNITS, lift)
    moment[4:] = t @ _MOMENTS + _cross(w, w @ _MOMENTS)
    turned = np.swapaxes(frame.rotation, 1, 2)
    force, moment = ((x[:, :, None] @ turned)[:, :, 0] for x in (force, moment))
    return force, moment + _cross(frame.origin, force)


def _cross(a: Array, b: Array) -> Array:
    """Vector product along the last axis; for few rows much faster than numpy's."""
    return np.asarray(a[..., _NEXT] * b[..., _LAST] - a[..., _LAST] * b[..., _NEXT])


#: random poses per joint: a few times the number of inertial parameters
POSES = 60
#: the rest of a column after elimination, relative to the largest column, below which it is
#: rounding: dependent columns leave 1e-13, independent ones 1e-4 and more
INDEPENDENT = 1e-8


@dataclass(frozen=True, eq=False)
class BaseParameters(ByValue):
    """Combinations of an arm's inertial parameters and motor inertias that its motion determines.

    names: of the b base parameters, such as "forearm_link.mx";  units: of each
    chosen: (b,) their columns in the regressor;  initial: (b,) their values by those of the arm
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    chosen: NDArray[np.intp]
    initial: Array


def columns_with_motors(arm: Chain, position: Array, velocity: Array, acceleration: Array) -> Array:
    """Regressor of the joint forces by inertial parameters and motor inertias (k, 11 k, n).

    position, velocity, acceleration: (k, n)
    The rotor of a joint needs its inertia times the acceleration of this joint, at this joint.
    """
    columns = force_columns(arm, position, velocity, acceleration)
    motors = np.eye(len(arm.links))[:, :, None] * acceleration[:, None, :]
    return np.concatenate([columns, motors], axis=1)


def base_parameters(arm: Chain, *, seed: int = 0) -> BaseParameters:
    """The base parameters of an arm, with moments preferred to masses, and masses to motors.

    seed: of the random poses; the parameters depend on it by rounding only
    """
    k, generator = len(arm.links), np.random.default_rng(seed)
    q, v, a = (generator.uniform(-np.pi, np.pi, (k, POSES * k)) for _ in range(3))
    columns = columns_with_motors(arm, q, v, a)
    rows = columns.transpose(0, 2, 1).reshape(-1, columns.shape[1])
    order = np.argsort([_turn(i, k) for i in range(rows.shape[1])], kind="stable")
    chosen = np.sort(order[_independent(rows[:, order])])
    names = [f"{link.name}.{x}" for link in arm.links for x in INERTIAL]
    names += [f"{link.joint}.motor_inertia" for link in arm.links]
    motor = ["kg" if link.kind == "prismatic" else "kg*m^2" for link in arm.links]
    units = [*UNITS * k, *motor]
    whole = np.concatenate([arm.inertial, np.zeros(k)])
    initial = np.linalg.lstsq(rows[:, chosen], rows @ whole, rcond=None)[0]
    return BaseParameters(
        tuple(names[i] for i in chosen), tuple(units[i] for i in chosen), chosen, initial
    )


def _turn(column: int, links: int) -> int:
    """Rank of a column in the selection: moments of links 0, masses 1, motors 2."""
    if column >= len(INERTIAL) * links:
        return 2
    return 1 if column % len(INERTIAL) == 0 else 0


def _independent(rows: Array) -> NDArray[np.intp]:
    """Indices of the columns that do not depend on the columns before them, in their order."""
    size = np.linalg.norm(rows, axis=0)
    basis = np.zeros((len(rows), 0))
    chosen = []
    for i in np.flatnonzero(size > INDEPENDENT * size.max()):
        left = rows[:, i] / size[i]
        for _ in range(2):  # twice: what rounding leaves of the first is taken out too
            left = left - basis @ (basis.T @ left)
        length = float(np.linalg.norm(left))
        if length > INDEPENDENT:
            basis = np.hstack([basis, left[:, None] / length])
            chosen.append(int(i))
    return np.array(chosen, dtype=np.intp)
