"""The forces at the joints that a motion of an arm needs: columns, linear in inertial parameters.

    force = Y(q, q', q'') x inertial parameters

Recursive Newton-Euler for all samples at once: velocities and accelerations of the frames from the
base to the tip, gravity as an acceleration of the base the other way; then the force and the moment
that one unit of each inertial parameter of a link needs, as every joint below it carries them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import ModelError
from .chain import INERTIAL, Array, Chain, Link


@dataclass(frozen=True)
class _Frames:
    """Frames of all links along a motion, in the base: rotation (n, 3, 3), origin (n, 3).

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
    """
    k = len(arm.links)
    if position.shape[0] != k or not position.shape == velocity.shape == acceleration.shape:
        raise ModelError(
            f"arm: found a motion of {position.shape[0]} joints, expected {k} with n samples each"
        )
    n, p = position.shape[1], len(INERTIAL)
    frames = _frames(arm, position, velocity, acceleration)
    columns = np.zeros((k, p * k, n))
    for i, here in enumerate(frames):
        force, moment = _link_columns(here)
        for j in range(i + 1):
            axis, lever = _express_axis(here, frames[j], arm.links[j])
            if arm.links[j].kind == "prismatic":
                columns[j, p * i : p * (i + 1)] = np.einsum("nc,npc->pn", axis, force)
                continue
            columns[j, p * i : p * (i + 1)] = np.einsum("nc,npc->pn", axis, moment) + np.einsum(
                "nc,npc->pn", np.cross(axis, lever), force
            )
    return columns


def _frames(arm: Chain, position: Array, velocity: Array, acceleration: Array) -> list[_Frames]:
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
    """The frame of a link from that of the link before it."""
    axis = link.axis
    if link.kind == "prismatic":
        relative = np.broadcast_to(link.rotation, (len(q), 3, 3))
        offset = link.origin + q[:, None] * (link.rotation @ axis)
    else:
        relative = link.rotation @ _rotation_about(axis, q)
        offset = np.broadcast_to(link.origin, (len(q), 3))
    spin, turn = before.spin, before.turn
    lift = before.lift + np.cross(turn, offset) + np.cross(spin, np.cross(spin, offset))
    spin, turn, lift = (np.einsum("nij,ni->nj", relative, x) for x in (spin, turn, lift))
    if link.kind == "prismatic":
        lift = lift + 2.0 * np.cross(spin, v[:, None] * axis) + a[:, None] * axis
    else:
        joint_spin = v[:, None] * axis
        turn = turn + np.cross(spin, joint_spin) + a[:, None] * axis
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
    """Force, and moment about the origin of its frame, per inertial parameter (n, 10, 3)."""
    w, t, lift = frame.spin, frame.turn, frame.lift
    n = len(w)
    force, moment = np.zeros((n, 10, 3)), np.zeros((n, 10, 3))
    force[:, 0] = lift
    for c in range(3):
        unit = np.broadcast_to(np.eye(3)[c], (n, 3))
        force[:, 1 + c] = np.cross(t, unit) + np.cross(w, np.cross(w, unit))
        moment[:, 1 + c] = np.cross(unit, lift)
    for k, (i, j) in enumerate([(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]):
        part = np.zeros((3, 3))
        part[i, j] = part[j, i] = 1.0
        moment[:, 4 + k] = t @ part + np.cross(w, w @ part)
    return force, moment


def _express_axis(frame: _Frames, below: _Frames, link: Link) -> tuple[Array, Array]:
    """Axis of a joint below, and lever from its origin to that of a frame, in axes of the frame."""
    axis = np.einsum("nji,njk,k->ni", frame.rotation, below.rotation, link.axis)
    lever = np.einsum("nji,nj->ni", frame.rotation, frame.origin - below.origin)
    return axis, lever
