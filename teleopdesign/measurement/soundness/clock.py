"""Sample clock: rate, rounding and jitter of the time stamps, and jitter that stamps do not show.

Reading a record already handles gaps, clocks that were set back and uneven stamps; this module
reports the remaining errors and their cost.
"""

from __future__ import annotations

import numpy as np

from ...base.errors import ExperimentError
from ...base.finding import Finding, Graph, Series
from ..channel import factor_of
from ..encoder import sampling_jitter
from ..experiment import Experiment
from ..filtering import Array
from ..record import Record
from ..tables import read_columns
from .signal import Signal

#: part of a sample time that stamps may be off and still count as uniform
UNIFORM = 0.01
#: part of a sample time that readings may be early or late and still count as in time
IN_TIME = 0.02
#: points of a graph
POINTS = 1000


def stamps_of(experiment: Experiment, record: Record) -> Array | None:
    """Time stamps of the record as written (n,), s; None: it has none, or its file is gone."""
    channel = experiment.channels.get("time")
    path = experiment.folder / record.file
    if channel is None or not path.is_file():
        return None
    try:
        columns = read_columns(path, record.file, {channel.column: "channels.time"})
    except ExperimentError:
        return None
    stamps = columns.values[channel.column] * factor_of(channel, experiment.bodies, "channels.time")
    return stamps if len(stamps) == len(record.time) and np.isfinite(stamps).all() else None


def check_clock(experiment: Experiment, record: Record, read: list[Signal]) -> list[Finding]:
    """Compare the stamps with the uniform time of the record, and positions with their speed.

    read: the channels of the record
    """
    h = record.sample_time
    findings = []
    # the reading steps describe the treatment of uneven stamps
    stamps = None if record.reading else stamps_of(experiment, record)
    off = np.zeros(1) if stamps is None else stamps - record.time
    rms = float(np.sqrt(np.mean(off**2)))
    numbers = {"rate": 1 / h, "jitter": rms, "worst": float(np.abs(off).max())}
    if rms > UNIFORM * h:
        some = slice(None, None, max(1, len(off) // POINTS))
        graph = Graph(
            "time (s)",
            "stamp less uniform time (ms)",
            (Series("stamps", record.time[some], 1e3 * off[some]),),
        )
        findings.append(
            Finding(
                "sample clock",
                "note" if rms < 5 * UNIFORM * h else "warning",
                f"the time stamps are {1e3 * rms:.3g} ms rms off a uniform clock of {1 / h:.6g} Hz "
                f"({100 * rms / h:.2g} % of a sample, {1e3 * numbers['worst']:.3g} ms at worst): "
                "the samples are used as if they were uniform.",
                numbers,
                record.file,
                graph,
            )
        )
    for signal in read:
        if signal.channel.quantity == "position":
            findings += _scatter(signal)
    return findings


def _scatter(signal: Signal) -> list[Finding]:
    h = signal.record.sample_time
    longest = max((x for _, x in signal.stretches), key=len)
    step = signal.channel.resolution or signal.step
    jitter = sampling_jitter(longest, step, h)
    if jitter < IN_TIME * h:
        return []
    speed = float(np.sqrt(np.mean((np.diff(longest) / h) ** 2)))
    return [
        Finding(
            "sample clock",
            "warning",
            f"{signal.name} scatters the more the faster it moves, as if its samples were taken "
            f"{1e3 * jitter:.2g} ms rms early or late ({100 * jitter / h:.2g} % of a sample), "
            f"{jitter * speed:.2g} {signal.unit} at its usual speed: compare at low frequency.",
            {"jitter": jitter, "part": jitter / h, "position": jitter * speed},
            signal.record.file,
        )
    ]


def clock_in_order(experiment: Experiment) -> Finding:
    """The finding for clocks without a flaw."""
    rates = sorted({1 / r.sample_time for r in experiment.records})
    rate = " and ".join(f"{r:.6g}" for r in rates)
    counted = "time" not in experiment.channels
    how = "samples are counted at the stated rate" if counted else "the time stamps are uniform"
    return Finding("sample clock", "fine", f"{how}, {rate} Hz.", {"rate": rates[0]})
