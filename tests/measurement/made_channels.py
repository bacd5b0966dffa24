"""Channels of one record made by hand, as the checks get them."""

import numpy as np

from teleopdesign.measurement.channel import Channel
from teleopdesign.measurement.record import Record
from teleopdesign.measurement.soundness.signal import Signal

H = 1e-3
UNITS = {"position": "m", "velocity": "m/s"}


def record_of(n, segments=None):
    whole = segments or (slice(0, n),)
    return Record("a.csv", "fit", frozenset(), H * np.arange(n), H, whole, {})


def channel(values, quantity="position", *, step=0.0, name=None, segments=None, **more):
    """A channel of one record as the checks get it."""
    unit = more.pop("unit", UNITS.get(quantity, "N"))
    described = {"resolution": None, "noise": None, **more}
    made = Channel(quantity, "device", "x", described.pop("written", unit), **described)
    y = np.asarray(values, dtype=float)
    return Signal(name or quantity, unit, made, record_of(len(y), segments), y, step)


def swing(n=2000, size=1.0):
    return size * np.sin(2 * np.pi * 1.3 * H * np.arange(n) + 0.3)
