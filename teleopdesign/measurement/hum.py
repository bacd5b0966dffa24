"""Mains hum in the log of a force: a tone of 50 or 60 Hz that no position shows.

A real force at that frequency would have moved the body. A tone without motion is only in the log,
and is subtracted before forces are compared. Otherwise an effect with a resonance there would
imitate the tone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.units import MAINS
from .filtering import Array

#: Hz to either side of the mains frequency: the range of the usual power, and the range of the tone
AROUND, WITHIN = 10.0, 1.5
#: power of a tone over the median around it, from which it counts as a hum: white noise reaches it
#: with a probability of 2^-300, and a force that follows a motion without this tone stays below ten
TONE = 300.0
#: the same ratio for a position: above it, the body moves at this frequency, so the force may, too
MOVES = 30.0
#: rms of a tone over that of the channel, from which it counts. Beside white noise a tone of that
#: power has a third of its rms in 6000 rows, whatever its share: of 0.01, taken for no hum, eleven
#: of 50 answers were undecided. A force without noise may have weaker tones of that power by itself
SHARE = 0.002
#: part of a force from which its hum, or what the reading of its log may add to the force error, is
#: a warning: a tenth of the error of a plain friction model on the recordings of `fetch`
STRONG = 0.02
#: s: shorter records do not separate the tone from neighbouring frequencies
SHORTEST = 2.0


@dataclass(frozen=True)
class Hum:
    """A tone at the mains frequency.

    mains: nominal frequency, Hz;  frequency: as measured, Hz;  rms: in the unit of the channel
    """

    mains: float
    frequency: float
    rms: float


def tone_at(y: Array, sample_time: float, frequency: float) -> tuple[float, float]:
    """Power of a tone over the median power around it, and the rms of the tone in the unit of y.

    frequency: Hz, of the tone;  sample_time: s
    """
    window = np.hanning(len(y))
    power = np.abs(np.fft.rfft((y - y.mean()) * window)) ** 2
    off = np.abs(np.fft.rfftfreq(len(y), sample_time) - frequency)
    usual = float(np.median(power[(off < AROUND) & (off > WITHIN)]))
    most = float(power[off <= WITHIN].max())
    if usual <= 0:
        return 0.0, 0.0
    return most / usual, float(np.sqrt(2 * most) / window.sum())


def hum_of(force: Array, positions: Sequence[Array], sample_time: float) -> Hum | None:
    """The hum in one stretch of a force (n,); None: no hum, or a position (n,) shows it as well."""
    if len(force) * sample_time < SHORTEST:
        return None
    for mains in MAINS:
        if mains + AROUND > 0.5 / sample_time:
            continue
        over, rms = tone_at(force, sample_time, mains)
        if over < TONE or rms < SHARE * float(force.std()):
            continue
        if any(tone_at(x, sample_time, mains)[0] > MOVES for x in positions):
            continue
        return Hum(mains, _peak(force - force.mean(), sample_time, mains), rms)
    return None


def without_hum(force: Array, hum: Hum, sample_time: float) -> Array:
    """A stretch of a force (n,) minus the tone, with the amplitude and phase in this stretch."""
    wave = _wave(len(force), sample_time, hum.frequency)
    window = np.hanning(len(force))
    size = 2.0 * np.sum(window * (force - force.mean()) * wave.conj()) / window.sum()
    return np.asarray(force - (size * wave).real)


def _wave(count: int, sample_time: float, frequency: float) -> NDArray[np.complex128]:
    turns = frequency * sample_time * np.arange(count)
    return np.asarray(np.exp(2j * np.pi * turns), dtype=np.complex128)


def _peak(y: Array, sample_time: float, near: float) -> float:
    """Frequency (Hz) of the tone in `y`, within `WITHIN` of `near`."""
    from scipy.optimize import minimize_scalar  # its import takes longer than reading a log

    window = np.hanning(len(y))
    power = np.abs(np.fft.rfft(y * window))
    grid = np.fft.rfftfreq(len(y), sample_time)
    power[np.abs(grid - near) > WITHIN] = 0.0
    line, highest = float(grid[1]), float(grid[int(np.argmax(power))])

    def lost(frequency: float) -> float:
        wave = _wave(len(y), sample_time, frequency)
        return -float(np.abs(np.sum(window * y * wave.conj())))

    bounds = (highest - line, highest + line)
    return float(minimize_scalar(lost, bounds=bounds, method="bounded").x)
