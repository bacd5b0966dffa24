"""Lock-in: the first harmonic of a periodic signal, and the harmonics above it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Harmonic:
    """First harmonic of a periodic signal, from the last cycles of a record.

    phasor: mean over the last two cycles, unit of the signal; sin is 1 and cos is j
    distortion: rms of all higher harmonics over that of the first; inf if the first is zero
    unsettled: largest relative difference between the last cycle and any other of the second half
        of the record; a slow transient may turn, so that two cycles alone can agree by chance
    """

    phasor: complex
    distortion: float
    unsettled: float


def phasors(cycles: np.ndarray) -> np.ndarray:
    """First harmonic of each cycle, complex, shape (...); sin(phase) is 1, cos(phase) is j.

    cycles: (..., n), one period on a uniform grid, without its end
    """
    n = cycles.shape[-1]
    angle = 2 * np.pi * np.arange(n) / n
    return np.asarray(2 * np.mean(cycles * (np.sin(angle) + 1j * np.cos(angle)), axis=-1))


def distortion(cycles: np.ndarray) -> np.ndarray:
    """Total harmonic distortion of each cycle: rms of harmonics 2, 3, ... over that of the first.

    cycles: as in `phasors`;  returns: shape (...), by Parseval from the rms of the whole
    """
    first = 0.5 * np.abs(phasors(cycles)) ** 2
    others = np.maximum(np.var(cycles, axis=-1) - first, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.sqrt(others / first))


def whole_cycles(values: np.ndarray, *, step: float, frequency: float, points: int) -> np.ndarray:
    """All whole cycles of a record that starts at t = 0, shape (cycles, points).

    values: (n,) at times 0, step, ...; linear between these, so that a cycle need not be a whole
        number of steps. Every cycle begins where sin(2 pi frequency t) rises through zero
    """
    count = int(np.floor(step * (len(values) - 1) * frequency + 1e-9))
    time = np.arange(count * points) / points / frequency
    samples = np.interp(time, step * np.arange(len(values)), values)
    return np.asarray(samples.reshape(count, points))


def lock_in(values: np.ndarray, *, step: float, frequency: float, points: int) -> Harmonic:
    """First harmonic of the last two cycles of a record that starts at t = 0.

    values: (n,), at least four cycles, at times 0, step, ... in s;  frequency: Hz
    points: of the grid over one cycle
    """
    cycles = whole_cycles(values, step=step, frequency=frequency, points=points)
    each = phasors(cycles)
    phasor = complex(each[-2:].mean())
    # 1e-12 of the record: below it a first harmonic is rounding
    size = max(abs(phasor), 1e-12 * float(np.abs(values).max()), float(np.finfo(float).tiny))
    apart = np.abs(each[len(each) // 2 - 1 :] - each[-1]).max()
    return Harmonic(phasor, float(distortion(cycles[-2:].mean(axis=0))), float(apart) / size)
