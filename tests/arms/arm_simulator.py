"""Arms that move along Fourier paths, and the forces at their motors: independent of the package.

Newton's and Euler's equations at the centre of mass of each link in the axes of the room; joint
forces by virtual work. Nothing of `teleopdesign` is imported. The paths are prescribed, so forces
follow from them: friction and hidden effects are added at the motors.
"""

from __future__ import annotations

import gzip
import json
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

GRAVITY = np.array([0.0, 0.0, -9.80665])
#: parts of a row over which the force of a held command is averaged: a reversal comes within a row,
#: and with four parts its friction came up to 1.2 ms late, which shows below 8 Hz
PARTS = 20


@dataclass(frozen=True)
class SimulatedArm:
    """k joints: kind, axis and origin of each in the frame before it (at zero), and its link.

    centre: of mass in the frame of the link;  moments: (3, 3) about it
    """

    kinds: list[str]
    axes: list[np.ndarray]
    origins: list[np.ndarray]
    angles: list[np.ndarray]
    masses: list[float]
    centres: list[np.ndarray]
    moments: list[np.ndarray]
    coulomb: np.ndarray = field(default_factory=lambda: np.zeros(0))
    viscous: np.ndarray = field(default_factory=lambda: np.zeros(0))

    @property
    def count(self) -> int:
        return len(self.kinds)


def turned(axis, angle):
    """Rotation (3, 3) about a unit axis."""
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def roll_pitch_yaw(rpy):
    r, p, y = rpy
    ex, ey, ez = np.eye(3)
    return turned(ez, y) @ turned(ey, p) @ turned(ex, r)


def random_arm(generator, count, *, prismatic=False):
    """An arm of `count` joints with links of 0.2 to 0.5 m that get lighter towards the tip."""
    kinds = ["revolute"] * count
    if prismatic:
        kinds[int(generator.integers(count))] = "prismatic"
    axes, origins, angles, masses, centres, moments = [], [], [], [], [], []
    for i in range(count):
        axes.append(np.eye(3)[[2, 1, 1, 0, 1, 2][i % 6]])
        origins.append(np.array([0.0, generator.uniform(-0.1, 0.1), generator.uniform(0.2, 0.5)]))
        angles.append(generator.uniform(-0.3, 0.3, 3))
        masses.append(float(8.0 * 0.6**i * generator.uniform(0.7, 1.3)))
        centres.append(generator.uniform(-0.05, 0.05, 3) + np.array([0, 0, 0.15]))
        a = generator.normal(size=(3, 3)) * 0.1
        moments.append(masses[-1] * (a @ a.T * 0.3 + 0.01 * np.eye(3)))
    return SimulatedArm(
        kinds,
        axes,
        origins,
        angles,
        masses,
        centres,
        moments,
        coulomb=np.array([6.0 * 0.65**i * generator.uniform(0.7, 1.4) for i in range(count)]),
        viscous=np.array([8.0 * 0.6**i * generator.uniform(0.7, 1.4) for i in range(count)]),
    )


def forces(arm, q, v, a):
    """Forces (k, n) that the links need along a motion (k, n), by virtual work in the room."""
    k, n = q.shape
    out = np.zeros((k, n))
    for s in range(n):
        rotation, place = np.eye(3), np.zeros(3)
        spin, turn, speed_up = np.zeros(3), np.zeros(3), np.zeros(3)
        axes, points = [], []
        for i in range(k):
            offset = rotation @ arm.origins[i]
            fixed = rotation @ roll_pitch_yaw(arm.angles[i])
            axis = fixed @ arm.axes[i]
            if arm.kinds[i] == "prismatic":
                offset = offset + q[i, s] * axis
            speed_up = speed_up + np.cross(turn, offset) + np.cross(spin, np.cross(spin, offset))
            place = place + offset
            if arm.kinds[i] == "prismatic":
                speed_up = speed_up + a[i, s] * axis + 2 * v[i, s] * np.cross(spin, axis)
                rotation = fixed
            else:
                turn = turn + a[i, s] * axis + np.cross(spin, axis) * v[i, s]
                spin = spin + v[i, s] * axis
                rotation = fixed @ turned(arm.axes[i], q[i, s])
            axes.append(axis)
            points.append(place)
            arm_of_mass = rotation @ arm.centres[i]
            of_mass = (
                speed_up + np.cross(turn, arm_of_mass) + np.cross(spin, np.cross(spin, arm_of_mass))
            )
            force = arm.masses[i] * (of_mass - GRAVITY)
            inertia = rotation @ arm.moments[i] @ rotation.T
            moment = inertia @ turn + np.cross(spin, inertia @ spin)
            for j in range(i + 1):
                if arm.kinds[j] == "prismatic":
                    out[j, s] += axes[j] @ force
                else:
                    lever = place + arm_of_mass - points[j]
                    out[j, s] += axes[j] @ (moment + np.cross(lever, force))
    return out


