"""A simulated rod whose records are poor in one way, by the simulator that shares nothing with the
package; it also runs what is proposed next.
"""

import math
from dataclasses import dataclass

import numpy as np
from truth_simulator import Drive, body, simulate

from teleopdesign.measurement import Record, load_experiment
from teleopdesign.next_experiment.prediction import CHECK, FIT

RATE = 1000.0
STEP = 2e-5
ROD = dict(inertia=0.15, level=0.5, damping=0.4)


@dataclass(frozen=True)
class Rod:
    """A device with true values of `truth_simulator.body`, under a servo with feedforward."""

    values: dict

    @property
    def parameters(self):
        v = {**ROD, **self.values}
        stiffness = v.get("bristle_stiffness") or v["level"] / (0.3 * STEP)
        if "bristle_stiffness" not in v:
            v["bristle_damping"] = 0.3 * math.sqrt(stiffness * v["inertia"])
        w = 2 * np.pi * 15
        v |= dict(resolution=STEP, kp=v["inertia"] * w**2, kd=1.4 * v["inertia"] * w)
        v["derivative_weight"] = 0.3  # the servo differences its encoder through 50 Hz
        return body(**{**v, "bristle_stiffness": stiffness, "command_step": 1e-4})

    def run(self, reference):
        """Commands and encoder readings (n,) while the servo follows positions (n,)."""
        velocity = np.gradient(reference) * RATE
        drive = Drive.zero(len(reference))
        drive.reference[:, 0], drive.reference_velocity[:, 0] = reference, velocity
        drive.feedforward[:, 0] = ROD["inertia"] * np.gradient(velocity) * RATE
        start = np.zeros((1, 9))
        start[0, 0] = start[0, 5] = start[0, 7] = reference[0]
        motion = simulate([self.parameters], drive, RATE, start=start)
        return motion.command[:, 0], motion.encoder[:, 0]

    def records(self, reference):
        """What the two runs of a proposed reference (n,) give; the second starts off the grid."""
        return tuple(
            self.record(reference + shift * STEP, file, use)
            for shift, file, use in ((0.0, FIT, "fit"), (0.37, CHECK, "check"))
        )

    def record(self, reference, file, use):
        command, position = self.run(reference)
        n = len(reference)
        return Record(
            file,
            use,
            "common",
            np.arange(n) / RATE,
            1 / RATE,
            (slice(0, n),),
            {"device.actuator_force": command, "device.position": position},
        )


def time_of(duration):
    return np.arange(0.0, duration, 1 / RATE)


def rounded(line, width=0.04):
    window = np.hanning(round(width * RATE) + 2)
    return np.convolve(np.pad(line, len(window), mode="edge"), window / window.sum(), mode="same")[
        len(window) : -len(window)
    ]


def shuttle(duration, *, speed, reach, rest=0.4):
    """Back and forth at one speed."""
    t = np.maximum(time_of(duration) - rest, 0.0)
    phase = (speed * t / reach) % 4.0
    line = np.where(phase < 1, phase, np.where(phase < 3, 2 - phase, phase - 4))
    return rounded(reach * line)


def swing(duration, *, amplitude, frequency, middle=0.0):
    """A sine of one amplitude and frequency about one place."""
    t = time_of(duration)
    rise = np.clip(t / 0.5, 0, 1) ** 2 * (3 - 2 * np.clip(t / 0.5, 0, 1))
    return middle + amplitude * rise * np.sin(2 * np.pi * frequency * t)


TOML = """title = "Rod with poor records"
[model.device]
axis = "prismatic"
inertia = {{ value = 0.15, unit = "kg", fixed = {fixed_inertia} }}
[model.device.effects]
{effects}
[channels]
time = {{ column = "clock", unit = "ms" }}
actuator_force = {{ column = "u", unit = "N" }}
position = {{ column = "place", unit = "mm", resolution = 2e-2 }}
[comparison]
bandwidth = {{ value = 50, unit = "Hz" }}
[[records]]
file = "fit.csv"
use = "fit"
[[records]]
file = "check.csv"
use = "check"
"""
COULOMB = 'coulomb = { level = { value = 0.5, unit = "N" } }\n'
KNOWN_COULOMB = 'coulomb = { level = { value = 0.5, unit = "N", fixed = true } }\n'
VISCOUS = 'viscous = { damping = { value = 0.4, unit = "N*s/m" } }\n'


def write_experiment(folder, rod, fit, check, effects, *, fixed_inertia=False):
    """An experiment with the records of these two references; returns it loaded."""
    folder.mkdir(parents=True, exist_ok=True)
    text = TOML.format(effects=effects, fixed_inertia=str(fixed_inertia).lower())
    (folder / "experiment.toml").write_text(text)
    for name, reference in (("fit", fit), ("check", check)):
        command, position = rod.run(reference)
        table = np.column_stack([1e3 * np.arange(len(command)) / RATE, command, 1e3 * position])
        np.savetxt(
            folder / f"{name}.csv",
            table,
            fmt=["%.4f", "%.4f", "%.6f"],
            delimiter=",",
            header="clock,u,place",
            comments="",
        )
    return load_experiment(folder)


@dataclass(frozen=True)
class Poor:
    """Records that are poor in one way, and the two effects that they hardly tell apart.

    truths: true values of a rod with the one and with the other;  wider: what the user allows the
    next motion, over what the records have shown
    """

    rivals: tuple
    truths: tuple
    fit: np.ndarray
    check: np.ndarray
    effects: str = COULOMB + VISCOUS
    wider: float = 1.0
    fixed_inertia: bool = False

    def experiment(self, folder, number):
        """The rod whose truth is the one or the other, and its experiment."""
        rod = Rod(self.truths[number])
        return rod, write_experiment(
            folder, rod, self.fit, self.check, self.effects, fixed_inertia=self.fixed_inertia
        )


POOR = {
    "one speed": Poor(
        ("viscous", "quadratic_drag"),
        (dict(damping=0.8), dict(damping=0.0, drag=8.0)),
        shuttle(12.0, speed=0.1, reach=0.05),
        shuttle(10.0, speed=0.1, reach=0.045),
        KNOWN_COULOMB,
    ),
    "one place": Poor(
        ("spring", "bias"),
        (dict(spring=10.0), dict(bias=0.4)),
        swing(10.0, amplitude=0.002, frequency=3.0, middle=0.04),
        swing(8.0, amplitude=0.0015, frequency=3.5, middle=0.04),
        wider=4.0,
    ),
    "no scale of force": Poor(
        ("added_inertia", "actuator_gain"),
        (dict(inertia=0.2), dict(gain=0.8)),
        swing(10.0, amplitude=0.01, frequency=3.0) + swing(10.0, amplitude=0.002, frequency=7.3),
        swing(8.0, amplitude=0.008, frequency=3.5) + swing(8.0, amplitude=0.002, frequency=6.1),
        fixed_inertia=True,
    ),
}
