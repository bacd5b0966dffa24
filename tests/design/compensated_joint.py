"""A joint that a hand moves, compensated, in code that shares none of the package.

    J dv/dt = u(t - T) gain(x) + hand - forces(x, v) - level(x, v) sgn v

The joint sticks while the rest of the forces stays below the level. The hand pulls by a spring and
a damper from a place that it wants. Each millisecond a computer reads an encoder, filters the
difference and commands the cancellation C and the force feedback H; the command acts T later.
C and H are computed from the numbers of a design's file, by formulas of this file.
"""

from dataclasses import dataclass, field
from math import copysign, exp, pi, sin

import numpy as np

PERIOD, INNER = 1e-3, 10
STEP = 2 * pi / 20000  # rad, of the encoder
HAND = 8.0, 0.25  # N*m/rad and N*m*s/rad
HAND_NOISE = 0.003  # N*m


def force_of(effects, x, v):
    """Forces of place and speed, N*m, positive where they hold the joint back."""
    total = 0.0
    for name, p in effects.items():
        if name == "viscous":
            total += p["damping"] * v
        elif name == "viscous_asymmetry":
            total += p["half_difference"] * abs(v)
        elif name == "quadratic_drag":
            total += p["drag"] * v * abs(v)
        elif name == "cogging":
            total += p["amplitude"] * sin(2 * pi * x / p["period"] + p["phase"])
        elif name == "gravity":
            total += p["amplitude"] * sin(x + p["phase"])
        elif name == "spring":
            total += p["stiffness"] * x
        elif name == "hardening_spring":
            total += p["stiffness"] * (x - p.get("neutral", 0.0)) ** 3
        elif name == "bias":
            total += p["force"]
    return total


def level_of(effects, x, v, way, load):
    """Level of friction, N*m; way: -1 to 1;  load: force that acts, N*m."""
    level = effects.get("coulomb", {"level": 0.0})["level"]
    for name, p in effects.items():
        if name == "stribeck":
            level += p["extra_static_level"] * exp(-((v / p["stribeck_velocity"]) ** 2))
        elif name == "coulomb_asymmetry":
            level += p["half_difference"] * way
        elif name == "load_dependent_friction":
            level += p["coefficient"] * abs(load)
    if "position_dependent_friction" in effects:
        p = effects["position_dependent_friction"]
        level *= 1 + p["amplitude"] * sin(2 * pi * x / p["period"] + p["phase"])
    return level


def gain_of(effects, x):
    """Acting force per commanded force."""
    p = effects.get("torque_ripple", {"amplitude": 0.0, "period": 1.0, "phase": 0.0})
    ripple = 1 + p["amplitude"] * sin(2 * pi * x / p["period"] + p["phase"])
    return ripple * effects.get("actuator_gain", {"gain": 1.0})["gain"]


@dataclass
class Compensation:
    """C and H of a design, as numbers: law -> parameters, in the order of the stages of H.

    velocity_bandwidth: Hz;  late: periods from a sample to the change of the command
    """

    cancellation: dict = field(default_factory=dict)
    force_feedback: dict = field(default_factory=dict)
    velocity_bandwidth: float = 50.0
    late: int = 1

    def start(self, reading):
        self.before, self.speed, self.bristle, self.low = reading, 0.0, 0.0, 0.0

    def command(self, reading, hand):
        """The command at one pass, N*m."""
        travel = reading - self.before
        self.before = reading
        part = 1 - exp(-2 * pi * self.velocity_bandwidth * PERIOD)
        self.speed += part * (travel / PERIOD - self.speed)
        fed = self._fed(hand) if self.force_feedback else 0.0
        return fed + self._cancelled(reading, travel, fed)

    def _fed(self, hand):
        value = hand
        for law, p in self.force_feedback.items():
            if law == "velocity_schedule":
                width = p["scheduling_velocity"]
                value *= p["gain"] * width / (width + abs(self.speed))
            elif law == "low_pass":
                self.low += (1 - exp(-2 * pi * p["bandwidth"] * PERIOD)) * (value - self.low)
                value = self.low
            else:
                raise NotImplementedError(law)
        return value

    def _bristle(self, travel, level, stiffness):
        if travel and level > 0:
            end = copysign(level / stiffness, travel)
            self.bristle = end + (self.bristle - end) * exp(-stiffness * abs(travel) / level)
        return stiffness * self.bristle

    def _cancelled(self, reading, travel, fed):
        total, v = 0.0, self.speed
        for law, p in self.cancellation.items():
            if law == "dahl":
                total += self._bristle(travel, p["level"], p["stiffness"])
            elif law == "smoothed_coulomb":
                total += p["level"] * v / (p["smoothing_velocity"] + abs(v))
            elif law == "cancel":
                total += self._of_effects(p, reading - p.get("zero", 0.0), travel, fed)
            else:
                raise NotImplementedError(law)
        return total

    def _of_effects(self, numbers, x, travel, fed):
        effects, v = {}, self.speed
        for name, value in numbers.items():
            if "." in name:
                effect, parameter = name.split(".")
                effects.setdefault(effect, {})[parameter] = value
        smooth = numbers.get("smoothing_velocity")
        way = float(np.sign(v)) if smooth is None else v / (smooth + abs(v))
        if "presliding" in effects and smooth is None:
            level = level_of(effects, x, v, float(np.sign(travel)), fed)
            friction = self._bristle(travel, level, effects["presliding"]["stiffness"])
        else:
            friction = level_of(effects, x, v, way, fed) * way
        return (fed + force_of(effects, x, v) + friction) / gain_of(effects, x) - fed


