"""A device whose inertia is cancelled late, and the hand that holds it; an example."""

from __future__ import annotations

from typing import Any

import control
import numpy as np
import sympy as sp

from teleopdesign.blocks import Body, Value
from teleopdesign.controllers import from_control
from teleopdesign.diagrams import Diagram, haptic_interface
from teleopdesign.effects import EFFECTS
from teleopdesign.frequency import matrix_response
from teleopdesign.simulate import simulate, sine

INERTIA, DAMPING = 0.15, 1.0  # of the device, kg and N s/m
_GRID = np.geomspace(0.05, 1000.0, 20001)  # Hz, of the loop gain
_AMPLITUDE = 1e-3  # m
_LOSSLESS = 1e-9  # N s/m; damping so small that it is only a name


def hand(inertia: float, damping: float, stiffness: float) -> Body:
    """kg, N s/m, N/m"""
    body = Body("prismatic", {"inertia": Value(inertia)})
    body = body.with_effect(EFFECTS["viscous"], {"damping": damping})
    return body.with_effect(EFFECTS["spring"], {"stiffness": stiffness})


HANDS = {"hand": hand(0.2, 4.0, 300.0), "fingertip": hand(0.02, 0.5, 100.0)}


def pole(bandwidth: float) -> float:
    """1/s, for a bandwidth in Hz."""
    return 2 * np.pi * bandwidth


def law(share: float, bandwidth: float) -> control.TransferFunction:
    """C without its delay: share m s^2/(T s + 1)^2."""
    t = 1 / pole(bandwidth)
    return control.tf([share * INERTIA, 0, 0], [t**2, 2 * t, 1])


def device(share: float, *, bandwidth: float, delay: float, hand: Body | None = None) -> Diagram:
    """The device with that share of its inertia cancelled, all commands late by the delay (s)."""
    body = Body("prismatic", {"inertia": Value(INERTIA)})
    body = body.with_effect(EFFECTS["viscous"], {"damping": DAMPING})
    body = body.with_effect(EFFECTS["actuation_delay"], {"delay": delay})
    c = control.ss(law(share or 1.0, bandwidth))  # 0 would have another order
    if not share:
        c = control.ss(c.A, c.B, 0 * c.C, 0 * c.D)
    return haptic_interface(body, hand=hand, cancellation=from_control(c), analog=("C",))


def sampled_law(bandwidth: float, period: float) -> sp.Expr:
    """H(z) of all the inertia: minus m times a low-passed difference, twice; inf: not low-passed.

    The low-pass is exact for an input that is held; its pole is the decimal printed here.
    """
    z = sp.Symbol("z")
    kept = 0.0 if np.isinf(bandwidth) else round(float(np.exp(-pole(bandwidth) * period)), 12)
    a = sp.Rational(str(kept))
    rate = (1 - a) * (z - 1) / (sp.Rational(str(period)) * (z - a))
    return -sp.Rational(str(INERTIA)) * rate**2


def stable_share(hand: Body, *, bandwidth: float, delay: float) -> float:
    """Largest share that is stable with this hand: where the loop gain first reaches 1.

    The delay is exact. The loop is stable without the cancellation, and its gain grows with the
    share: it stays stable up to the first frequency at which a positive real gain is 1.
    """
    opened = device(1.0, bandwidth=bandwidth, delay=delay, hand=hand).open_at("C")
    moved = matrix_response(opened, ["L"], ["R_MBC"], _GRID).data.values[:, 0, 0]
    gain = law(1.0, bandwidth)(2j * np.pi * _GRID) * moved
    turn = np.flatnonzero(np.diff(np.sign(gain.imag)))
    weight = gain.imag[turn] / (gain.imag[turn] - gain.imag[turn + 1])
    crossing = gain.real[turn] + weight * (gain.real[turn + 1] - gain.real[turn])
    return float(1 / crossing.max(initial=1e-12))


def worst_hand(share: float, *, bandwidth: float, delay: float) -> Body:
    """The lossless hand that resonates with the device where this takes most damping away."""
    s = 2j * np.pi * _GRID
    felt = INERTIA * s + DAMPING - law(share, bandwidth)(s) / s * np.exp(-s * delay)
    k = int(np.argmin(felt.real))
    w, reactance = abs(s[k]), felt[k].imag
    if reactance > 0:
        return hand(1e-9, _LOSSLESS, reactance * w)
    return hand(-reactance / w, _LOSSLESS, 1e-9)


def growth(share: float, *, bandwidth: float, delay: float, hand: Body | None) -> float:
    """Rate (1/s) at which free motion grows from a push; hand: None is the worst one."""
    held = hand or worst_hand(share, bandwidth=bandwidth, delay=delay)
    diagram = device(share, bandwidth=bandwidth, delay=delay, hand=held)
    motion = simulate(diagram, duration=6.0, initial={"L_velocity": 0.01}, computer="continuous")
    speed = motion["L_velocity"].values
    half, tail = speed[len(speed) // 3 : 2 * len(speed) // 3], speed[2 * len(speed) // 3 :]
    return float(np.log(np.sqrt(np.mean(tail**2) / np.mean(half**2))) / 2.0)


def simulated_damping(share: float, frequency: float, *, bandwidth: float, delay: float) -> float:
    """Negative damping (N s/m) of the cancellation along a prescribed sinusoid (Hz), simulated."""
    count = max(round(0.1 * frequency), 1)  # cycles after the low-pass has settled
    transient = np.ceil(0.1 * frequency) / frequency
    simulation: Any = simulate(
        device(share, bandwidth=bandwidth, delay=delay),
        duration=transient + count / frequency,
        motion={"L": sine(amplitude=_AMPLITUDE, frequency=frequency)},
        computer="continuous",
        every_step=True,
    )
    steps = round(count / frequency / float(simulation["time"][1] - simulation["time"][0]))
    force, speed = (simulation[name].values[-steps:] for name in ("R_V", "L_velocity"))
    return float(DAMPING - np.mean(force * speed) / np.mean(speed**2))
