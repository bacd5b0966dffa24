"""Usable bandwidth of a record, up to which the position shows the motion; sizes of its signals."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from .encoder import reading_step
from .experiment import Experiment
from .filtering import Array
from .limits import HALF, NEARLY_ALL
from .motion import Motion
from .record import Record
from .repeated_rows import SENSED, SLOWER

#: size (SI) up to which a signal is none, and largest size that counts: cubes of sizes between
#: them, and quotients of these, are numbers
LEAST, LARGEST = 1e-60, 1e60

#: Hz: no lower bandwidth is chosen or proposed
LOWEST = 1.0
#: highest bandwidth at which a motion is compared, as a part of the sample rate
HIGHEST = 0.4
#: highest bandwidth that is chosen, and that is proposed, as parts of the sample rate
CHOSEN, PROPOSED = 0.1, 0.3
#: highest bandwidth of a comparison as a part of the rate of a sensor whose readings are
#: interpolated: a cubic between readings passes 0.97 of a signal there, 0.87 at 0.3
INTERPOLATED = 0.2
#: a position shows a motion if its spectral density is above this multiple of that of reading
#: noise: 10 dB
ABOVE = 10.0
#: frequencies at which a position shows a motion are lines if they are fewer than this share of the
#: third of an octave below: an encoder makes such lines as it passes its steps at constant speed.
#: Lower: its lines pass for motion; higher: a motion of a few tones counts only above the rounding
DENSE, THIRD_OCTAVE = 0.5, 2.0 ** (1.0 / 3.0)
#: least bandwidth over the frequency below which nearly all of the squared velocity lies: the
#: low-pass then passes 0.996 of the motion
FULLY = 2.0


def bandwidth_of(experiment: Experiment) -> float:
    """Bandwidth of a comparison in Hz: as stated or chosen, and within the rate of slow sensors."""
    limits = [INTERPOLATED * rate for _, rate in slower_sensors(experiment)]
    return min([experiment.bandwidth or default_bandwidth(experiment), *limits])


def slower_sensors(experiment: Experiment) -> list[tuple[str, float]]:
    """Positions and measured forces that are interpolated in a record, with their rate in Hz."""
    sensors = [key for key, c in experiment.channels.items() if c.quantity in SENSED]
    return [
        (name, record.rate_of(name))
        for record in experiment.records
        for name in sensors
        if record.rate_of(name) < SLOWER / record.sample_time
    ]


def default_bandwidth(experiment: Experiment) -> float:
    """Default bandwidth in Hz: the positions still show acceleration and motion up to it.

    The highest frequency below a tenth of the sample rate at which the spectrum of the position is
    10 dB above white reading noise: the lowest one of all records, unless another record moves
    faster than that. The steps of an encoder are not white noise: lines with no more power than the
    error of rounding to these steps are no motion.
    """
    limits, needed = [], [LOWEST]
    for name, record in _moving(experiment):
        frequency, motion = _motion_in(record, name, CHOSEN)
        above, from_here = motion > 0.0, np.cumsum(motion[::-1])[::-1]
        is_dense = _share_below(above, frequency) >= DENSE
        above &= is_dense | (from_here > _rounding(experiment, name, record))
        limits.append(frequency[above].max() if above.any() else 0.02 * record.rate_of(name))
        needed.append(min(FULLY * _frequency_of_motion(record, name), limits[-1]))
    return float(max(min(limits), *needed))


def motion_beyond(experiment: Experiment, chosen: float) -> float | None:
    """The frequency (Hz) up to which the motion continues above the chosen bandwidth.

    None: in some record, less acceleration lies above the bandwidth than below it; the positions do
        not show a motion there, or no more than their rounding to steps makes, as where an encoder
        passes its steps at constant speed; or the experiment states its bandwidth
    """
    if experiment.bandwidth is not None:
        return None
    limits = []
    for name, record in _moving(experiment):
        frequency, motion = _motion_in(record, name, PROPOSED, even_out=True)
        acceleration, beyond = motion * frequency**4, frequency > chosen
        if acceleration[beyond].sum() <= acceleration[~beyond].sum():
            return None
        if motion[beyond].sum() <= _rounding(experiment, name, record):
            return None
        limits.append(float(frequency[motion > 0.0].max()))
    return min(limits)


def _rounding(experiment: Experiment, name: str, record: Record) -> float:
    """Mean square of the error of rounding a position to the steps of its encoder."""
    readings = np.concatenate([record.signals[name][s] for s in record.segments])
    step = experiment.channels[name].resolution or reading_step(readings)
    return step**2 / 12.0


def _share_below(above: NDArray[np.bool_], frequency: Array) -> Array:
    """Share of the frequencies with a motion in the third of an octave up to each frequency."""
    count, last = np.append(0, np.cumsum(above)), np.arange(len(frequency)) + 1
    first = np.searchsorted(frequency, frequency / THIRD_OCTAVE)
    share: Array = (count[last] - count[first]) / (last - first)
    return share


def _frequency_of_motion(record: Record, name: str) -> float:
    """The frequency (Hz) below which nearly all of the squared velocity lies; 0: no motion."""
    frequency, motion = _motion_in(record, name, CHOSEN, even_out=True)
    velocity = motion * frequency**2
    return float(frequency[np.searchsorted(np.cumsum(velocity), NEARLY_ALL * velocity.sum())])


def _moving(experiment: Experiment) -> Iterator[tuple[str, Record]]:
    """Each record with the name of each position channel in it."""
    for record in experiment.records:
        for body in experiment.bodies:
            yield f"{body}.position", record


def _motion_in(
    record: Record, name: str, highest: float, *, even_out: bool = False
) -> tuple[Array, Array]:
    """Frequencies (Hz), and the mean square of a position's motion at each: 0 where noise hides it.

    highest: part of the rate of the readings, above which no motion counts
    even_out: subtract a straight line from each window; its ends would look like high frequencies
    """
    from scipy.signal import detrend

    # windows as long as half of all rows have their segments at least
    lengths = np.sort([s.stop - s.start for s in record.segments])[::-1]
    n = min(int(lengths[np.searchsorted(np.cumsum(lengths), HALF * lengths.sum())]), 4096)
    # no window crosses the seam of two segments: the jump there is no motion
    parts = [record.signals[name][s] for s in record.segments if s.stop - s.start >= n]
    views = (np.lib.stride_tricks.sliding_window_view(x, n)[:: max(1, n // 2)] for x in parts)
    windows = np.concatenate([*views])
    varying = detrend(windows, type="linear" if even_out else "constant")
    spectra = np.fft.rfft(varying * np.hanning(n))
    # 3/8: mean square of the window
    density = np.mean(np.abs(spectra) ** 2, 0) * 16.0 / 3.0 / (2.0 * (n // 2)) ** 2
    frequency: Array = np.fft.rfftfreq(n, record.sample_time).astype(np.float64)
    rate = record.rate_of(name)
    noise = float(np.median(density[(frequency > PROPOSED * rate) & (2 * frequency <= rate)]))
    above = (density > ABOVE * noise) & (frequency <= highest * rate)
    return frequency, np.where(above, density - noise, 0.0)


def scales(motions: Sequence[Motion], bandwidth: float) -> dict[str, float]:
    """Quantity -> typical size along these motions (SI): rms values and their quotients.

    "lowest_position", "highest_position" and "largest_velocity" are ends of all motions together;
    "travel" is the widest range of positions in one motion, "duration" the longest.
    """

    def rms(parts: list[np.ndarray]) -> float:
        size = float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))
        return min(size, LARGEST) if size > LEAST else 1e-12

    force = rms([m.lowpassed(m.at_rows(m.command) + m.interaction) for m in motions])
    position = rms([m.position - m.position.mean() for m in motions])
    velocity = rms([m.velocity for m in motions])
    acceleration = rms([m.lowpassed(m.acceleration) for m in motions])
    return {
        "time": 1.0 / (2 * np.pi * bandwidth),
        "position": position,
        "velocity": velocity,
        "acceleration": acceleration,
        "force": force,
        "largest_force": max(float(np.abs(m.command + m.interaction).max()) for m in motions)
        or force,
        "inertia": force / acceleration,
        "damping": force / velocity,
        "stiffness": force / position,
        "resonance_stiffness": force / acceleration * (2 * np.pi * bandwidth) ** 2,
        "resonance_position": acceleration / (2 * np.pi * bandwidth) ** 2,
        "resonance_damping": force / acceleration * 2 * np.pi * bandwidth,
        "drag": force / velocity**2,
        "cubic_stiffness": force / position**3,
        "per_square_of_position": 1.0 / position**2,
        "travel": max(float(np.ptp(m.position)) for m in motions) or 1e-12,
        "lowest_position": min(float(m.position.min()) for m in motions),
        "highest_position": max(float(m.position.max()) for m in motions),
        "largest_velocity": max(float(np.abs(m.velocity).max()) for m in motions) or 1e-12,
        "duration": max(float(np.ptp(m.time)) for m in motions),
        "frequency": bandwidth,
        "angle": 1.0,
        "dimensionless": 1.0,
        "temperature": 1.0,
        "temperature_coefficient": 1.0,
    }
