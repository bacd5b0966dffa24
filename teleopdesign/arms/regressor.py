"""Regressor of an arm: joint forces of a motion, linear in the inertial parameters.

    force = Y(q, q', q'') x inertial parameters

Recursive Newton-Euler algorithm for all samples at once. First velocities and accelerations of the
frames, from the base to the tip; gravity is an opposite acceleration of the base. Then force and
moment per unit of each inertial parameter of a link, which all joints between the base and the link
carry.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.errors import ModelError
from .chain import Array, Chain, Link, tensor

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
