"""A haptic interface with a computer, simulated in numpy alone: no code of the package.

    R_A = R_D + H (R_D - R_M) + C L        (m + m_H) a = R_A - friction - B v - b v - k x - ...
    R_D = K (L_D - L)                      where there is a position loop, a lead
    R_M = m_H a + b v + k x + ...          the hand is relaxed, R_V = 0

The computer reads encoder and force sensor each millisecond, just before its command changes. H is
a gain that falls with speed and a low-pass behind it, C a smoothed Coulomb cancellation. Dry
friction is stepped as by Moreau: it brings the body to rest within a step where it can.
"""

import gzip
from dataclasses import dataclass, field

import numpy as np

PERIOD, INNER = 1e-3, 10
DT = PERIOD / INNER
TOML = """
[diagram]
kind = "haptic interface"
[blocks.Z_M]
axis = "prismatic"
inertia = {{ value = {m_stated}, unit = "kg" }}
[blocks.Z_M.effects.coulomb]
level = {{ value = {level_stated}, unit = "N" }}
[blocks.Z_M.effects.viscous]
damping = {{ value = {damping_stated}, unit = "N*s/m" }}
[blocks.Z_H]
axis = "prismatic"
inertia = {{ value = {m_hand_stated}, unit = "kg" }}
[blocks.Z_H.effects.viscous]
damping = {{ value = {b_hand_stated}, unit = "N*s/m" }}
[blocks.Z_H.effects.spring]
stiffness = {{ value = {k_hand_stated}, unit = "N/m" }}
[blocks.C]
law = "smoothed_coulomb"
parameters = {{ level = {c_level}, smoothing_velocity = {c_velocity} }}
[blocks.H]
[[blocks.H.series]]
law = "velocity_schedule"
parameters = {{ gain = {h_gain}, scheduling_velocity = {h_velocity} }}
[[blocks.H.series]]
law = "low_pass"
parameters = {{ bandwidth = {h_bandwidth} }}
"""
LOOP = """[blocks.K]
law = "lead"
parameters = {{ gain = {k_gain}, zero = {k_zero}, pole = {k_pole} }}
"""
EXPERIMENT = """
title = "simulated interface"
[diagram]
file = "interface.toml"
sample_period = {{ value = 1, unit = "ms" }}
[diagram.outside]
"R_V" = 0
[channels]
time = {{ column = "t", unit = "s" }}
"R_A" = {{ column = "r_a", unit = "N", resolution = {converter} }}
"L" = {{ column = "x", unit = "m", resolution = {encoder} }}
"R_M" = {{ column = "f_h", unit = "N", noise = {noise} }}
"R_D" = {{ column = "r_d", unit = "N" }}
[comparison]
bandwidth = {{ value = 60, unit = "Hz" }}
[[records]]
file = "fit.csv.gz"
use = "fit"
[[records]]
file = "check.csv.gz"
use = "check"
"""


@dataclass
class Interface:
    """Values (SI) of one interface; `hidden`: (effect, place) -> value, what the file lacks.

    loop: a position loop K makes the desired force
    """

    values: dict
    hidden: dict = field(default_factory=dict)
    converter: float = 0.004
    encoder: float = 1e-6
    noise: float = 0.015
    loop: bool = False


def draw_interface(random):
    """An interface with values of table-top devices."""
    u = random.uniform
    return Interface(
        {
            "m": u(0.1, 0.4), "level": u(0.25, 0.9), "damping": u(0.5, 2.5),
            "m_hand": u(0.06, 0.18), "b_hand": u(2.0, 5.0), "k_hand": u(200, 380),
            "c_level": u(0.2, 0.6), "c_velocity": u(0.012, 0.022),
            "h_gain": u(1.7, 3.4), "h_velocity": u(0.05, 0.12), "h_bandwidth": u(11, 20),
            "k_gain": u(80, 150), "k_zero": u(15, 30), "k_pole": u(100, 200),
        }
    )  # fmt: skip


class Delayed:
    """Samples kept for whole rows."""

    def __init__(self, rows):
        self.rows = [0.0] * round(rows)

    def __call__(self, sample):
        self.rows.append(sample)
        return self.rows.pop(0)


class Output:
    """What acts behind a block, in the order gain, bias, lag, delay, dead zone, saturation."""

    def __init__(self, hidden, at):
        self.has = {name: value for (name, place), value in hidden.items() if place == at}
        self.kept, self.late = 0.0, Delayed(self.has.get("delay", 0.0) / PERIOD)

    def __call__(self, y):
        y = self.has.get("gain", 1.0) * y + self.has.get("bias", 0.0)
        if "lag" in self.has:
            y, fresh = self.kept, y
            self.kept += (1 - np.exp(-PERIOD / self.has["lag"])) * (fresh - self.kept)
        y = self.late(y)
        width, limit = self.has.get("dead_zone", 0.0), self.has.get("saturation", np.inf)
        y = np.sign(y) * max(abs(y) - width, 0.0)
        return min(max(y, -limit), limit)


class Velocity:
    """Difference of two readings, through the filter that a block hides."""

    def __init__(self, hidden, at):
        constant = hidden.get(("velocity_filter", at), 0.0)
        self.keeps = np.exp(-PERIOD / constant) if constant else 0.0
        self.value = 0.0

    def __call__(self, v):
        self.value = self.keeps * self.value + (1 - self.keeps) * v
        return self.value


