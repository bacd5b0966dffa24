"""An arm: a chain of links; each turns about or slides along an axis fixed in the link before it.

Each link has a frame that moves with it. At joint position q, the frame of a link relative to that
of the link before it (the base for the first) is

    revolute: rotation R Rot(axis, q), origin p        prismatic: rotation R, origin p + R axis q

Its ten inertial parameters are mass m, first moments m c, and moments of inertia about the origin
of its frame, in the axes of its frame. All joint forces of a motion are linear in them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..base.frozen import ByValue

Array: TypeAlias = NDArray[np.float64]

#: names of the inertial parameters of a link, in the order of `Link.inertial`
INERTIAL = ("m", "mx", "my", "mz", "ixx", "ixy", "ixz", "iyy", "iyz", "izz")
#: their units
UNITS = ("kg", *("kg*m",) * 3, *("kg*m^2",) * 6)
#: m/s^2: acceleration of gravity if an arm states no other, downwards along z of its base
GRAVITY = (0.0, 0.0, -9.80665)


@dataclass(frozen=True, eq=False)
class Link(ByValue):
    """A link and the joint that carries it.

    name: of the link;  joint: of its joint;  kind: "revolute" or "prismatic"
    axis: (3,) unit vector in the frame of the link;  rotation: (3, 3) R;  origin: (3,) p, m
    inertial: (10,) in the order of `INERTIAL`, about the origin of the frame; SI
    """

    name: str
    joint: str
    kind: str
    axis: Array
    rotation: Array
    origin: Array
    inertial: Array


@dataclass(frozen=True, eq=False)
class Chain(ByValue):
    """Links from the base to the tip, and gravity (3,) in the frame of the base, m/s^2."""

    links: tuple[Link, ...]
    gravity: tuple[float, float, float] = GRAVITY

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints, from the base to the tip."""
        return tuple(link.joint for link in self.links)

    @property
    def inertial(self) -> Array:
        """Inertial parameters (10 k,) of the k links, one after the other."""
        return np.concatenate([link.inertial for link in self.links])

    def with_gravity(self, gravity: tuple[float, float, float]) -> Chain:
        """The same arm in another mounting; gravity: (3,) m/s^2, in the frame of its base."""
        return replace(self, gravity=gravity)

    def __repr__(self) -> str:
        lines = [f"Arm of {len(self.links)} joints"]
        lines += [f"  {x.joint} ({x.kind}): {x.name}, {x.inertial[0]:.4g} kg" for x in self.links]
        return "\n".join(lines)


def rotation_of(roll: float, pitch: float, yaw: float) -> Array:
    """Rotation matrix (3, 3) for turns about fixed axes x, then y, then z (rad), as in URDF."""
    cr, sr, cp, sp = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch)
    cy, sy = np.cos(yaw), np.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def inertia_about(mass: float, centre: Array, inertia: Array) -> Array:
    """Inertial parameters (10,) of a body about the origin of a frame.

    mass: kg;  centre: (3,) centre of mass in this frame, m
    inertia: (3, 3) about the centre of mass, kg m^2, in the axes of this frame
    """
    c = np.asarray(centre, dtype=float)
    about = inertia + mass * (float(c @ c) * np.eye(3) - np.outer(c, c))
    return np.array([mass, *(mass * c), *_moments(about)])


def express_in_frame(inertial: Array, rotation: Array, origin: Array) -> Array:
    """Inertial parameters (10,) of a body, transformed from one frame to another.

    inertial: (10,) in the first frame
    rotation, origin: (3, 3), (3,) of the first frame, in the other frame
    """
    mass, first = float(inertial[0]), rotation @ inertial[1:4]
    about = rotation @ tensor(inertial[4:]) @ rotation.T
    # about the new origin: (r x)(r x)^T with r = origin + R s, summed over the mass
    both = np.outer(origin, first) + np.outer(first, origin) + mass * np.outer(origin, origin)
    about = about + np.trace(both) * np.eye(3) - both
    return np.array([mass, *(first + mass * origin), *_moments(about)])


def _moments(about: Array) -> Array:
    """The six components (6,) of a tensor of inertia (3, 3), in the order of `INERTIAL`."""
    return about[np.triu_indices(3)]


def tensor(moments: Array) -> Array:
    """Tensor of inertia (3, 3) from its six components xx, xy, xz, yy, yz, zz."""
    xx, xy, xz, yy, yz, zz = moments
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
