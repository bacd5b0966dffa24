"""A simulator of haptic devices that shares nothing with the package under test.

One or two bodies, each with friction, actuator, transmission, hand and contact effects, under a
sampled controller.  Splitting scheme of second order: half a kick of all velocities (midpoint
rule), a drift of the positions with the bristle, lag and memory states advanced exactly, and half
a kick again.  The exact bristle step

    z <- s L/sigma + (z - s L/sigma) exp(-sigma |dx| / L),   s = sgn(dx)

is stable at any speed, so that Coulomb friction can be a bristle too stiff for an encoder to see.

Signs: inertia * acceleration = acting + hand + contact force - friction - other effects.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

NAMES = (
    "inertia", "damping", "damping_difference", "drag", "level", "half_difference",
    "extra_static_level", "stribeck_velocity", "bristle_stiffness", "bristle_damping",
    "load_coefficient", "drift_fraction", "drift_time", "memory_time", "level_wave",
    "level_wave_period", "level_wave_phase", "bias", "spring", "hardening", "cogging",
    "cogging_period", "cogging_phase", "has_tip", "tip_inertia", "tip_stiffness", "tip_damping",
    "gap", "delay", "lag", "limit", "gain", "ripple", "ripple_period", "ripple_phase",
    "has_hand", "hand_mass", "grip_stiffness", "grip_damping", "arm_stiffness", "arm_damping",
    "has_contact", "contact_stiffness", "contact_position", "contact_damping", "contact_power",
    "hum", "hum_frequency", "hum_phase", "place_damping", "slow_force", "slow_frequency",
    "resolution", "grid_offset", "kp", "kd", "derivative_weight", "command_step",
    "gravity", "gravity_phase", "thinning", "thinning_power",
    "tip_level", "tip_bristle", "slip_k1", "slip_k2", "slip_k3", "slip_k4", "slip_w2", "slip_w3",
    "slip_w4", "rub", "rub_place", "rub_width",
)  # fmt: skip
INDEX = {n: i for i, n in enumerate(NAMES)}
DEFAULTS = dict(
    inertia=1.0,
    stribeck_velocity=1.0,
    bristle_stiffness=1.0,
    drift_time=1.0,
    level_wave_period=1.0,
    cogging_period=1.0,
    ripple_period=1.0,
    gain=1.0,
    limit=math.inf,
    contact_power=1.0,
    rub_width=1.0,
    derivative_weight=0.5,
)
(
    M, B, BD, D, FC, HD, FS, VS, SIG, SIG1, MU, DRF, DRT, MEM, EW, EP, EF, BIAS, K, K3, CA, CP, CF,
    TIP, TM, TK, TB, GAP, DEL, LAG, LIM, GAIN, RA, RP, RF, HAND, HM, GK, GB, AK, AB,
    ENV, EK, EX, EB, EN, HUM, HUF, HUP, PD, SLO, SLF, RES, OFF, KP, KD, DW, UQ,
    GR, GRP, TH, THN, TFC, TSIG, SK1, SK2, SK3, SK4, SW2, SW3, SW4, RUB, RUX, RUW,
) = range(len(NAMES))  # fmt: skip
TWO_PI = 2.0 * math.pi
COLUMNS = ("x", "v", "friction", "acting", "interaction", "x_tip", "v_tip", "z", "contact")


def body(**values: float) -> np.ndarray:
    """Parameter vector of one body; what is not named is absent."""
    p = np.zeros(len(NAMES))
    for name, value in {**DEFAULTS, **values}.items():
        p[INDEX[name]] = value
    return p


@njit(cache=True)
def _level(p, x, t, acting, w, s):
    """Friction level; w is the speed (or its memory), s the direction of motion."""
    level = p[FC]
    if p[EW] != 0.0:
        level *= 1.0 + p[EW] * math.sin(TWO_PI * x / p[EP] + p[EF])
    if p[DRF] != 0.0:
        level *= 1.0 - p[DRF] * (1.0 - math.exp(-t / p[DRT]))
    level += p[HD] * s + p[MU] * abs(acting)
    if p[RUB] != 0.0:  # a zone that rubs more, or less
        level += p[RUB] * math.exp(-(((x - p[RUX]) / p[RUW]) ** 2))
    if p[FS] != 0.0:
        level += p[FS] * math.exp(-((w / p[VS]) ** 2))
    return max(level, 0.0)


@njit(cache=True)
def _acting(p, x, u):
    g = p[GAIN]
    if p[RA] != 0.0:
        g *= 1.0 + p[RA] * math.sin(TWO_PI * x / p[RP] + p[RF])
    return min(max(g * u, -p[LIM]), p[LIM])


@njit(cache=True)
def _friction(p, level, v, z):
    if level <= 0.0:
        return 0.0
    f = p[SIG] * z
    return f + p[SIG1] * (v - abs(v) * f / level)


@njit(cache=True)
def _slipping(p, s, level, dx):
    """Springs in parallel, each held at its own slip force: stretched by dx, then let slip."""
    room = max(level - p[SW2] - p[SW3] - p[SW4], 0.0)
    for i in range(4):
        most = room if i == 0 else p[SW2 + i - 1]
        s[10 + i] = min(max(s[10 + i] + p[SK1 + i] * dx, -most), most)


@njit(cache=True)
def _contact(p, x, v):
    depth = x - p[EX]
    if p[ENV] == 0.0 or depth <= 0.0:
        return 0.0
    elastic = p[EK] * depth if p[EN] == 1.0 else p[EK] * depth ** p[EN]
    return -max(elastic + p[EB] * v, 0.0)


@njit(cache=True)
def _coupling(p, dx, dv):
    """Force of the transmission on the tip."""
    g = 0.5 * p[GAP]
    if dx > g:
        return p[TK] * (dx - g) + p[TB] * dv
    if dx < -g:
        return p[TK] * (dx + g) + p[TB] * dv
    if p[GAP] == 0.0:
        return p[TB] * dv
    return 0.0


@njit(cache=True)
def _forces(p, s, level, acting, place, hand_x, hand_v, direct, out):
    """Accelerations of body, tip and hand; s: x v z lag w x_tip v_tip x_hand v_hand."""
    v = s[1]
    rubs = s[10] + s[11] + s[12] + s[13] if p[SK1] > 0.0 else _friction(p, level, v, s[2])
    total = acting - place - rubs
    total -= v * (p[B] + p[D] * abs(v) + p[PD] * s[0] * s[0]) + p[BD] * abs(v)
    if p[TH] != 0.0:
        total -= math.copysign(p[TH] * abs(v) ** p[THN], v)
    tip = p[TIP] != 0.0
    xc = s[5] if tip else s[0]
    vc = s[6] if tip else v
    grip = 0.0
    out[2] = 0.0
    if p[HAND] != 0.0:
        grip = p[GK] * (s[7] - xc) + p[GB] * (s[8] - vc)
        arm = p[AK] * (hand_x - s[7]) + p[AB] * (hand_v - s[8])
        out[2] = (arm - grip) / p[HM]
    interaction = grip + direct
    contact = _contact(p, xc, vc)
    if tip:
        c = _coupling(p, s[0] - s[5], v - s[6])
        rub = 0.0
        if p[TFC] > 0.0:  # a hard bristle at the tip, well damped while it sticks
            f = p[TSIG] * s[9]
            slip = s[6] - abs(s[6]) * f / p[TFC]
            rub = f + 0.3 * math.sqrt(p[TSIG] * p[TM]) * slip
        out[0] = (total - c) / p[M]
        out[1] = (interaction + contact + c - rub) / p[TM]
    else:
        out[0] = (total + interaction + contact) / p[M]
        out[1] = 0.0
    out[3] = interaction
    out[4] = contact


@njit(cache=True)
def _place(p, x, t):
    f = p[BIAS] + p[K] * x + p[K3] * x * x * x
    if p[GR] != 0.0:  # a weight on a lever that turns through one turn in 2 pi
        f += p[GR] * math.sin(x + p[GRP])
    if p[CA] != 0.0:
        f += p[CA] * math.sin(TWO_PI * x / p[CP] + p[CF])
    if p[HUM] != 0.0:
        f -= p[HUM] * math.sin(TWO_PI * p[HUF] * t + p[HUP])
    if p[SLO] != 0.0:
        f += p[SLO] * math.sin(TWO_PI * p[SLF] * t)
    return f


@njit(cache=True)
def _kick(p, s, t, dt, hand_x, hand_v, direct, a, b):
    acting = _acting(p, s[0], s[3])
    place = _place(p, s[0], t)
    w = s[4] if p[MEM] > 0.0 else abs(s[1])
    sign = 1.0 if s[1] > 0.0 else (-1.0 if s[1] < 0.0 else 0.0)
    level = _level(p, s[0], t, acting, w, sign)
    _forces(p, s, level, acting, place, hand_x, hand_v, direct, a)
    v0, v1, v2 = s[1], s[6], s[8]
    s[1] = v0 + 0.5 * dt * a[0]
    s[6] = v1 + 0.5 * dt * a[1]
    s[8] = v2 + 0.5 * dt * a[2]
    _forces(p, s, level, acting, place, hand_x, hand_v, direct, b)
    s[1] = v0 + dt * b[0]
    s[6] = v1 + dt * b[1]
    s[8] = v2 + dt * b[2]


@njit(cache=True)
def _drift(p, s, t, dt, u):
    """Positions, bristle, lag (towards the command u) and memory over dt."""
    v = s[1]
    dx = v * dt
    speed = abs(v)
    if p[MEM] > 0.0:
        e = math.exp(-dt / p[MEM])
        w = speed + (s[4] - speed) * math.exp(-0.5 * dt / p[MEM])
        s[4] = speed + (s[4] - speed) * e
    else:
        w = speed
        s[4] = speed
    if p[LAG] > 0.0:
        e = math.exp(-0.5 * dt / p[LAG])
        middle = u + (s[3] - u) * e
        s[3] = u + (middle - u) * e
    else:
        middle = u
        s[3] = u
    x = s[0] + 0.5 * dx
    if dx != 0.0:
        sign = 1.0 if dx > 0.0 else -1.0
        level = _level(p, x, t + 0.5 * dt, _acting(p, x, middle), w, sign)
        if level > 0.0:
            bend = sign * level / p[SIG]
            s[2] = bend + (s[2] - bend) * math.exp(-p[SIG] * abs(dx) / level)
            if p[SK1] > 0.0:
                _slipping(p, s, level, dx)
        else:
            s[2] = 0.0
    s[0] += dx
    s[5] += s[6] * dt
    if p[TFC] > 0.0 and s[6] != 0.0:
        bend = math.copysign(p[TFC] / p[TSIG], s[6])
        s[9] = bend + (s[9] - bend) * math.exp(-p[TSIG] * abs(s[6] * dt) / p[TFC])
    s[7] += s[8] * dt


@njit(cache=True)
def _held(u, i, t, dt, period):
    """Average over [t, t + dt] of the held command of body i (0 before the first row)."""
    a = t / period + 1e-9
    b = (t + dt) / period - 1e-9
    k, m = math.floor(a), math.floor(b)
    last = u.shape[0] - 1
    first = 0.0 if k < 0 else u[min(k, last), i]
    if m <= k:
        return first
    second = 0.0 if m < 0 else u[min(m, last), i]
    part = (m * period - t) / dt
    return part * first + (1.0 - part) * second


@njit(cache=True)
def _run(P, start, period, inner, sub, open_loop, mirrored, ref, ref_v, feed, hand, hand_v, direct):
    n, nb = feed.shape
    s = start.copy()
    u = np.zeros((n, nb))
    enc = np.zeros((n, nb))
    out = np.zeros((n * sub, nb, 9))
    est = np.zeros(nb)
    a, b = np.zeros(5), np.zeros(5)
    h = period / inner
    every = inner // sub
    for k in range(n):
        for i in range(nb):
            p = P[i]
            q = s[i, 0]
            if p[RES] > 0.0:
                q = p[RES] * round((q - p[OFF]) / p[RES])
            enc[k, i] = q
            if k > 0:
                est[i] += p[DW] * ((q - enc[k - 1, i]) / period - est[i])
        for i in range(nb):
            p = P[i]
            c = feed[k, i]
            if not open_loop:
                tx, tv = ref[k, i], ref_v[k, i]
                if mirrored:
                    tx += enc[k, 1 - i]
                    tv += est[1 - i]
                c += p[KP] * (tx - enc[k, i]) + p[KD] * (tv - est[i])
            if p[UQ] > 0.0:
                c = p[UQ] * round(c / p[UQ])
            u[k, i] = c
        k1 = min(k + 1, n - 1)
        for j in range(inner):
            t = (k * inner + j) * h
            for i in range(nb):
                p = P[i]
                w0 = j / inner
                w1 = (j + 1) / inner
                x0 = hand[k, i] + w0 * (hand[k1, i] - hand[k, i])
                v0 = hand_v[k, i] + w0 * (hand_v[k1, i] - hand_v[k, i])
                d0 = direct[k, i] + w0 * (direct[k1, i] - direct[k, i])
                now = _held(u, i, t - p[DEL], h, period)
                if p[LAG] <= 0.0:
                    s[i, 3] = now
                if j % every == 0:
                    w = s[i, 4] if p[MEM] > 0.0 else abs(s[i, 1])
                    sg = 1.0 if s[i, 1] > 0.0 else (-1.0 if s[i, 1] < 0.0 else 0.0)
                    act = _acting(p, s[i, 0], s[i, 3])
                    lev = _level(p, s[i, 0], t, act, w, sg)
                    _forces(p, s[i], lev, act, _place(p, s[i, 0], t), x0, v0, d0, a)
                    o = out[k * sub + j // every, i]
                    o[0], o[1], o[2] = s[i, 0], s[i, 1], _friction(p, lev, s[i, 1], s[i, 2])
                    o[3], o[4], o[5], o[6] = act, a[3], s[i, 5], s[i, 6]
                    o[7], o[8] = s[i, 2], a[4]
                _kick(p, s[i], t, 0.5 * h, x0, v0, d0, a, b)
                _drift(p, s[i], t, h, now)
                x1 = hand[k, i] + w1 * (hand[k1, i] - hand[k, i])
                v1 = hand_v[k, i] + w1 * (hand_v[k1, i] - hand_v[k, i])
                d1 = direct[k, i] + w1 * (direct[k1, i] - direct[k, i])
                _kick(p, s[i], t + h, 0.5 * h, x1, v1, d1, a, b)
    return u, enc, out


@dataclass
class Drive:
    """What moves the machine, a row a sample and a column a body; missing parts are zero."""

    reference: np.ndarray
    reference_velocity: np.ndarray
    feedforward: np.ndarray
    hand: np.ndarray
    hand_velocity: np.ndarray
    direct: np.ndarray

    @classmethod
    def zero(cls, samples: int, bodies: int = 1) -> Drive:
        return cls(*(np.zeros((samples, bodies)) for _ in range(6)))


@dataclass
class Motion:
    """A simulated run: commands and encoder readings a row, the true signals `sub` times a row."""

    period: float
    sub: int
    command: np.ndarray
    encoder: np.ndarray
    fine: np.ndarray

    def __getitem__(self, name: str) -> np.ndarray:
        """True signal on the fine grid, (rows * sub, bodies)."""
        return self.fine[:, :, COLUMNS.index(name)]

    def rows(self, name: str) -> np.ndarray:
        return self[name][:: self.sub]


def simulate(
    parameters: list[np.ndarray],
    drive: Drive,
    rate: float = 1000.0,
    inner: int | None = None,
    sub: int = 5,
    open_loop: bool = False,
    start: np.ndarray | None = None,
) -> Motion:
    """Run the machine; inner: steps a row (default: of 20 us); two bodies follow each other."""
    p = np.array(parameters)
    if inner is None:
        inner = sub * max(1, math.ceil(5e4 / rate / sub))
    if inner % sub:
        raise ValueError(f"inner ({inner}) must be a multiple of sub ({sub})")
    s = np.zeros((len(p), 14)) if start is None else np.array(start, float)
    u, enc, out = _run(
        p, s, 1.0 / rate, inner, sub, open_loop, len(p) == 2, drive.reference,
        drive.reference_velocity, drive.feedforward, drive.hand, drive.hand_velocity, drive.direct,
    )  # fmt: skip
    if not np.isfinite(out).all():
        raise FloatingPointError("the simulation diverged")
    return Motion(1.0 / rate, sub, u, enc, out)
