"""Measured forces that take energy out of a motion: something that is not measured drives it.

From one turn of the motion to a later passage of the same position, forces of the position do no
work, and the body, which rested at the turn, cannot lose kinetic energy. Friction takes energy out.
So all other forces together put energy in, but for what a hidden spring held at the turn. Where
the measured ones take energy out, a hand whose force is not logged drives the device, or the sign
of a force is wrong. A late log turns the force of inertia into work, however. So the work must be
negative for each shift between the logs of force and position that a logger may have.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import numpy as np

from ..base.finding import Finding
from ..measurement.filtering import Array
from ..measurement.limits import ONE_WAY
from ..measurement.record import Record
from ..measurement.record_clock import CLOCK
from ._recording import CheckedRecording, RecordingCheck

#: first turns from which the longest way back to the same position is searched
TURNS = 20
#: shifts of the force at which the work is computed: over their range, the work of a sine that
#: keeps its sign goes through less than half a period
SHIFTS = 11


def find_unknown_drive(recording: CheckedRecording) -> Iterator[Finding]:
    """Whether the measured forces of a single body take energy out of each fit record."""
    body, records = recording.lone_body, recording.experiment.fit_records
    work = 0.0 if body is None else min(work_out_of_record(record, body) for record in records)
    if work > 0.0:
        sentence = (
            f"The measured forces take {work:.2g} J or more out of the motion of each fit record, "
            "as friction does: a hand (or another drive) that is not logged moves the device, or "
            "the sign of the force or of the position is wrong. These records tell no effect: log "
            "the force of the hand, or mend the sign."
        )
        yield Finding("work", "warning", sentence, {"work": work}, stops=True)


CHECK = RecordingCheck(order=220, find=find_unknown_drive, may_stop=True)


def work_out_of_record(record: Record, body: str) -> float:
    """Work (J) that the measured forces surely take out of one record; 0 where they take none."""
    rows = record.longest
    names = (f"{body}.{q}" for q in ("actuator_force", "interaction_force"))
    forces = [record.signals[n][rows] for n in names if n in record.signals]
    position = record.signals[f"{body}.position"][rows]
    loop = _longest_loop(position)
    if loop is None or not forces:
        return 0.0
    first, last = loop
    force, moved = np.sum(forces, axis=0), np.diff(position[first : last + 1])
    most = max(1, int(np.ceil(CLOCK.latest / record.sample_time)))
    shifts = np.unique(np.linspace(-most, most, SHIFTS).round().astype(int))
    at = np.arange(first, last)
    work = max(float(force[np.clip(at - s, 0, len(force) - 1)] @ moved) for s in shifts)
    # a spring inside of the device holds the area below its line: half of force times travel
    held = 0.5 * float(np.abs(force).max() * np.ptp(position))
    return -work if work < -held else 0.0


def _longest_loop(position: Array) -> tuple[int, int] | None:
    """Rows of a turn and of the last passage of its position, as far apart as can be."""
    loops = []
    for turn in islice(_turns(position), TURNS):
        away = position[turn:] - position[turn]
        passages = np.flatnonzero(away[:-1] * away[1:] <= 0.0)
        if len(passages) and passages[-1] > 0:
            loops.append((turn, turn + int(passages[-1])))
    return max(loops, key=lambda loop: loop[1] - loop[0], default=None)


def _turns(position: Array) -> Iterator[int]:
    """Rows at which the motion turns round, by more than the noise of its readings."""
    least = ONE_WAY * float(np.ptp(position))
    ahead, side = 0, 0
    for row, value in enumerate(position.tolist()):
        step = value - position[ahead]
        if side == 0:
            if abs(step) > least:
                ahead, side = row, 1 if step > 0.0 else -1
        elif side * step > 0.0:
            ahead = row
        elif -side * step > least:
            yield ahead
            ahead, side = row, -side
