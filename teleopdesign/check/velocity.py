"""A velocity channel against the position that it belongs to: time shift and factor.

The velocity channel w is compared with the derivative of the position, v(t - shift), after the same
low-pass: w = factor (v - shift dv/dt), solved again about each new shift. A velocity takes no part
in a comparison, but it shows whether clock and units of the position are as stated.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..base.finding import Finding
from ..measurement.filtering import Array, spectrum
from ..measurement.limits import HALF
from ._recording import ENOUGH, CheckedRecording, RecordingCheck, Signal

#: iterations of the shift; each leaves an error of about the square of the one before, in periods
STEPS = 4
#: bandwidth of the comparison of both signals, as a part of the sample rate
BAND = 0.05
#: factor beyond which units or clock are doubted
FACTOR = 1.05
#: relative difference of a factor from that of a slip of units within which it is this slip
NEAR = 0.03
#: axis (None: each), factor over the derivative of the position, and what is in which unit then
SLIPS = (
    (None, 1e3, "time", "ms"),
    (None, 1e6, "time", "us"),
    ("prismatic", 1e-3, "position", "mm"),
    ("prismatic", 1e3, "velocity", "mm/s"),
    ("revolute", 2 * math.pi, "position", "turns"),
    ("revolute", math.pi / 180, "position", "deg"),
    ("revolute", 180 / math.pi, "velocity", "deg/s"),
    ("revolute", 30 / math.pi, "velocity", "rpm"),
)


def find_strange_velocities(recording: CheckedRecording) -> Iterator[Finding]:
    """Velocity channels that are late, in another unit, or no velocity of their position."""
    for velocity in recording.signals:
        if velocity.quantity == "velocity":
            for position in recording.beside(velocity):
                if (position.quantity, position.channel.body) == (
                    "position",
                    velocity.channel.body,
                ):
                    yield from check_velocity(position, velocity)


CHECK = RecordingCheck(order=80, find=find_strange_velocities)


def check_velocity(position: Signal, velocity: Signal) -> Iterator[Finding]:
    """Compare the velocity channel of a body with its position."""
    h, rows = position.record.sample_time, position.record.longest
    rows = slice(rows.start, min(rows.stop, rows.start + ENOUGH))
    x, v = position.values[rows], velocity.values[rows]
    if np.ptp(x) == 0 or np.ptp(v) == 0:
        return
    shift, factor, left = shift_and_factor(x, v, h)
    numbers = {"shift": shift, "factor": factor, "left": left}
    if left > HALF:
        words = " does not follow the position's derivative: one of the two is something else."
        yield velocity.finding("velocity", "warning", words, numbers)
        return
    if not 1 / FACTOR < factor < FACTOR:
        cause = factor_cause(factor, position, velocity)
        words = f" is {factor:.4g} times the derivative of {position.name}: {cause}."
        yield velocity.finding("velocity", "warning", words, numbers)
    if abs(shift) > h:
        words = (
            f" {'lags' if shift > 0 else 'leads'} {position.name} by {1e3 * abs(shift):.3g} ms: it "
            "is filtered or late (a velocity takes no part in comparisons)."
        )
        yield velocity.finding("velocity", "note", words, numbers)


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
        if factor == 0.0 or abs(both / factor) > HALF * len(position) * sample_time:
            break
        shift += both / factor
    return float(shift), float(factor), left


def factor_cause(factor: float, position: Signal, velocity: Signal) -> str:
    """Probable causes of a factor between velocity and derivative of position, with remedies."""
    places = {"time": "time", "position": position.name, "velocity": velocity.name}
    causes = [
        f'the {what} is in {unit}: write unit = "{unit}" at channels.{places[what]}'
        for axis, slip, what, unit in SLIPS
        if axis in (None, position.axis) and abs(abs(factor) / slip - 1.0) < NEAR
    ]
    if factor < 0:
        causes.append(f"one of the two is turned: write sign = -1 at channels.{velocity.name}")
    return " or ".join(causes) if causes else "units, sign or clock disagree"
