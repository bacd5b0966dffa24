"""Six machines with their exact motion: piecewise closed forms, or events located to rounding.

Each function takes SI values and returns columns over `times`. Nothing here knows the package: laws
are written out as in the papers, friction positive against the motion.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, exp, floor, sin, sqrt

import numpy as np
from exact.events import integrate
from scipy.optimize import brentq


@dataclass(frozen=True)
class Bristle:
    """A mass on a bristle (Dahl, LuGre): its level is level + extra exp(-(v/v_S)^2)."""

    mass: float = 0.5
    level: float = 1.0
    extra: float = 0.0
    stribeck_velocity: float = 0.01
    stiffness: float = 1e5
    bristle_damping: float = 0.0
    viscous: float = 0.5
    ramp: float = 0.0
    amplitude: float = 2.5
    frequency: float = 3.0

    def force(self, t):
        """From outside on the mass, N: a ramp and a sinusoid."""
        return self.ramp * t + self.amplitude * np.sin(2 * np.pi * self.frequency * t)

    def friction(self, v, z, sign):
        level = self.level + self.extra * np.exp(-((v / self.stribeck_velocity) ** 2))
        bristle_rate = v - self.stiffness / level * sign * v * z
        return self.stiffness * z + self.bristle_damping * bristle_rate, bristle_rate

    def motion(self, times, force=None, *, spring=0.0):
        """Position, velocity and friction force from rest under force(t), N: default its own."""
        force = self.force if force is None else force

        def rate(t, y, signs):
            x, v, z = y
            friction, bristle_rate = self.friction(v, z, signs[0])
            a = (force(t) - spring * x - friction - self.viscous * v) / self.mass
            return v, a, bristle_rate

        bristle_length = (self.level + self.extra) / self.stiffness
        first = 1 if force(1e-6) >= 0 else -1
        y = integrate(
            rate,
            [lambda t, y: y[1]],
            start=[0.0, 0.0, 0.0],
            mode=[first],
            times=times,
            sizes=[1e-2, 1e-1, bristle_length],
        )
        x, v, z = y.T
        return {"x": x, "v": v, "friction": self.friction(v, z, np.sign(v))[0]}


@dataclass(frozen=True)
class Belt:
    """Stick-slip: a mass on a spring, on a belt that runs at constant speed."""

    body: Bristle = replace(Bristle(), extra=0.6, viscous=0.2, mass=1.0)
    spring: float = 400.0
    speed: float = 0.02

    def force(self, t):
        """On the mass in the frame of the belt, N: the spring's end runs away."""
        return -self.spring * self.speed * t

    def motion(self, times):
        """In the frame of the belt; on the ground the mass is at x + speed t."""
        return self.body.motion(times, self.force, spring=self.spring)


@dataclass(frozen=True)
class Stroke:
    """Dahl's friction along a motion of two sinusoids, large loops with small ones inside."""

    level: float = 1.0
    stiffness: float = 1e5
    large: float = 0.01
    small: float = 0.004
    slow: float = 6.0
    fast: float = 21.0

    def position(self, t):
        return self.large * np.sin(self.slow * t) + self.small * np.sin(self.fast * t)

    def velocity(self, t):
        slow = self.large * self.slow * np.cos(self.slow * t)
        return slow + self.small * self.fast * np.cos(self.fast * t)

    def acceleration(self, t):
        slow = self.large * self.slow**2 * np.sin(self.slow * t)
        return -slow - self.small * self.fast**2 * np.sin(self.fast * t)

    def motion(self, times):
        """The friction force at the times, each turn of the motion located."""
        fine = np.linspace(times[0], times[-1], 20 * len(times))
        signs = np.sign(self.velocity(fine))
        turns = [
            brentq(self.velocity, fine[i], fine[i + 1], xtol=1e-15)
            for i in np.flatnonzero(np.diff(signs))
        ]
        grid = np.unique(np.concatenate([times, turns]))
        friction = dahl_along(
            self.position(grid),
            list(np.searchsorted(grid, turns)),
            level=self.level,
            stiffness=self.stiffness,
        )
        return {"friction": friction[np.searchsorted(grid, times)]}


def dahl_along(position, turns, *, level, stiffness):
    """Dahl's friction along positions (n,), turning at indices `turns`: closed form per stroke."""
    out, f = np.empty(len(position)), 0.0
    for begin, end in zip([0, *turns], [*turns, len(position) - 1], strict=True):
        stroke = position[begin : end + 1] - position[begin]
        sign = np.sign(stroke[-1])
        out[begin : end + 1] = sign * level + (f - sign * level) * np.exp(
            -stiffness * np.abs(stroke) / level
        )
        f = out[end]
    return out


