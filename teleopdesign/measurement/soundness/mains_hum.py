"""Hum of the mains: a tone of 50 or 60 Hz in a force that no position shows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...finding import Finding
from ...quantity import MAINS
from ..filtering import Array
from .signal import Signal

#: Hz to either side that tell what is usual there, and those within which the tone itself lies
AROUND, WITHIN = 10.0, 1.5
#: power of the tone over the median around: noise has 2^-300 of a chance, and a force that follows
#: a motion without that tone stays below some ten
TONE = 300.0
#: the same of a position: above, the body moves with that frequency, and the force may well
MOVES = 30.0
#: rms of the tone over that of the channel from which it is reported: a hundredth changed no answer
SHARE = 0.02
#: s: shorter records do not part the tone from what is beside it
SHORTEST = 2.0


def tone_at(y: Array, sample_time: float, frequency: float) -> tuple[float, float]:
    """Power of a tone over what is usual around it, and its rms, in the unit of y."""
    window = np.hanning(len(y))
    power = np.abs(np.fft.rfft((y - y.mean()) * window)) ** 2
    off = np.abs(np.fft.rfftfreq(len(y), sample_time) - frequency)
    usual = float(np.median(power[(off < AROUND) & (off > WITHIN)]))
    most = float(power[off <= WITHIN].max())
    if usual <= 0:
        return 0.0, 0.0
    return most / usual, float(np.sqrt(2 * most) / window.sum())


def check_hum(signal: Signal, others: Sequence[Signal]) -> list[Finding]:
    """A force with a tone of the mains, in a record whose positions have none."""
    if not signal.channel.quantity.endswith("force"):
        return []
    h = signal.record.sample_time
    rows = max(signal.record.segments, key=lambda s: s.stop - s.start)
    y = signal.values[rows]
    still = [o.values[rows] for o in others if o.channel.quantity == "position"]
    if len(y) * h < SHORTEST:
        return []
    for frequency in MAINS:
        if frequency + AROUND > 0.5 / h:
            continue
        over, rms = tone_at(y, h, frequency)
        if over < TONE or rms < SHARE * float(y.std()):
            continue
        if any(tone_at(x, h, frequency)[0] > MOVES for x in still):
            continue
        sentence = (
            f"{signal.name} has a tone of {frequency:g} Hz, {rms:.3g} {signal.unit} rms "
            f"({rms / float(y.std()):.0%} of the channel), that no position shows: hum of the "
            "mains? An answer may take it for a resonance: shield the wire, or compare below that "
            "frequency."
        )
        numbers = {"frequency": frequency, "rms": rms}
        return [Finding("hum", "warning", sentence, numbers, signal.record.file)]
    return []