def record(interface, duration, random):
    """Columns t, r_a, x, f_h, r_d, and l_d with a position loop, of one recording from rest."""
    p, hidden = interface.values, interface.hidden
    n = round(duration / PERIOD)
    time = np.arange(n) * PERIOD
    desired = _desired(time, random)
    reference = 0.01 * desired
    out = np.zeros((4, n))
    h_out, c_out, k_out, whole = (Output(hidden, at) for at in ("H", "C", "K", "computer"))
    h_velocity, c_velocity = Velocity(hidden, "H"), Velocity(hidden, "C")
    x = v = low = last = command = memory = 0.0
    blend = 1 - np.exp(-2 * np.pi * p["h_bandwidth"] * PERIOD)
    forgets = 1 - np.exp(-p["k_pole"] * PERIOD)
    for i in range(n):
        reading = np.floor(x / interface.encoder + 0.5) * interface.encoder
        force = _force(p, hidden, x, v, command)
        force += interface.noise * random.standard_normal()
        speed = (reading - last) / PERIOD if i else 0.0
        last = reading
        if interface.loop:
            error = reference[i] - reading
            desired[i] = k_out(p["k_gain"] * (error + memory))
            memory += forgets * ((p["k_zero"] / p["k_pole"] - 1.0) * error - memory)
        feedback = h_out(low)
        slow = p["h_velocity"] / (p["h_velocity"] + abs(h_velocity(speed)))
        low += blend * (p["h_gain"] * slow * (desired[i] - force) - low)
        known = c_velocity(speed)
        cancel = c_out(p["c_level"] * known / (p["c_velocity"] + abs(known)))
        command = whole(desired[i] + feedback + cancel)
        out[:, i] = command, reading, force, desired[i]
        for _ in range(INNER):
            faster = v + DT * _acceleration(p, hidden, x, v, command)
            x, v = x + 0.5 * DT * (v + faster), faster
    command = np.round(out[0] / interface.converter) * interface.converter
    columns = {"t": time, "r_a": command, "x": out[1], "f_h": out[2], "r_d": out[3]}
    return columns | ({"l_d": reference} if interface.loop else {})


def _hand(p, hidden, x, v):
    """Force of the hand without its inertia, positive against the motion."""
    stiff = hidden.get(("hardening_spring", "Z_H"), 0.0)
    uneven = hidden.get(("viscous_asymmetry", "Z_H"), 0.0)
    return p["k_hand"] * x + stiff * x**3 + p["b_hand"] * v + uneven * abs(v)


def _force(p, hidden, x, v, command):
    """Force of the device on the hand."""
    return _hand(p, hidden, x, v) + p["m_hand"] * _acceleration(p, hidden, x, v, command)


def _acceleration(p, hidden, x, v, command):
    """Acceleration of device and hand, which are one body, with dry friction."""
    mass, level = p["m"] + p["m_hand"], p["level"]
    free = command - p["damping"] * v - _hand(p, hidden, x, v)
    free -= hidden.get(("quadratic_drag", "Z_M"), 0.0) * v * abs(v)
    free -= hidden.get(("bias", "Z_M"), 0.0)
    if ("stribeck", "Z_M") in hidden:
        level += hidden["stribeck", "Z_M"] * np.exp(-((v / 0.012) ** 2))
    wanted = mass * v / DT + free  # force that would bring the body to rest within the step
    return (free - min(max(wanted, -level), level)) / mass


def _desired(time, random):
    """Multisine below 6 Hz with slow steps, a few newton."""
    signal = np.zeros_like(time)
    for frequency in random.uniform(0.3, 6.0, 8):
        signal += random.uniform(0.3, 0.9) * np.sin(
            2 * np.pi * (frequency * time + random.uniform())
        )
    steps = np.repeat(random.uniform(-1.5, 1.5, len(time) // 700 + 1), 700)[: len(time)]
    return (signal + steps) * np.minimum(time / 0.3, 1.0)


def write_case(interface, folder, random, durations=(11.0, 8.0)):
    """The folder of an experiment, with stated values of bodies that are a few percent off."""
    write_logs(folder, [record(interface, duration, random) for duration in durations])
    values = interface.values
    names = ("m", "level", "damping", "m_hand", "b_hand", "k_hand")
    stated = {f"{n}_stated": values[n] * random.uniform(0.85, 1.15) for n in names}
    blocks = TOML + (LOOP if interface.loop else "")
    (folder / "interface.toml").write_text(blocks.format(**values, **stated))
    sensors = {n: getattr(interface, n) for n in ("converter", "encoder", "noise")}
    text = EXPERIMENT.format(**sensors)
    if interface.loop:
        reference = '"L_D" = { column = "l_d", unit = "m" }\n'
        text = text.replace("[comparison]", reference + "[comparison]")
    (folder / "experiment.toml").write_text(text)


def leave_out(folder, signal):
    """Take a channel out of an experiment."""
    lines = (folder / "experiment.toml").read_text().splitlines()
    kept = [line for line in lines if not line.startswith(f'"{signal}" =')]
    (folder / "experiment.toml").write_text("\n".join(kept))


def write_logs(folder, logs):
    """The columns of the logs as fit.csv.gz and check.csv.gz."""
    folder.mkdir(parents=True, exist_ok=True)
    for use, columns in zip(("fit", "check"), logs, strict=True):
        with gzip.open(folder / f"{use}.csv.gz", "wt") as file:
            file.write(",".join(columns) + "\n")
            for row in zip(*columns.values(), strict=True):
                file.write(",".join(f"{value:.7g}" for value in row) + "\n")
