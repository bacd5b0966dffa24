"""The clock of a source that a reader polls: a log of the last state at the reader's instants.

A controller writes its state down once a tick, and a script reads the latest one when it comes to
it. A row is then younger or older than its stamp says, by up to a tick: it repeats the row before
where no tick lies between the two, and ticks that no row holds are lost. The readings tell the
ticks: a row of the tick before its stamp s is late by (s - phase) modulo the period, and the
position is off its neighbours by the speed times that. Where the reader is the faster one, rows
change from tick to tick alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .encoder import reading_step
from .off_neighbours import OffNeighbours
from .reading import ReadingStep
from .record_clock import Array

#: rows from which ticks are sought, and rows of them that a trial of a period is computed on
FEWEST, TRIAL, _FEW = 200, 3000, 600
#: ticks between two rows, up to which their period is sought: a reading is late by half a tick, so
#: that more of them err by less than a thirtieth of a row
FINEST = 16
#: instants of the fine grid per row of the spectrum, and peaks of it that are refined
_GRID, _PEAKS = 64, 6
#: rows of which the spectrum is made, and steps between rows that are a pause: both bound its size
MOST, PAUSE = 10_000, 10.0
#: power of the highest peak, of the mean: of noise the highest is near that
_CLEAR = 10.0
#: least part of the squares by which positions are off their neighbours that ticks must explain
EXPLAINED = 0.5
#: speed that they must say, of the position's, and standard errors that must tell it from none
_SPEED, _SURE = (0.7, 1.3), 10.0
#: part of the rows whose tick must not contradict what they say, and part of a tick within which a
#: stamp may be on its wrong side
ALIKE, _EDGE = 0.95, 0.1
#: part of rows that are new, up to which the reader is the faster one and changes tell the ticks
OFTEN = 0.6
#: least part of the new rows in which the position must go on by more than a step of its encoder
LEAPS = 0.2
#: part of the rows that must lie other than the usual count of ticks apart: fewer are lost or twice
ODD = 0.02
#: rms of the steps between stamps, of one, below which a reader is even and tells no ticks
EVEN = 0.01


@dataclass(frozen=True, eq=False)
class PolledSource:
    """Ticks of the source: period and instant of tick 0, s, and the tick (n,) of each row."""

    period: float
    phase: float
    ticks: NDArray[np.intp]

    @property
    def instants(self) -> Array:
        """Instant (n,) of each row's tick, s."""
        return np.asarray(self.phase + self.period * self.ticks)


def polled_source(
    stamps: Array, same: NDArray[np.bool_], positions: Sequence[Array]
) -> PolledSource | None:
    """The clock of the source, where rows hold its last state; None: nothing says so.

    stamps: (n,) s, of the reader;  positions: (n,) each
    same: (n,) the row says in every channel what the row before says
    """
    if len(stamps) < FEWEST or not positions or np.any(np.diff(stamps) <= 0):
        return None
    new = np.r_[True, ~same[1:]]
    rows = np.flatnonzero(new)
    if len(rows) < FEWEST:
        return None
    x = max(positions, key=_share_of_motion)
    best = _clock_from_changes(stamps, new, x)
    steps = np.diff(stamps[_first_stretch(stamps)])
    if best is None and np.std(steps) > EVEN * np.median(steps):
        best = _clock_from_position(stamps[rows], x[rows])
    if best is None:
        return None
    ticks = _ticks(stamps, new, *best)
    if ticks is None:
        return None
    # rows that are all as many ticks apart are those of an even clock, whose stamps are late
    apart = np.diff(ticks)
    if np.mean(apart != np.median(apart)) < ODD:
        return None
    return PolledSource(*best, ticks)


def reading_of_source(source: PolledSource, first: NDArray[np.bool_], file: str) -> ReadingStep:
    """What is said of such a log;  first: (n,) the row is the first of its tick."""
    period, again = source.period, float(np.mean(~first))
    skipped = 1.0 - float(first.sum()) / (source.ticks[-1] - source.ticks[0] + 1)
    return ReadingStep(
        file,
        f"rows hold the last state of a source that writes each {1e3 * period:.5g} ms, read at "
        "other instants",
        f"each row at its tick of the source: {100 * again:.2g} % repeat the tick before, "
        f"{100 * skipped:.2g} % of the ticks are in no row",
        f"read at its stamps, a row would be up to {1e3 * period:.2g} ms early",
        topic="sample clock",
        numbers=(("period", period), ("repeated", again), ("skipped", skipped)),
    )


