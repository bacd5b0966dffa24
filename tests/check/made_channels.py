"""Channels of one record made by hand, and what the checks say of them."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from teleopdesign.base.units import si_factor
from teleopdesign.check import CHECKS, CheckedRecording, look_at
from teleopdesign.check._recording import Signal
from teleopdesign.measurement.channel import Channel
from teleopdesign.measurement.conversion import Conversion
from teleopdesign.measurement.experiment import Experiment
from teleopdesign.measurement.record import Record

H = 1e-3
UNITS = {"position": "m", "velocity": "m/s"}


def record_of(n, segments=None):
    whole = segments or (slice(0, n),)
    return Record("a.csv", "fit", frozenset(), H * np.arange(n), H, whole, {})


def channel(values, quantity="position", *, step=0.0, name=None, segments=None, **more):
    """A channel of one record as the checks get it."""
    unit = more.pop("unit", UNITS.get(quantity, "N"))
    described = {"resolution": None, "noise": None, **more}
    written = described.pop("written", unit)
    if written != unit:  # of a prismatic axis
        kind = "force" if quantity.endswith("force") else quantity
        factor = si_factor(written, quantity=kind)
        described["conversion"] = Conversion(("x",), (1.0,), factor=factor)
    made = Channel(quantity, "device", "x", written, **described)
    y = np.asarray(values, dtype=float)
    return Signal(name or quantity, unit, made, record_of(len(y), segments), y, step)


def swing(n=2000, size=1.0):
    return size * np.sin(2 * np.pi * 1.3 * H * np.arange(n) + 0.3)


def ask(check, experiment, topic=None):
    """What one check of the list says of an experiment."""
    findings = CHECKS[check].find(look_at(experiment))
    return [f for f in findings if topic in (None, f.topic)]


def ask_of_channels(check, channels, topic=None, words=""):
    """What one check says of a record with these channels alone, of the first of them."""
    record = channels[0].record
    experiment = Experiment(Path("nowhere"), "made", {}, None, {}, None, (record,))
    recording = CheckedRecording(experiment)
    vars(recording)["signals"] = tuple(replace(c, record=record) for c in channels)
    return [
        f
        for f in CHECKS[check].find(recording)
        if topic in (None, f.topic)
        and words in f.sentence
        and f.sentence.startswith(channels[0].name)
    ]


def outliers(signal):
    return ask_of_channels("outliers", [signal], "outliers")


def leaps(signal):
    return ask_of_channels("outliers", [signal], "jumps")


def flat(signal, topic="stuck channels"):
    return ask_of_channels("flat_channels", [signal], topic)


def clipped(signal):
    return flat(signal, "clipped channels")


def repeated(signal):
    return ask_of_channels("held_samples", [signal], words="repeat the sample before")


def slower(signal):
    return ask_of_channels("held_samples", [signal], words="changes only every")


def hums(signal, *others):
    return ask_of_channels("force_readings", [signal, *others], "hum")


def strange_velocity(position, velocity):
    return ask_of_channels("velocity", [velocity, position])


def ask_of_record(check, record):
    """What one check says of a record without channels."""
    experiment = Experiment(Path("nowhere"), "made", {}, None, {}, None, (record,))
    return list(CHECKS[check].find(CheckedRecording(experiment)))


def interruptions(record):
    return [f for f in ask_of_record("log_reading", record) if f.topic == "gaps"]


def clock_errors(record):
    return ask_of_record("sample_clock", record)