def compensation_of(design, *, case):
    """The compensation of one body of a design's file, switched on as the case says."""
    made = {}
    for part in ("cancellation", "force_feedback"):
        laws = {law: {} for law in design[part]["laws"]} if design[part] else {}
        for name, one in design[part]["parameters"].items() if design[part] else ():
            law, parameter = name.split(".", 1)
            laws[law][parameter] = one["value"]
        made[part] = laws
    if case == "MBC":
        made["force_feedback"] = {}
    late = round(design["assumptions"]["delay"] / PERIOD)
    return Compensation(**made, velocity_bandwidth=design["assumptions"]["velocity_bandwidth"],
                        late=late)  # fmt: skip


def wanted_place(random, t):
    """A slow and a fast motion, rad."""
    a, b, c = random.uniform([0.7, 0.2, 0.04], [1.1, 0.35, 0.08])
    f = random.uniform([0.2, 0.6, 1.8], [0.3, 0.9, 2.6])
    p = random.uniform(0, 2 * pi, 3)
    waves = zip((a, b, c), f, p, strict=True)
    return sum(size * np.sin(2 * pi * hertz * t + phase) for size, hertz, phase in waves)


class Follower:
    """The controller of a recording without compensation: the joint follows a motion of its own."""

    late = 1

    def __init__(self, wanted):
        self.wanted, self.row, self.slow = wanted, 0, 0.0

    def start(self, reading):
        self.before = reading

    def command(self, reading, hand):
        self.slow += 0.2 * ((reading - self.before) / PERIOD - self.slow)
        self.before = reading
        k = self.row = min(self.row + 1, len(self.wanted) - 1)
        speed = (self.wanted[k] - self.wanted[k - 1]) / PERIOD
        return float(np.clip(12 * (self.wanted[k] - reading) + 0.3 * (speed - self.slow), -5, 5))


def record(inertia, effects, computer, seconds, random, *, pushes=None):
    """t (s), q (rad), u and hand (N*m), each (n,), at the passes of the computer.

    pushes: force of the hand over time, (n,); None: it leads the joint by a spring
    """
    n = round(seconds / PERIOD)
    t = np.arange(n) * PERIOD
    place = wanted_place(random, t)
    pace = np.gradient(place, PERIOD)
    noise = HAND_NOISE * random.standard_normal(n)
    x, v, step = float(place[0]), 0.0, PERIOD / INNER
    computer.start(STEP * round(x / STEP))
    line = [0.0] * (computer.late + 1)
    read, commands, hands = np.empty(n), np.empty(n), np.empty(n)
    felt = 0.0
    for k in range(n):
        read[k] = STEP * round(x / STEP)
        commands[k] = computer.command(read[k], felt)
        line = [commands[k], *line[:-1]]
        for i in range(INNER):
            acting = line[computer.late] * gain_of(effects, x)
            if pushes is None:
                hand = HAND[0] * (place[k] + i * step * pace[k] - x) + HAND[1] * (pace[k] - v)
            else:
                hand = float(pushes[k])
            if i == 0:
                hands[k] = hand
            push = acting + hand - force_of(effects, x, v)
            way = copysign(1.0, v or push)
            level = level_of(effects, x, v, way, acting)
            if v == 0.0 and abs(push) <= level:
                continue
            after = v + step * (push - level * way) / inertia
            after = 0.0 if v * after < 0 else after
            x, v = x + 0.5 * step * (v + after), after
        felt = hands[k] + noise[k]
    return {"t": t, "q": read, "u": commands, "hand": hands + noise}


def record_without(inertia, effects, seconds, random):
    """A recording without compensation: the joint follows a motion while a hand pushes."""
    n = round(seconds / PERIOD)
    t = np.arange(n) * PERIOD
    f, p = random.uniform([0.3, 1.0], [0.6, 1.8]), random.uniform(0, 2 * pi, 2)
    pushes = 0.25 * np.sin(2 * pi * f[0] * t + p[0]) + 0.15 * np.sin(2 * pi * f[1] * t + p[1])
    follower = Follower(wanted_place(random, t))
    return record(inertia, effects, follower, seconds, random, pushes=pushes)