@dataclass(frozen=True)
class Gap:
    """Two masses with lost motion: a sinusoidal force on the first, viscous friction on it too."""

    first: float = 0.3
    second: float = 0.2
    gap: float = 1e-3
    stiffness: float = 2e3
    damping: float = 0.0
    viscous: float = 2.0
    amplitude: float = 3.0
    frequency: float = 3.0

    def drive(self, t):
        """On the first mass, N."""
        return self.amplitude * np.sin(2 * np.pi * self.frequency * t)

    def coupling(self, stretch, rate, signs):
        """The force between the two; signs: of the stretch over and under the gap."""
        over, under = signs
        spring = self.stiffness * (
            np.where(over > 0, stretch - self.gap / 2, 0.0)
            + np.where(under < 0, stretch + self.gap / 2, 0.0)
        )
        return spring + self.damping * rate * ((np.asarray(over) > 0) | (np.asarray(under) < 0))

    def motion(self, times):
        """Positions x, tip and the force between them, from rest in the middle of the gap."""

        def rate(t, y, signs):
            x, v, x_t, v_t = y
            f = self.coupling(x - x_t, v - v_t, signs)
            return v, (self.drive(t) - f - self.viscous * v) / self.first, v_t, f / self.second

        y = integrate(
            rate,
            [
                lambda t, y: y[0] - y[2] - self.gap / 2,
                lambda t, y: y[0] - y[2] + self.gap / 2,
            ],
            start=[0.0] * 4,
            mode=[-1, 1],
            times=times,
            sizes=[1e-2, 1e-1, 1e-2, 1e-1],
        )
        x, v, x_t, v_t = y.T
        d = x - x_t
        signs = (np.sign(d - self.gap / 2), np.sign(d + self.gap / 2))
        return {"x": x, "tip": x_t, "force": self.coupling(d, v - v_t, signs)}


@dataclass(frozen=True)
class Relay:
    """A computer that pushes with sgn(travel over the last sample) on a mass, spring and damper.

    It reads the position in encoder steps; its command is held until the next one.
    """

    mass: float = 0.4
    spring: float = 150.0
    viscous: float = 1.5
    level: float = 0.3
    period: float = 1e-3
    encoder_step: float = 1e-5
    start: float = 0.004

    def motion(self, samples):
        """Position at each sample, the command made there, and how near readings were to a flip."""
        decay = self.viscous / (2 * self.mass)
        omega = sqrt(self.spring / self.mass - decay**2)
        c, s = cos(omega * self.period), sin(omega * self.period)
        shrink = exp(-decay * self.period)
        x, v, last = self.start, 0.0, None
        columns = np.empty((samples + 1, 3))
        for n in range(samples + 1):
            steps = x / self.encoder_step + 0.5
            reading = floor(steps)
            sign = 0 if last is None else (reading > last) - (reading < last)
            last = reading
            margin = abs(steps - round(steps))
            command = self.level * sign
            columns[n] = x, command, margin
            rest = command / self.spring  # where the spring balances the held command
            u = x - rest
            x = rest + shrink * (u * c + (v + decay * u) / omega * s)
            v = shrink * (v * c - (omega * u + decay * (v + decay * u) / omega) * s)
        return {"x": columns[:, 0], "command": columns[:, 1], "margin": columns[:, 2]}


@dataclass(frozen=True)
class LateSpring:
    """A mass on a spring whose force comes late: m x''(t) = K (x_d - x(t - delay)), x_d a step.

    By the method of steps: on each stretch of one delay x is a polynomial, integrated exactly.
    """

    mass: float = 0.5
    stiffness: float = 80.0
    delay: float = 5e-3
    step: float = 0.01

    def motion(self, times):
        """Position and the force that is commanded, from rest."""
        d, out = self.delay, np.empty(len(times))
        number = np.minimum(np.floor(times / d * (1 + 1e-12)).astype(int), int(times[-1] / d))
        # coefficients of ((t - n d) / d)^k, lowest first; before t = 0 no force is on its way
        x, v, last = 0.0, 0.0, None
        for n in range(int(number.max()) + 1):
            force = np.zeros(1) if last is None else -self.stiffness * last
            if last is not None:
                force[0] += self.stiffness * self.step
            powers = np.arange(1, len(force) + 1)
            bend = force * d**2 / self.mass / (powers * (powers + 1))
            here = np.concatenate([[x, v * d], bend])
            mine = number == n
            s = times[mine] / d - n
            out[mine] = np.polynomial.polynomial.polyval(s, here)
            x = float(here.sum())
            v = float((here * np.arange(len(here))).sum()) / d
            # terms of high order fall as 1/k!: below this they are no longer rounding of the first
            last = here[: max(int(np.flatnonzero(np.abs(here) > 1e-40).max(initial=0)) + 1, 1)]
        return {"x": out, "force": self.stiffness * (self.step - out)}
