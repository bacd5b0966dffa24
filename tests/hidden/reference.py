"""Reference figures of a case, from the true simulated motion.

What is approximate: the force a *wrong* model needs is found along the true motion (5 points a
row), not along the measured one, and encoder and sensor errors enter linearly, through the
inertia and the damping. So the errors that noise makes in the sign of a friction near a reversal
are left out; the floor is a little lower than any real method can reach. A model with the true
effects leaves the drawn noise and nothing else. A stuck body (the encoder moves by less than a
step in 20 ms) has whatever friction balances it, up to the level.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.optimize import least_squares
from scipy.signal import butter, lfilter, sosfiltfilt
from truth_simulator import Motion

Parameters = dict[str, float]


def lowpass(y: np.ndarray, cutoff: float, rate: float) -> np.ndarray:
    """4th-order Butterworth run forward and backward."""
    sos = butter(4, min(cutoff, 0.45 * rate), fs=rate, output="sos")
    pad = min(int(0.6 * rate), len(y) - 2)
    return sosfiltfilt(sos, y, padtype="odd", padlen=pad)


@njit(cache=True)
def _bristle(dx, level, sigma, viscous, out):
    """viscous: damping of the bristle over the time between two points."""
    z = 0.0
    for k in range(len(dx)):
        lev = level[k]
        if lev > 0.0 and dx[k] != 0.0:
            g = math.copysign(lev / sigma, dx[k])
            before = z
            z = g + (z - g) * math.exp(-sigma * abs(dx[k]) / lev)
            out[k] = viscous * (z - before)
        else:
            out[k] = 0.0
        out[k] = sigma * z + out[k] if lev > 0.0 else 0.0


def triangle(fine: np.ndarray, sub: int) -> np.ndarray:
    """Averages of a fine signal about each row, with the weight that a second difference has."""
    e = (np.arange(sub + 1) / sub) ** 2 / 2
    w = np.concatenate([np.diff(e), np.diff(e)[::-1]])
    padded = np.concatenate([np.full(sub, fine[0]), fine])
    full = np.convolve(padded, w[::-1] / w.sum(), mode="valid")
    out = full[::sub]
    n = len(fine) // sub
    return np.concatenate([out, np.full(max(0, n - len(out)), out[-1])])[:n]


def middle(fine: np.ndarray) -> np.ndarray:
    """Averages over the fine intervals of a signal given at their starts."""
    return 0.5 * (fine + np.append(fine[1:], fine[-1]))


@dataclass
class Track:
    """One body in one record, true and measured."""

    motion: Motion
    index: int
    resolution: float
    noise: float
    sensed: np.ndarray  # interaction force as measured; zeros where it is no channel
    position: np.ndarray  # encoder position as measured
    has_sensor: bool
    bandwidth: float

    def __post_init__(self) -> None:
        m, i = self.motion, self.index
        self.rate = 1 / m.period
        x = m["x"][:, i]
        self.x = x
        self.dx = np.append(np.diff(x), 0.0)
        self.v_fine = m["v"][:, i]
        self.rows_x = x[:: m.sub]
        self.acceleration = self._second(self.rows_x)
        self.command = m.command[:, i]
        self.stuck = self._stuck()
        cumulated = np.concatenate([[0.0], np.cumsum(self.command) * m.period])
        self._integral = cumulated
        self._last: tuple[float, np.ndarray] | None = None
        self.true_sensor = m.rows("interaction")[:, i] if self.has_sensor else 0 * self.rows_x
        self.noise_x = self.position - self.rows_x
        self.scale = lowpass(self.command + self.sensed, self.bandwidth, self.rate)

    def _second(self, y: np.ndarray) -> np.ndarray:
        out = np.zeros_like(y)
        out[1:-1] = np.diff(y, 2) * self.rate**2
        return out

    def _stuck(self) -> np.ndarray:
        """Rows where the encoder moves less than a step in 20 ms."""
        w = max(2, int(0.010 * self.rate))
        padded = np.pad(self.rows_x, w, mode="edge")
        view = np.lib.stride_tricks.sliding_window_view(padded, 2 * w + 1)
        still = np.ptp(view, axis=1) < self.resolution
        return np.convolve(still, np.ones(2 * w + 1), mode="same") > 0.5

    def _late(self, delay: float) -> np.ndarray:
        """The command later by the delay, averages over the fine intervals; the last is kept."""
        if self._last is None or self._last[0] != delay:
            dt = self.motion.period / self.motion.sub
            t = np.arange(len(self.x) + 1) * dt - delay
            rows = np.arange(len(self._integral)) * self.motion.period
            self._last = delay, np.diff(np.interp(t, rows, self._integral)) / dt
        return self._last[1]

    def acting(self, p: Parameters) -> np.ndarray:
        """Acting force on the fine grid, averages over the fine intervals."""
        dt = self.motion.period / self.motion.sub
        u = self._late(p.get("delay", 0.0))
        lag = p.get("lag", 0.0)
        if lag > 0:
            e = math.exp(-dt / lag)
            state = np.append(0.0, lfilter([1 - e], [1, -e], u))[:-1]
            u = u + (state - u) * (lag / dt) * (1 - e)
        u = u * p.get("gain", 1.0)
        if p.get("ripple", 0.0):
            u = u * (
                1
                + p["ripple"] * np.sin(2 * np.pi * self.x / p["ripple_period"] + p["ripple_phase"])
            )
        return np.clip(u, -p["limit"], p["limit"]) if "limit" in p else u

    def residual(self, p: Parameters, noisy: bool = True) -> np.ndarray:
        """Low-passed force residual of the model p."""
        sub = self.motion.sub
        v, x = self.v_fine, self.x
        u = self.acting(p)
        level = np.full(len(x), p.get("level", 0.0))
        if p.get("level_wave"):
            level *= 1 + p["level_wave"] * np.sin(
                2 * np.pi * x / p["level_wave_period"] + p["level_wave_phase"]
            )
        if p.get("drift_fraction"):
            t = np.arange(len(x)) * self.motion.period / sub
            level *= 1 - p["drift_fraction"] * (1 - np.exp(-t / p["drift_time"]))
        if p.get("half_difference"):
            level += p["half_difference"] * np.sign(v)
        if p.get("load_coefficient"):
            level += p["load_coefficient"] * np.abs(u)
        if p.get("extra_static_level"):
            level += p["extra_static_level"] * np.exp(-((v / p["stribeck_velocity"]) ** 2))
        level = np.maximum(level, 0.0)
        soft = p.get("presliding", 0.0)
        friction = np.empty_like(x)
        viscous = p.get("bristle_damping", 0.0) * sub / self.motion.period if soft else 0.0
        _bristle(self.dx, level, soft or p["bristle_stiffness"], viscous, friction)
        force = v * p.get("damping", 0.0)  # terms that are zero cost the time of those that are not
        if p.get("drag"):
            force = v * (p.get("damping", 0.0) + p["drag"] * np.abs(v))
        if p.get("damping_difference"):
            force = force + p["damping_difference"] * np.abs(v)
        force = force + p.get("bias", 0.0)
        if p.get("spring"):
            force = force + p["spring"] * x
        if p.get("hardening"):
            force = force + p["hardening"] * x**3
        if p.get("thinning"):
            force = force + p["thinning"] * np.sign(v) * np.abs(v) ** p["thinning_power"]
        if p.get("gravity"):
            force = force + p["gravity"] * np.sin(x + p["gravity_phase"])
        if p.get("cogging"):
            force = force + p["cogging"] * np.sin(
                2 * np.pi * x / p["cogging_period"] + p["cogging_phase"]
            )
        if p.get("contact_stiffness"):
            depth = np.maximum(x - p["contact_position"], 0.0)
            c = p["contact_stiffness"] * depth ** p.get("contact_power", 1.0)
            c = c + p.get("contact_damping", 0.0) * v * (depth > 0)
            force = force + np.maximum(c, 0.0) * (depth > 0)
        inertia = p["inertia"] + p.get("added_inertia", 0.0)
        rest = triangle(u - middle(force), sub) + self.true_sensor - inertia * self.acceleration
        friction = triangle(middle(friction), sub)
        if not soft:
            top = triangle(level, sub)
            friction = np.where(self.stuck, np.clip(rest, -top, top), friction)
        r = rest - friction
        if noisy:
            sensed = np.where(
                self.stuck & (p.get("level", 0.0) > 0), 0.0, self.sensed - self.true_sensor
            )
            r = r + sensed - inertia * self._second(self.noise_x)
            r = r - p.get("damping", 0.0) * np.gradient(self.noise_x) * self.rate
        return lowpass(r, self.bandwidth, self.rate)

    def noise_only(self, p: Parameters, rng: np.random.Generator | None = None) -> np.ndarray:
        """Low-passed residual of the right model: the drawn errors, or others drawn anew."""
        e, f = self.noise_x, self.sensed - self.true_sensor
        if rng is not None:
            off = rng.uniform(-0.5, 0.5) * self.resolution
            e = self.resolution * np.round((self.rows_x - off) / self.resolution) - self.rows_x
            f = rng.normal(0, self.noise, len(e)) if self.has_sensor else 0 * e
        f = np.where(self.stuck & (p.get("level", 0.0) > 0), 0.0, f)
        inertia = p["inertia"] + p.get("added_inertia", 0.0)
        r = f - inertia * self._second(e) - p.get("damping", 0.0) * np.gradient(e) * self.rate
        return lowpass(r, self.bandwidth, self.rate)

    def inside(self, y: np.ndarray) -> np.ndarray:
        k = int(0.25 * self.rate)
        return y[k:-k]


def figure(tracks: list[Track], residuals: list[np.ndarray]) -> float:
    """rms of the residuals over rms of what was measured, all bodies together."""
    top = sum(np.sum(t.inside(r) ** 2) for t, r in zip(tracks, residuals, strict=False))
    low = sum(np.sum(t.inside(t.scale) ** 2) for t in tracks)
    return float(math.sqrt(top / low))


def refit(track: Track, start: Parameters, free: list[str], steps: int = 8) -> Parameters:
    """Free parameters re-estimated on this body's fit record, in at most so many steps."""
    scale = np.array([max(abs(start[n]), 1e-9) for n in free])
    step = max(1, int(track.rate / (5 * track.bandwidth)))

    def cost(q: np.ndarray) -> np.ndarray:
        p = start | dict(zip(free, (q * scale).tolist(), strict=False))
        return track.inside(track.residual(p))[::step]

    signed = {
        "bias",
        "half_difference",
        "damping_difference",
        "cogging_phase",
        "spring",
        "gravity_phase",
    }
    low = [-np.inf if n in signed else 1e-3 for n in free]
    q0 = np.array([start[n] for n in free]) / scale
    q = least_squares(
        cost, np.maximum(q0, low), bounds=(low, np.inf), diff_step=1e-4, max_nfev=steps
    ).x
    return start | dict(zip(free, (q * scale).tolist(), strict=False))
