"""What a logger adds to its readings: spikes, and a hum of the mains.

No body and no sensor makes a lone reading far off the course of all others, as of a disturbed bus
or encoder: it is read as lost, and filled by the curve through its neighbours. Readings are spikes
only if the least of them is `GAP` times as far off as every other reading of the stretch. Steps,
impacts of several rows and chatter are therefore none.

A real force of 50 or 60 Hz would have moved the body. A tone without motion is only in the log, and
is subtracted before forces are compared. Otherwise an effect with a resonance there would imitate
the tone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.units import MAINS
from .encoder import Array, reading_step
from .limits import FEWEST, HALF, SMALL
from .repeated_rows import runs_of
from .resample import cubic_through_four

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

Mask = NDArray[np.bool_]

#: rows whose median is the course of a reading: of seven, three may be spikes
NEAR = 7
#: a spike is at least so many times as far off the course as any reading that is none
GAP = 4.0
#: most of the readings that are spikes: of more, seven rows hold four too often
MOST = 0.05
#: most successive spikes: an impact or a stretch without signal lasts longer. Of many spikes,
#: three follow one another by chance; then so do as many as are expected in `BY_CHANCE` records;
#: and the probability that spikes are taken for contacts by chance
LONGEST, BY_CHANCE = 2, 0.01


def filled_spikes(
    values: Array, step: float, parts: Sequence[slice], position: Array | None = None
) -> tuple[Array, Mask]:
    """Readings (n,) with their spikes filled, and the mask (n,) of these.

    parts: uninterrupted stretches;  position: of the body (n,), where the readings are a force
    """
    out, spikes = values.copy(), np.zeros(len(values), dtype=bool)
    for part in parts:
        x = values[part]
        odd = find_spikes(x, step)
        if not odd.any() or (position is not None and are_contacts(odd, position[part])):
            continue
        out[part], spikes[part] = fill_spikes(x, odd), odd
    return (out, spikes) if spikes.any() else (values, spikes)


def lost_zeros(position: Array) -> Mask:
    """Mask (n,) of the readings 0 of a position that stand for none: it leaps there and back.

    Each leap is larger than any other change of a reading, the largest of them `GAP` times. A body
    that passes zero, or rests there, comes to it as it moves elsewhere.
    """
    zero, lost = position == 0.0, np.zeros(len(position), dtype=bool)
    change = np.abs(np.diff(position))
    other = change[~(zero[1:] | zero[:-1]) & np.isfinite(change)]
    first, past = runs_of(zero)
    inner = (first > 0) & (past < len(zero))
    first, past = first[inner], past[inner]
    if not len(first) or not len(other):
        return lost
    least = max(float(other.max()), GAP * reading_step(position[np.isfinite(position)]))
    leaps = np.minimum(change[first - 1], change[past - 1])
    if leaps.max() > GAP * least:
        for a, b in zip(first[leaps > least], past[leaps > least], strict=True):
            lost[a:b] = True
    return lost


def find_spikes(x: Array, step: float) -> Mask:
    """Mask (n,) of the spikes among successive readings of one channel.

    step: smallest step between readings
    """
    none = np.zeros(len(x), dtype=bool)
    if len(x) < FEWEST:
        return none
    off = np.abs(x - _course(x))
    order = np.argsort(-off, kind="stable")[: int(MOST * len(x)) + 1]
    size = np.maximum(off[order], max(step, np.finfo(float).tiny))
    for last in np.flatnonzero(size[:-1] >= GAP * size[1:])[::-1]:
        spikes = none.copy()
        spikes[order[: last + 1]] = True
        if _are_lone(x, spikes):
            return spikes
    return none


def are_contacts(spikes: Mask, position: Array) -> bool:
    """Whether the spikes of a force (n,) lie where the velocity of the body (n,) changes most."""
    from scipy.special import bdtrc

    first, past = _inner_runs(spikes)
    if not len(first):
        return False
    rows = np.arange(NEAR // 2, len(position) - NEAR // 2)
    usual = np.sort(_change_of_slope(position, rows, rows + 1))
    changes = _change_of_slope(position, first, past)
    larger = np.sort(1.0 - np.searchsorted(usual, changes, side="left") / len(usual))
    half = (len(larger) + 1) // 2
    share = float(larger[half - 1])
    return share <= SMALL and float(bdtrc(half - 1, len(larger), share)) < BY_CHANCE


def fill_spikes(x: Array, spikes: Mask) -> Array:
    """The readings (n,) with each spike on the cubic through the four nearest other readings."""
    good, odd, out = np.flatnonzero(~spikes), np.flatnonzero(spikes), x.copy()
    left = np.searchsorted(good, odd) - 1
    out[odd] = cubic_through_four(x[good], good.astype(float), odd.astype(float), left)
    return out


def _course(x: Array) -> Array:
    """The median of the rows about each reading (n,); at the ends the parabola through medians."""
    course, half = x.copy(), NEAR // 2
    about = np.lib.stride_tricks.sliding_window_view(x, NEAR)
    course[half:-half] = np.partition(about, half)[:, half]
    nodes = half + NEAR * np.arange(3)
    for side in (course, course[::-1]):
        parabola = np.polyfit(nodes, side[nodes], 2)
        side[:half] = np.polyval(parabola, np.arange(half))
    return course


def _are_lone(x: Array, spikes: Mask) -> bool:
    """Whether each run of spikes is short, and the readings beside it go on as if without it."""
    first, past = runs_of(spikes)
    longest = int((past - first).max())
    if longest > LONGEST and len(x) * float(spikes.mean()) ** longest < BY_CHANCE:
        return False
    y = fill_spikes(x, spikes)
    # beside the ends of the record only the size counts: a first reading alone may be a step
    first, past = _inner_runs(spikes)
    if not len(first):
        return False
    size = np.minimum(np.abs(x - y)[first], np.abs(x - y)[past - 1])
    before, after = _slopes(y, first, past)
    level = y[past] - y[first - 1] - 0.5 * (past - first + 1) * (before + after)
    return bool((np.maximum(np.abs(level), np.abs(after - before)) <= HALF * size).all())


def _inner_runs(spikes: Mask) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """First row of each run of spikes, and the row after it, of those with rows on both sides."""
    first, past = runs_of(spikes)
    inner = (first >= NEAR // 2) & (past <= len(spikes) - NEAR // 2)
    return first[inner], past[inner]


def _slopes(x: Array, first: NDArray[np.intp], past: NDArray[np.intp]) -> tuple[Array, Array]:
    """Change of x in a row, before row `first` and from row `past` on."""
    return 0.5 * (x[first - 1] - x[first - 3]), 0.5 * (x[past + 2] - x[past])


def _change_of_slope(x: Array, first: NDArray[np.intp], past: NDArray[np.intp]) -> Array:
    before, after = _slopes(x, first, past)
    return np.abs(after - before)


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
