"""Low-pass, derivatives and zero-order hold as multipliers of one Fourier transform.

The signal is continued by point symmetry at both ends (level and slope go on), so that errors
remain near the ends. Low-pass and derivative add no delay; the zero-order hold has its physical
delay. All functions apply to arrays of shape (..., n).
"""

from __future__ import annotations

import weakref
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: s by which a record is continued (point symmetric) at each end, if the record is long enough
CONTINUED = 0.6
#: periods of the bandwidth after which the low-pass has forgotten its input: its slowest pole, with
#: a time constant of 2.6 / (2 pi bandwidth), has decayed to exp(-7) in both directions
FORGOTTEN = 3.0


class Spectrum:
    """Multiplies signals on one uniform grid of n samples by functions of frequency.

    n: samples;  sample_time: s
    """

    def __init__(self, n: int, sample_time: float) -> None:
        from scipy.fft import next_fast_len

        self.n, self.sample_time = n, sample_time
        self.margin = max(1, min(round(CONTINUED / sample_time), n - 1))
        self.length = next_fast_len(n + 4 * self.margin, real=True)
        self.frequency = np.arange(self.length // 2 + 1) / (self.length * sample_time)
        ramp = np.linspace(0.0, 1.0, self.length - n - 2 * self.margin + 2)[1:-1]
        # a smooth bridge closes the circle without a step in level or slope
        self._bridge = ramp * ramp * (3.0 - 2.0 * ramp)

    def __reduce__(self) -> tuple[object, ...]:
        return spectrum, (self.n, self.sample_time)

    def transform(self, y: Array) -> NDArray[np.complex128]:
        """Fourier transform of (..., n) signals, continued at both ends."""
        m = self.margin
        left = 2 * y[..., :1] - y[..., m:0:-1]
        right = 2 * y[..., -1:] - y[..., -2 : -m - 2 : -1]
        bridge = right[..., -1:] + (left[..., :1] - right[..., -1:]) * self._bridge
        whole = np.concatenate([left, y, right, bridge], axis=-1)
        return np.asarray(np.fft.rfft(whole), dtype=np.complex128)

    def back(self, transformed: NDArray[np.complex128]) -> Array:
        """The signals (..., n) from their transform."""
        y: Array = np.fft.irfft(transformed, self.length)
        return np.ascontiguousarray(y[..., self.margin : self.margin + self.n])

    def multiply(self, y: Array, gain: NDArray[np.complex128] | Array) -> Array:
        """Multiply signals (..., n) by a function of frequency, real or complex."""
        return self.back(self.transform(y) * gain)

    def lowpass(self, cutoff: float, order: int = 4) -> Array:
        """Gain |H|^2 of a Butterworth low-pass that runs forward and backward, with zero phase.

        cutoff: Hz;  order: of the one-way filter (4: the filter of the force error)
        """
        nyquist = 0.5 / self.sample_time
        warped = np.tan(0.5 * np.pi * np.minimum(self.frequency / nyquist, 0.99999))
        edge = np.tan(0.5 * np.pi * min(cutoff / nyquist, 0.99999))
        return np.asarray(1.0 / (1.0 + (warped / edge) ** (2 * order)))

    def derivative(self, order: int) -> NDArray[np.complex128]:
        """The multiplier (j omega)^order of a derivative in time."""
        return _derivative(self.n, self.sample_time, order)

    def ahead(self, time: float) -> NDArray[np.complex128] | float:
        """The multiplier that advances a signal y(t) to y(t + time), time in s; 1 for time 0."""
        return np.exp(2j * np.pi * self.frequency * time) if time else 1.0

    def hold(self, parts: int = 1, which: int = 0) -> NDArray[np.complex128]:
        """The multiplier of a zero-order hold: from row values to the held signal at the rows.

        parts: number of equal parts of a row;  which: the part, from 0, in which the values are
            held
        """
        return _hold(self.n, self.sample_time, parts, which)


@lru_cache(maxsize=64)
def spectrum(n: int, sample_time: float) -> Spectrum:
    """The Spectrum of a grid of n samples, computed once."""
    return Spectrum(n, sample_time)


@lru_cache(maxsize=32)
def _derivative(n: int, sample_time: float, order: int) -> NDArray[np.complex128]:
    """`Spectrum.derivative` on that grid, computed once."""
    gain = (2j * np.pi * spectrum(n, sample_time).frequency) ** order
    gain.setflags(write=False)
    return np.asarray(gain, dtype=np.complex128)


@lru_cache(maxsize=32)
def _hold(n: int, sample_time: float, parts: int, which: int) -> NDArray[np.complex128]:
    """`Spectrum.hold` on that grid, computed once: every evaluation of an actuation needs it."""
    x = np.pi * spectrum(n, sample_time).frequency * sample_time / parts
    held = np.sinc(x / np.pi) * np.exp(-1j * (1 + 2 * which) * x) / parts
    held.setflags(write=False)
    return np.asarray(held, dtype=np.complex128)


@dataclass
class HeldCommand:
    """The transform of a held command on one grid, and the last smooth signal made of it.

    A search evaluates the same record hundreds of times, for one delay of its log after another.

    last: delay (s) of the log, gain of the smoothing, and the signal with these
    """

    spectrum: Spectrum
    transformed: NDArray[np.complex128]
    last: tuple[float, Array, Array] | None = field(default=None)

    def smooth(self, late: float, smoothing: Array) -> Array:
        """The command at the rows (n,), advanced by the delay `late` (s) of its log."""
        last = self.last
        if last is None or last[0] != late or last[1] is not smoothing:
            gain = smoothing * self.spectrum.ahead(late)
            last = self.last = (late, smoothing, self.spectrum.back(self.transformed * gain))
        return last[2]


#: identity of a recorded command -> the command while it lives, and what was computed of it
_known: dict[int, tuple[weakref.ref[Array], HeldCommand]] = {}


def held_command(command: Array, spectrum: Spectrum) -> HeldCommand:
    """The held command of a record (n,) on its grid; nothing writes into a record's array."""
    place = id(command)
    known = _known.get(place)
    if known is not None and known[0]() is command and known[1].spectrum is spectrum:
        return known[1]
    held = HeldCommand(spectrum, spectrum.transform(command) * spectrum.hold())
    _known[place] = (weakref.ref(command, lambda _: _known.pop(place, None)), held)
    return held