def path(generator, k, time, *, harmonics=5, base=0.1):
    """Fourier paths (k, n): position, velocity and acceleration of each joint, all at once."""
    w = 2 * np.pi * base * np.arange(1, harmonics + 1)
    c, s = generator.normal(size=(2, k, harmonics)) / w * 0.35
    phase = np.outer(w, time)
    q = c @ np.cos(phase) + s @ np.sin(phase)
    v = (-c * w) @ np.sin(phase) + (s * w) @ np.cos(phase)
    a = (-c * w**2) @ np.cos(phase) - (s * w**2) @ np.sin(phase)
    return q, v, a


# ---- hidden effects: force that the motor gives beside what links, Coulomb and viscous need


#: effects that an arm may hide at one joint
HIDDEN = (
    "stribeck",
    "shear_thinning",
    "quadratic_drag",
    "load_dependent_friction",
    "coulomb_asymmetry",
    "viscous_asymmetry",
    "position_dependent_friction",
    "cogging",
    "spring",
    "bias",
    "presliding",
)


def hidden_force(name, strength, x, v, load, friction, step, beside):
    """Force of a hidden effect (n,) at a joint; friction: its Coulomb level; load: of its links.

    name: of `HIDDEN`, or "coupling": another joint pushes, which may lie in the links' inertia
    strength: about one is clear;  beside: acceleration (n,) of the joint that pushes this one
    """
    sign = np.sign(v)
    if name == "stribeck":
        return strength * 0.6 * friction * np.exp(-((v / 0.08) ** 2)) * sign
    if name == "shear_thinning":
        return strength * 1.5 * friction * np.abs(v) ** 0.5 * sign
    if name == "quadratic_drag":
        return strength * 3.0 * friction * v * np.abs(v)
    if name == "load_dependent_friction":
        mu = 0.12 * strength  # of what the motor gives: gear friction adds to what it must carry
        level = friction * sign
        acting = load + level
        for _ in range(60):
            acting = load + level + mu * np.abs(acting) * sign
        return acting - load - level
    if name == "coulomb_asymmetry":
        return strength * 0.5 * friction * (v > 0)
    if name == "viscous_asymmetry":
        return strength * 1.0 * friction * v * (v > 0)
    if name == "bias":
        return np.full_like(v, strength * 0.4 * friction)
    if name == "position_dependent_friction":
        return strength * 0.5 * friction * np.sin(2 * np.pi * x / 0.5) * sign
    if name == "cogging":
        return strength * 0.5 * friction * np.sin(2 * np.pi * x / 0.15 + 0.4)
    if name == "spring":
        return strength * 3.0 * friction * x
    if name == "coupling":
        return strength * 0.5 * friction * beside / np.sqrt(np.mean(beside**2))
    if name == "presliding":
        z, out = float(sign[0]), np.empty_like(v)
        for i, move in enumerate(v * step):  # Dahl: exact over a step of constant velocity
            target = np.sign(move)
            z = target + (z - target) * np.exp(-abs(move) / (0.03 * strength))
            out[i] = friction * z
        return out - friction * sign
    raise ValueError(name)