def _ticks(
    stamps: Array, new: NDArray[np.bool_], period: float, phase: float
) -> NDArray[np.intp] | None:
    """Tick of each row; rows that differ have different ones. None: too many contradict that."""
    # a stamp next to a tick may fall on its wrong side: a row that says the same is of the same
    # tick there, one that differs is one tick later
    places = (stamps - phase) / period - np.where(new, 0.0, _EDGE)
    floor = np.floor(places).astype(np.intp)
    if np.sum((np.diff(floor) == 0) & new[1:]) > (1.0 - ALIKE) * len(new):
        return None
    different = np.cumsum(new)
    ticks = np.asarray(np.maximum.accumulate(floor - different) + different, dtype=np.intp)
    return ticks if np.mean(ticks != floor) < 1.0 - ALIKE else None


def _share_of_motion(x: Array) -> float:
    """Part of the pairs of rows between which a position changes."""
    return float(np.mean(np.diff(x) != 0))


def _spectrum(at: Array, values: Array, period: float) -> tuple[Array, Array]:
    """Frequencies, Hz, and size of the Fourier sum of values at uneven instants.

    Instants are rounded to a grid of `_GRID` in a `period`, each value parted among its neighbours.
    """
    step = period / _GRID
    place = (at - at[0]) / step
    left = np.floor(place).astype(np.intp)
    count = 1 << int(2 * (left[-1] + 2) - 1).bit_length()
    grid = np.zeros(count)
    np.add.at(grid, left, values * (1.0 - (place - left)))
    np.add.at(grid, left + 1, values * (place - left))
    size = np.abs(np.fft.rfft(grid))
    frequency = np.fft.rfftfreq(count, step)
    # what a line between two grid points takes away from a wave
    return np.asarray(frequency), np.asarray(size / np.sinc(frequency * step) ** 2)


def _peaks(frequency: Array, size: Array, low: float, high: float) -> list[float]:
    """Frequencies, Hz, of the highest peaks of a spectrum within a band, highest first."""
    inside = np.flatnonzero((frequency >= low) & (frequency <= high))
    inside = inside[(inside > 0) & (inside < len(size) - 1)]
    tops = inside[(size[inside] >= size[inside - 1]) & (size[inside] > size[inside + 1])]
    tops = tops[np.argsort(-size[tops], kind="stable")]
    chosen: list[float] = []
    apart = 3.0 * frequency[1]
    for f in frequency[tops].tolist():
        if all(abs(f - other) > apart for other in chosen):
            chosen.append(f)
        if len(chosen) == _PEAKS:
            break
    return chosen


def _first_stretch(at: Array) -> slice:
    """The longest stretch without a pause, `MOST` rows of it: one that a spectrum can hold."""
    pauses = np.flatnonzero(np.diff(at) > PAUSE * np.median(np.diff(at))) + 1
    edges = np.concatenate([[0], pauses, [len(at)]])
    k = int(np.argmax(np.diff(edges)))
    return slice(int(edges[k]), int(min(edges[k + 1], edges[k] + MOST)))


def _clock_from_position(stamps: Array, x: Array) -> tuple[float, float] | None:
    """Period and phase of the ticks at which a position was read, not at its stamps."""
    here = _first_stretch(stamps)
    if here.stop - here.start < FEWEST:
        return None
    usual = float(np.median(np.diff(stamps[here])))
    clock = _in_stretch(OffNeighbours(stamps[here], x[here]), usual)
    if clock is None:
        return None
    period, phase = clock
    while here.stop - here.start < len(x):
        known, rows = float(np.ptp(stamps[here])), here.stop - here.start
        here = slice(max(0, here.start - rows), min(len(x), here.stop + rows))
        lines = OffNeighbours(stamps[here], x[here]).some(TRIAL)
        period, phase = _refine(lines, period, phase, 0.25 * period**2 / known)
    explained, slope, error = OffNeighbours(stamps, x).fit(period, phase)
    if explained < EXPLAINED or slope < _SURE * error or not _SPEED[0] < slope < _SPEED[1]:
        return None
    return period, phase


