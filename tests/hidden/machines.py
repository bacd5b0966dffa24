"""Random machines: bodies, controller, hand, sensors, what drives them, what their user has."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from excitation import RECORDS, edge, sines
from reference import Track
from truth_effects import Scale, Values
from truth_simulator import NAMES, Drive, Motion, body, simulate

DURATION = {"fit": 12.0, "check": 8.0}


@dataclass
class Machine:
    kind: str
    axis: str
    bodies: list[str]
    values: list[Values]
    scales: list[Scale]
    sensors: list[bool]
    noise: list[float]
    fixed_inertia: list[bool]
    in_model: list[list[str]]  # effects of the user's model, a list a body
    bandwidth: float
    rate: float
    drives: dict[str, Drive]
    noise_seed: int
    contact: bool = False
    tracks: dict[str, list[Track]] = field(default_factory=dict)


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(math.log(low), math.log(high))))


def nice(value: float, digits: int = 2) -> float:
    return float(f"{value:.{digits - 1}e}")


def _one(
    rng: np.random.Generator,
    axis: str,
    inertia: float,
    typical: tuple[float, float, float],
    bandwidth: float,
    rate: float,
) -> tuple[Values, Scale]:
    """One body; typical: size, speed and force of its motion."""
    size, speed, force = typical
    # an encoder step that leaves a few thousandths to a few hundredths of the force below the line
    low, high = (5e-7, 1.2e-5) if axis == "prismatic" else (1e-5, 2e-4)
    left = log_uniform(rng, 0.003, 0.025) * 0.5 * force
    share = 0.4 / math.sqrt(12) * math.sqrt(bandwidth / (0.5 * rate))
    step = left / (inertia * share * (2 * math.pi * bandwidth) ** 2)
    resolution = nice(min(max(step, low), high))
    level = log_uniform(rng, 0.1, 0.6) * force
    w = 2 * np.pi * rng.uniform(5, 9)
    values = {
        "inertia": inertia,
        "level": level,
        "damping": log_uniform(rng, 0.05, 0.4) * force / speed,
        "resolution": resolution,
        "grid_offset": float(rng.uniform(-0.5, 0.5) * resolution),
        "kp": inertia * w**2,
        "kd": 1.5 * inertia * w,
        "derivative_weight": float(rng.uniform(0.3, 0.6)),
        "command_step": 10 ** math.floor(math.log10(force) - 4),
    }
    return values, Scale(force, speed, size, DURATION["fit"], resolution)


def make_machine(
    rng: np.random.Generator,
    kind: str,
    excitation: str,
    rate: float,
    hand: bool | None,
    contact: bool,
    turns: bool = False,
) -> Machine:
    """A random machine; turns: on a revolute axis in any case."""
    drawn = str(rng.choice(["prismatic", "revolute"]))
    axis = "revolute" if turns else drawn
    linear = axis == "prismatic"
    two = kind == "teleoperator"
    inertia = log_uniform(rng, 0.05, 2.0) if linear else log_uniform(rng, 1e-4, 1e-2)
    size = log_uniform(rng, 0.008, 0.02) if linear else log_uniform(rng, 0.1, 0.3)
    top = float(rng.uniform(15, 18))
    shapes = {r: RECORDS[r](rng, rate, d, excitation, top) for r, d in DURATION.items()}
    k = slice(round(0.4 * rate), round(4.0 * rate))
    speed = float(size * shapes["fit"][1][k].std())
    force = float(inertia * size * (np.gradient(shapes["fit"][1]) * rate)[k].std())
    if hand is None:
        hand = two or bool(rng.random() < 0.65)
    values, scales = [], []
    bandwidth = float(rng.choice([50, 60, 80]))
    for i in range(2 if two else 1):
        ratio = float(rng.uniform(0.7, 1.4)) if i else 1.0
        v, s = _one(rng, axis, inertia * ratio, (size, speed, force * ratio), bandwidth, rate)
        values.append(v)
        scales.append(s)
    if hand:
        mass = inertia * rng.uniform(0.3, 1.0)
        grip, arm = 2 * np.pi * rng.uniform(5, 10), 2 * np.pi * rng.uniform(1.5, 3.5)
        values[0] |= {
            "has_hand": 1.0,
            "hand_mass": mass,
            "grip_stiffness": mass * grip**2,
            "grip_damping": 0.8 * mass * grip,
            "arm_stiffness": mass * arm**2,
            "arm_damping": 1.2 * mass * arm,
        }
    if contact:
        values[1] |= {
            "has_contact": 1.0,
            "contact_stiffness": float(rng.uniform(0.5, 2.5)) * force / size,
            "contact_position": float(rng.uniform(0.2, 0.7)) * size,
        }
    both = 2 if two else 1
    drives = {}
    for name, (x, v) in shapes.items():
        n = len(x)
        t = np.arange(n) / rate
        drive = Drive.zero(n, both)
        acceleration = np.gradient(v) * rate
        for i in range(both):
            if not two:
                drive.reference[:, i] = size * x
                drive.reference_velocity[:, i] = size * v
            share = rng.uniform(0.5, 0.9)
            drive.feedforward[:, i] = share * values[i]["inertia"] * size * acceleration
            if two:  # what pulls the pair along the trajectory, at the master alone
                drive.feedforward[:, i] += (1 - i) * values[0]["kp"] * size * x * 0.3
        if hand:
            on = edge(t, 0.2, 0.4 * t[-1]) + edge(t, 0.55 * t[-1], 0.85 * t[-1])
            y = size * rng.uniform(0.3, 1.5) * sines(t, rng, 0.3, 4.0, 8, 1.2) * on
            if two:
                y = y + size * x
            drive.hand[:, 0] = y
            drive.hand_velocity[:, 0] = np.gradient(y) * rate
            f = sines(t, rng, 0.5, top, 10, 6.0) * edge(t, 0.3, 0.5 * t[-1])
            drive.direct[:, 0] = rng.uniform(0.1, 0.6) * force * f
        drives[name] = drive
    sensors = [hand, two and not contact and bool(rng.random() < 0.3)][:both]
    if two and sensors[1]:
        contact_force = rng.uniform(0.5, 2.0) * force / size
        values[1] |= {
            "has_contact": 1.0,
            "contact_stiffness": float(contact_force),
            "contact_position": 0.4 * size,
        }
    noise = [nice(log_uniform(rng, 0.003, 0.02) * force, 3) for _ in range(both)]
    return Machine(
        kind, axis, ["master", "slave"] if two else ["device"], values, scales, sensors, noise,
        [False] * both, [["coulomb", "viscous"] for _ in range(both)],
        bandwidth, rate, drives, int(rng.integers(2**31)), contact,
    )  # fmt: skip


def simulator_body(values: Values) -> np.ndarray:
    """Parameter vector: a stiff bristle of a give far below the encoder step, unless it is soft."""
    known = {k: v for k, v in values.items() if k in NAMES}
    known["inertia"] = values["inertia"] + values.get("added_inertia", 0.0)
    # "inertia" is what the user knows of the whole: with a tip, that of both sides
    known["inertia"] -= values.get("tip_inertia", 0.0)
    if values.get("presliding"):
        known["bristle_stiffness"] = values["presliding"]
    else:
        known["bristle_stiffness"] = hard_stiffness(values)
        known["bristle_damping"] = 0.3 * math.sqrt(known["bristle_stiffness"] * known["inertia"])
    return body(**known)


def hard_stiffness(values: Values) -> float:
    level = values.get("level", 0.0) + values.get("extra_static_level", 0.0)
    return max(level, 1e-9) / (0.3 * values["resolution"])


def run_machine(
    machine: Machine, values: list[Values], inner: float = 20e-6
) -> dict[str, list[Track]]:
    """Simulate both records and add encoder and sensor errors."""
    out = {}
    sub = 5
    steps = sub * max(1, math.ceil(1 / (machine.rate * inner * sub)))
    bodies = [simulator_body(v) for v in values]
    rng = np.random.default_rng(machine.noise_seed)
    for name, drive in machine.drives.items():
        motion = simulate(bodies, drive, machine.rate, steps, sub)
        out[name] = [_track(machine, motion, values, i, rng) for i in range(len(bodies))]
    return out


def _track(
    machine: Machine, motion: Motion, values: list[Values], i: int, rng: np.random.Generator
) -> Track:
    n = len(motion.command)
    sensed = np.zeros(n)
    if machine.sensors[i]:
        if values[i].get("has_contact") and not machine.contact:
            motion["interaction"][:, i] += motion["contact"][:, i]
        sensed = motion.rows("interaction")[:, i] + rng.normal(0, machine.noise[i], n)
    return Track(
        motion, i, values[i]["resolution"], machine.noise[i], sensed, motion.encoder[:, i],
        machine.sensors[i], machine.bandwidth,
    )  # fmt: skip