def write_experiment(
    folder: Path, arm, generator, hidden=None, *, seconds=30.0, rate=100.0, late=0.0
):
    """A folder with URDF, experiment.toml and two records; hidden: (name, joint number, strength).

    late: rows by which commands are logged late, in twentieths of one, of all joints or of each;
    seconds: with it, whole periods of the paths (10 s): the record begins with what ends it
    The user's model has the true kinematics, zero inertial values, Coulomb and viscous friction.
    truth.json says what is hidden, and rms of its force over that of its joint on the last record.
    """
    folder.mkdir(parents=True, exist_ok=True)
    k, size = arm.count, 0.0
    for use in ("fit", "check"):
        n = int(seconds * rate)
        fine = (np.arange(n * PARTS) + 0.5) / (rate * PARTS)
        state = generator.bit_generator.state
        q_fine, v, a_fine = path(generator, k, fine)
        load = _every(arm, q_fine, v, a_fine)
        motor = load + arm.coulomb[:, None] * np.sign(v) + arm.viscous[:, None] * v
        if hidden is not None:
            name, j, strength = hidden
            force = hidden_force(
                name,
                strength,
                q_fine[j],
                v[j],
                load[j] + arm.viscous[j] * v[j],
                arm.coulomb[j],
                1 / (rate * PARTS),
                a_fine[j + 1 if j + 1 < k else j - 1],
            )
            motor[j] += force
            size = float(np.sqrt(np.mean(force**2) / np.mean(motor[j] ** 2)))
        shifts = np.round(np.broadcast_to(late, k) * PARTS).astype(int)
        motor = np.array([np.roll(m, x) for m, x in zip(motor, shifts, strict=True)])
        command = motor.reshape(k, n, PARTS).mean(axis=2)
        noise = 0.01 * np.std(command, axis=1)
        command += noise[:, None] * generator.normal(size=(k, n))
        time = np.arange(n) / rate
        generator.bit_generator.state = state
        q, _, _ = path(generator, k, time)
        q = np.round(q / 1e-5) * 1e-5
        names = ["t", *(f"q{i + 1}" for i in range(k)), *(f"u{i + 1}" for i in range(k))]
        rows = np.vstack([time, q, command]).T
        text = ",".join(names) + "\n" + "\n".join(",".join(f"{x:.9g}" for x in r) for r in rows)
        (folder / f"{use}.csv.gz").write_bytes(gzip.compress((text + "\n").encode(), 4, mtime=0))
    (folder / "arm.urdf").write_text(urdf(arm))
    (folder / "experiment.toml").write_text(_toml(noise))
    (folder / "truth.json").write_text(json.dumps({"hidden": hidden, "size": size}))
    return folder


def _every(arm, q, v, a):
    """Forces of the links on the fine grid: once a row, between rows by a spline."""
    from scipy.interpolate import CubicSpline

    n = q.shape[1]
    at = np.append(np.arange(0, n - 1, PARTS), n - 1)
    return CubicSpline(at, forces(arm, q[:, at], v[:, at], a[:, at]), axis=1)(np.arange(n))


def urdf(arm, *, inertial=False):
    """The arm as a URDF; inertial: with its masses, which a user may not know."""
    parts = ['<?xml version="1.0"?>', '<robot name="simulated">', '<link name="base"/>']
    for i in range(arm.count):
        parent = "base" if i == 0 else f"link{i}"
        inside = ""
        if inertial:
            m = arm.moments[i]
            moments = {"ixx": m[0, 0], "ixy": m[0, 1], "ixz": m[0, 2]}
            moments |= {"iyy": m[1, 1], "iyz": m[1, 2], "izz": m[2, 2]}
            listed = " ".join(f'{key}="{value!r}"' for key, value in _plain(moments).items())
            inside = (
                f'<inertial><mass value="{arm.masses[i]!r}"/><origin xyz="{_text(arm.centres[i])}"'
                f' rpy="0 0 0"/><inertia {listed}/></inertial>'
            )
        parts += [
            f'<joint name="axis{i + 1}" type="{arm.kinds[i]}">',
            f'<parent link="{parent}"/><child link="link{i + 1}"/>',
            f'<origin xyz="{_text(arm.origins[i])}" rpy="{_text(arm.angles[i])}"/>',
            f'<axis xyz="{_text(arm.axes[i])}"/></joint>',
            f'<link name="link{i + 1}">{inside}</link>',
        ]
    return "\n".join([*parts, "</robot>"])


def _plain(values):
    return {key: float(value) for key, value in values.items()}


def _text(vector):
    return " ".join(repr(float(x)) for x in vector)


def _toml(noise):
    k = len(noise)
    lines = ['title = "simulated arm"', "[model.arm]", 'urdf = "arm.urdf"']
    lines += ['estimate = "base parameters"']
    for i in range(1, k + 1):
        lines += [f"[model.arm.joints.joint{i}]", f'urdf_joint = "axis{i}"']
        lines += [f"[model.arm.joints.joint{i}.effects]", "coulomb = {}", "viscous = {}"]
    lines += ["[channels]", 'time = { column = "t", unit = "s" }']
    for i in range(1, k + 1):
        lines += [
            f'"joint{i}.position" = {{ column = "q{i}", unit = "rad", resolution = 1e-5 }}',
            f'"joint{i}.actuator_force" = {{ column = "u{i}", unit = "N*m", '
            f"noise = {float(noise[i - 1])!r} }}",
        ]
    lines += ["[comparison]", 'bandwidth = { value = 8, unit = "Hz" }']
    for use in ("fit", "check"):
        lines += ["[[records]]", f'file = "{use}.csv.gz"', f'use = "{use}"']
    return "\n".join(lines) + "\n"
