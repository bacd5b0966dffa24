"""Time shift and factor between a velocity channel and the position that it belongs to.

The velocity channel w is compared with the derivative of the position, v(t - shift), after the same
low-pass: w = factor (v - shift dv/dt), solved again about each new shift. A velocity takes no part
in a comparison, but it shows whether clock and units of the position are as stated.
"""

from __future__ import annotations

import math

import numpy as np

from ...base.finding import Finding
from ..filtering import Array, spectrum
from .signal import Signal

#: iterations of the shift; each leaves an error of about the square of the one before, in periods
STEPS = 4
#: bandwidth of the comparison of both signals, as a part of the sample rate
BAND = 0.05
#: factor beyond which units or clock are doubted
FACTOR = 1.05
#: relative difference of a factor from that of a slip of units within which it is this slip
NEAR = 0.03
#: samples of one stretch that are looked at
ENOUGH = 200_000


def shift_and_factor(
    position: Array, velocity: Array, sample_time: float
) -> tuple[float, float, float]:
    """Time (s) by which the velocity lags, factor, and relative rms of the unexplained rest.

    position, velocity: (n,) of one stretch;  sample_time: s
    """
    s = spectrum(len(position), sample_time)
    low = s.lowpass(BAND / sample_time)
    moved = s.transform(position) * low
    target = s.multiply(velocity, low)
    inside = slice(len(target) // 20, -max(1, len(target) // 20))
    target = target[inside]
    shift, factor, left = 0.0, 0.0, 1.0
    for _ in range(STEPS):
        late = moved * np.exp(-2j * np.pi * s.frequency * shift)
        first = s.back(late * s.derivative(1))[inside]
        second = s.back(late * s.derivative(2))[inside]
        columns = np.stack([first, -second], axis=1)
        (factor, both), *_ = np.linalg.lstsq(columns, target, rcond=None)
        rest = target - columns @ np.array([factor, both])
        left = float(np.sqrt(np.mean(rest**2) / max(float(np.mean(target**2)), 1e-300)))
        if factor == 0.0 or abs(both / factor) > 0.5 * len(position) * sample_time:
            break
        shift += both / factor
    return float(shift), float(factor), left


def factor_cause(factor: float, position: Signal, velocity: Signal) -> str:
    """Probable causes of a factor between velocity and derivative of position, with remedies."""
    size, turn, degree = abs(factor), 2 * math.pi, math.pi / 180
    place = f"channels.{position.name}"
    ways = {
        "the time is in ms": (1e3, 'write unit = "ms" at channels.time'),
        "the time is in us": (1e6, 'write unit = "us" at channels.time'),
    }
    if position.axis == "revolute":
        ways |= {
            "the position is in turns": (turn, f'write unit = "turns" at {place}'),
            "the position is in deg": (degree, f'write unit = "deg" at {place}'),
            "the velocity is in deg/s": (
                1 / degree,
                f'write unit = "deg/s" at channels.{velocity.name}',
            ),
            "the velocity is in rpm": (
                60 / turn,
                f'write unit = "rpm" at channels.{velocity.name}',
            ),
        }
    else:
        ways |= {
            "the position is in mm": (1e-3, f'write unit = "mm" at {place}'),
            "the velocity is in mm/s": (1e3, f'write unit = "mm/s" at channels.{velocity.name}'),
        }
    near = [f"{why}: {how}" for why, (f, how) in ways.items() if abs(size / f - 1.0) < NEAR]
    if factor < 0:
        near.append(f"one of the two is turned: write sign = -1 at channels.{velocity.name}")
    return " or ".join(near) if near else "units, sign or clock disagree"


def check_velocity(position: Signal, velocity: Signal) -> list[Finding]:
    """Compare the velocity channel of a body with its position."""
    h = position.record.sample_time
    rows = max(position.record.segments, key=lambda s: s.stop - s.start)
    rows = slice(rows.start, min(rows.stop, rows.start + ENOUGH))
    x, v = position.values[rows], velocity.values[rows]
    if np.ptp(x) == 0 or np.ptp(v) == 0:
        return []
    shift, factor, left = shift_and_factor(x, v, h)
    numbers = {"shift": shift, "factor": factor, "left": left}
    where = position.record.file
    if left > 0.5:
        text = "does not follow the position's derivative: one of the two is something else"
        return [Finding("time shift", "warning", f"{velocity.name} {text}.", numbers, where)]
    findings = []
    if not 1 / FACTOR < factor < FACTOR:
        text = f"is {factor:.4g} times the derivative of {position.name}: "
        cause = factor_cause(factor, position, velocity)
        findings.append(
            Finding("units", "warning", f"{velocity.name} {text}{cause}.", numbers, where)
        )
    if abs(shift) > h:
        way = "lags" if shift > 0 else "leads"
        findings.append(
            Finding(
                "time shift",
                "note",
                f"{velocity.name} {way} {position.name} by {1e3 * abs(shift):.3g} ms: it is "
                "filtered or late (a velocity takes no part in comparisons).",
                numbers,
                where,
            )
        )
    return findings