def _in_stretch(lines: OffNeighbours, usual: float) -> tuple[float, float] | None:
    """Period and phase by one stretch alone;  usual: step between its rows, s."""
    moment = np.zeros(len(lines.stamps))
    for k in range(5):
        np.add.at(moment, lines.nodes[:, k], lines.weights[:, k] * lines.off)
    frequency, size = _spectrum(lines.stamps, moment * lines.speed, usual)
    band = (0.6 / usual, FINEST / usual)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    if size[inside].max() ** 2 < _CLEAR * np.mean(size[inside] ** 2):
        return None
    few, duration = lines.some(_FEW), float(np.ptp(lines.stamps))
    turn = np.arange(0.0, 1.0, 1.0 / 16)
    trials = [
        _best_near(few, m / f, 0.5 * (m / f) ** 2 / duration, 5, lines.middle, turn * m / f)
        for f in _peaks(frequency, size, *band)
        for m in (1, 2)
        if f / m >= band[0]
    ]
    _, period, phase = min(trials)
    return _refine(lines.some(TRIAL), period, phase, 0.25 * period**2 / duration)


def _refine(lines: OffNeighbours, period: float, phase: float, width: float) -> tuple[float, float]:
    """The best clock near one;  width: s, by which its period may be wrong."""
    phase += period * round((lines.middle - phase) / period)
    turn = np.linspace(-0.5, 0.5, 9) / 8
    for _ in range(3):
        _, period, phase = _best_near(lines, period, width, 7, phase, turn * period)
        turn, width = turn / 4, width / 3
    return period, phase


def _best_near(
    lines: OffNeighbours, period: float, width: float, count: int, start: float, beside: Array
) -> tuple[float, float, float]:
    """Squares left by the best of some clocks, its period and the instant of a tick, s.

    width: s, by which `count` periods differ at most;  start, beside: s, of ticks near the middle
    of the log, where the phase hardly moves with the period
    """
    return min(
        (lines.left(p, start + b), float(p), float(start + b))
        for p in period + width * np.linspace(-1.0, 1.0, count)
        for b in beside
    )


def _clock_from_changes(
    stamps: Array, new: NDArray[np.bool_], x: Array
) -> tuple[float, float] | None:
    """Period and phase of a source that is read more often than it writes: rows change at ticks."""
    changed = np.flatnonzero(new[1:]) + 1
    if np.mean(new) > OFTEN or len(changed) < FEWEST:
        return None
    # an encoder's single steps come evenly where it turns evenly
    if np.mean(np.abs(np.diff(x)[changed - 1]) > 1.5 * reading_step(x)) < LEAPS:
        return None
    at = 0.5 * (stamps[changed] + stamps[changed - 1])
    apart = float(np.median(np.diff(at)))
    first = _first_stretch(at)
    some = at[first]
    if len(some) < FEWEST:
        return None
    frequency, size = _spectrum(some, np.ones(len(some)), apart)
    for f in _peaks(frequency, size, 0.6 / apart, 2.5 / apart):
        near = f + frequency[1] * np.linspace(-1.0, 1.0, 41)
        turns = np.exp(2j * np.pi * near[:, None] * (some - some[0])[None, :]).sum(axis=1)
        k = int(np.argmax(np.abs(turns)))
        # a tick lies anywhere between two rows that differ: in their middle on average
        period = float(1.0 / near[k])
        phase = float(some[0] + np.angle(turns[k]) / (2 * np.pi) * period)
        begin, end = first.start, first.stop
        while end - begin < len(at):
            rows = end - begin
            begin, end = max(0, begin - rows), min(len(at), end + rows)
            count = np.rint((at[begin:end] - phase) / period)
            period, start = np.polyfit(count, at[begin:end] - phase, 1).tolist()
            phase += start
        if _ticks(stamps, new, period, phase) is not None:
            return period, phase
    return None
