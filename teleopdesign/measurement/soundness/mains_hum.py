"""Mains hum: a tone of 50 or 60 Hz in a force that no position shows."""

from __future__ import annotations

from collections.abc import Sequence

from ...base.finding import Finding
from ..hum import STRONG, hum_of
from .signal import Signal


def check_hum(signal: Signal, others: Sequence[Signal]) -> list[Finding]:
    """Report a force with a tone of the mains, in a record whose positions have none."""
    if not signal.channel.quantity.endswith("force"):
        return []
    rows = max(signal.record.segments, key=lambda s: s.stop - s.start)
    y = signal.values[rows]
    still = [o.values[rows] for o in others if o.channel.quantity == "position"]
    hum = hum_of(y, still, signal.record.sample_time)
    if hum is None:
        return []
    share = hum.rms / float(y.std())
    sentence = (
        f"{signal.name} has a tone of {hum.mains:g} Hz, {hum.rms:.3g} {signal.unit} rms "
        f"({100 * share:.2g} % of the channel), that no position shows: hum of the "
        "mains? A diagnosis takes it off; shield the wire, or compare below that frequency."
    )
    numbers = {"frequency": hum.mains, "rms": hum.rms}
    strong = share >= STRONG
    return [Finding("hum", "warning" if strong else "note", sentence, numbers, signal.record.file)]
