"""A teleoperator with a computer, simulated in numpy alone: no code of the package.

    U_m = -P (X_m - X_s) + C_m X_m          m_m a_m = U_m + F_m - friction - B v
    U_s =  P (X_m - X_s) + C_s X_s          m_s a_s = U_s - friction - B v      the slave is free
    F_m = k (wanted - X_m) - b V_m - m_h a_m      a hand that follows its body wish

P is a spring and a damper, C_m and C_s smoothed Coulomb cancellations. F_m is recorded, and what
the hand wants is not, so that the hand is no block of the diagram.
"""

from dataclasses import dataclass, field

import numpy as np
from block_cuts.interface_simulator import (
    DT,
    INNER,
    PERIOD,
    Output,
    Velocity,
    write_logs,
)  # fmt: skip

SIDES = ("m", "s")
BODY = """[blocks.Z_{side}]
axis = "prismatic"
inertia = {{ value = {m}, unit = "kg" }}
[blocks.Z_{side}.effects.coulomb]
level = {{ value = {level}, unit = "N" }}
[blocks.Z_{side}.effects.viscous]
damping = {{ value = {damping}, unit = "N*s/m" }}
[blocks.C_{side}]
law = "smoothed_coulomb"
parameters = {{ level = {c_level}, smoothing_velocity = {c_velocity} }}
"""
COUPLING = """[blocks.P]
law = "spring_damper"
parameters = {{ stiffness = {stiffness}, damping = {coupling} }}
"""
EXPERIMENT = """
title = "simulated teleoperator"
[diagram]
file = "teleoperator.toml"
sample_period = {{ value = 1, unit = "ms" }}
[diagram.outside]
"F_d" = 0
[channels]
time = {{ column = "t", unit = "s" }}
"X_m" = {{ column = "x_m", unit = "m", resolution = {encoder} }}
"X_s" = {{ column = "x_s", unit = "m", resolution = {encoder} }}
"U_m" = {{ column = "u_m", unit = "N", resolution = {converter} }}
"U_s" = {{ column = "u_s", unit = "N", resolution = {converter} }}
"F_m" = {{ column = "f_m", unit = "N", noise = {noise} }}
[comparison]
bandwidth = {{ value = 60, unit = "Hz" }}
"""


@dataclass
class Teleoperator:
    """Values (SI) of one teleoperator; `hidden`: (effect, place) -> value, what the file lacks."""

    values: dict
    hidden: dict = field(default_factory=dict)
    converter: float = 0.004
    encoder: float = 1e-6
    noise: float = 0.015


def draw_teleoperator(random):
    """A teleoperator with values of table-top devices."""
    u = random.uniform
    values = {"stiffness": u(800, 1600), "coupling": u(4, 9), "m_hand": u(0.06, 0.18)}
    values |= {"b_hand": u(3.0, 6.0), "k_hand": u(250, 450)}
    for side in SIDES:
        values[side] = {
            "m": u(0.2, 0.4), "level": u(0.2, 0.5), "damping": u(0.5, 1.2),
            "c_level": u(0.15, 0.3), "c_velocity": u(0.012, 0.022),
        }  # fmt: skip
    return Teleoperator(values)


def record(teleoperator, duration, random):
    """Columns t, x_m, x_s, u_m, u_s, f_m of one recording from rest."""
    p, hidden, step = teleoperator.values, teleoperator.hidden, teleoperator.encoder
    n = round(duration / PERIOD)
    time = np.arange(n) * PERIOD
    wanted = _wanted(np.arange(n * INNER) * DT, random)
    out = np.zeros((5, n))
    outputs = {at: Output(hidden, at) for at in ("P", "C_m", "C_s")}
    velocities = {at: Velocity(hidden, at) for at in ("P", "C_m", "C_s")}
    x, v, command, last = np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(2)
    for i in range(n):
        reading = np.floor(x / step + 0.5) * step
        force = _hand(p, x[0], v[0], wanted[i * INNER])
        force -= p["m_hand"] * _accelerations(p, hidden, x, v, command, wanted[i * INNER])[0]
        force += teleoperator.noise * random.standard_normal()
        speed = (reading - last) / PERIOD if i else np.zeros(2)
        last = reading
        error, rate = reading[0] - reading[1], velocities["P"](speed[0] - speed[1])
        coupling = outputs["P"](p["stiffness"] * error + p["coupling"] * rate)
        cancel = []
        for k, side in enumerate(SIDES):
            known, body = velocities[f"C_{side}"](speed[k]), p[side]
            law = body["c_level"] * known / (body["c_velocity"] + abs(known))
            cancel.append(outputs[f"C_{side}"](law))
        command = np.array([-coupling, coupling]) + cancel
        out[:, i] = *reading, *command, force
        for j in range(INNER):
            a = _accelerations(p, hidden, x, v, command, wanted[i * INNER + j])
            faster = v + DT * a
            x, v = x + 0.5 * DT * (v + faster), faster
    logged = np.round(out[2:4] / teleoperator.converter) * teleoperator.converter
    names = ("x_m", "x_s", "u_m", "u_s", "f_m")
    return {"t": time} | dict(zip(names, (*out[:2], *logged, out[4]), strict=True))


def _hand(p, x, v, wanted):
    """Force of the hand on the master without that of its inertia."""
    return p["k_hand"] * (wanted - x) - p["b_hand"] * v


def _accelerations(p, hidden, x, v, command, wanted):
    """Of master with hand, and of the slave, with dry friction as by Moreau."""
    made = np.zeros(2)
    for k, side in enumerate(SIDES):
        body, mass, free = p[side], p[side]["m"], command[k] - p[side]["damping"] * v[k]
        if side == "m":
            mass, free = mass + p["m_hand"], free + _hand(p, x[k], v[k], wanted)
        free -= hidden.get(("quadratic_drag", f"Z_{side}"), 0.0) * v[k] * abs(v[k])
        free -= hidden.get(("bias", f"Z_{side}"), 0.0)
        stopping = mass * v[k] / DT + free
        made[k] = (free - min(max(stopping, -body["level"]), body["level"])) / mass
    return made


def _wanted(time, random):
    """Motion that the hand wants, m: a multisine below 5 Hz with slow steps."""
    signal = np.zeros_like(time)
    for frequency in random.uniform(0.3, 5.0, 8):
        size, phase = random.uniform(0.002, 0.006), random.uniform(0, 2 * np.pi)
        signal += size * np.sin(2 * np.pi * frequency * time + phase)
    return signal * np.minimum(time / 0.3, 1.0)


def write_teleoperator(teleoperator, folder, random, durations=(11.0, 8.0)):
    """The folder of an experiment, with stated values of bodies that are a few percent off."""
    write_logs(folder, [record(teleoperator, d, random) for d in durations])
    p = teleoperator.values
    text = '[diagram]\nkind = "teleoperator"\n'
    for side in SIDES:
        body = {n: p[side][n] * random.uniform(0.85, 1.15) for n in ("m", "level", "damping")}
        text += BODY.format(side=side, **{**p[side], **body})
    (folder / "teleoperator.toml").write_text(text + COUPLING.format(**p))
    sensors = {n: getattr(teleoperator, n) for n in ("converter", "encoder", "noise")}
    records = "".join(
        f'[[records]]\nfile = "{use}.csv.gz"\nuse = "{use}"\n' for use in ("fit", "check")
    )
    (folder / "experiment.toml").write_text(EXPERIMENT.format(**sensors) + records)
