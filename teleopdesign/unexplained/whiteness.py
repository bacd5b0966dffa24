"""Whether the residual differs from sensor noise by its pattern: correlation and frequencies.

Sensor noise below the comparison's low-pass is correlated only as long as this filter responds. The
residual of a missing force is slower: it is correlated over some tenths of a second.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from ..diagnose.solve import BLOCK
from ..measurement.filtering import FORGOTTEN, Array
from .rows import Rows

#: lags that are looked at
LAGS = 12


@dataclass(frozen=True)
class Whiteness:
    """Autocorrelation of the residual.

    lag: s, (l,);  correlation: (l,);  noise: (l,) standard deviation of the correlation by chance
    probability: that chance alone gives the largest correlation, over all lags
    spectrum: rows frequency (Hz), rms of the residual and of the measured force per band (3, f)
    """

    lag: Array
    correlation: Array
    noise: Array
    probability: float
    spectrum: Array

    @property
    def band(self) -> tuple[float, float]:
        """The frequencies (Hz) with a quarter of the residual's squares below, and above."""
        squares = np.cumsum(self.spectrum[1] ** 2)
        share = squares / max(float(squares[-1]), 1e-300)
        low, high = np.interp([0.25, 0.75], share, self.spectrum[0])
        return float(low), float(high)


def whiteness_of(rows: Rows) -> Whiteness:
    """Autocorrelation of the residual on all rows, tested by blocks of a quarter of a second."""
    lags = np.geomspace(FORGOTTEN / rows.bandwidth, 2 * BLOCK, LAGS)
    left = rows.residual
    whole = float(left @ left)
    correlation, noise = np.zeros(LAGS), np.zeros(LAGS)
    parts = [np.flatnonzero(rows.number == i) for i in np.unique(rows.number)]
    steps = [a.stretch.motion.sample_time * a.stretch.weight for a in rows.alongs]
    for i, lag in enumerate(lags):
        sums = np.zeros(int(rows.blocks.max()) + 1)
        for part, step in zip(parts, steps, strict=True):
            k = max(1, round(lag / step))
            if k < len(part):
                np.add.at(sums, rows.blocks[part[:-k]], left[part[k:]] * left[part[:-k]])
        correlation[i] = sums.sum() / max(whole, 1e-300)
        # neighbouring blocks share samples: their products are taken in
        spread = float(sums @ sums + 2 * (sums[1:] @ sums[:-1]))
        noise[i] = np.sqrt(max(spread, float(sums @ sums))) / max(whole, 1e-300)
    largest = float(np.max(np.abs(correlation) / np.maximum(noise, 1e-300)))
    chance = min(1.0, 2 * LAGS * float(ndtr(-largest)))
    return Whiteness(lags, correlation, noise, chance, _spectrum(rows, parts, steps))


def _spectrum(rows: Rows, parts: list[NDArray[np.intp]], steps: list[float]) -> Array:
    """Band frequency, rms of the residual and of the measured force per band (3, f).

    The bands are logarithmic from 1 Hz to the bandwidth, with one band below 1 Hz.
    """
    edges = np.concatenate([[0.0], np.geomspace(1.0, rows.bandwidth, 25)])
    squares = np.zeros((2, len(edges) - 1))
    for part, step in zip(parts, steps, strict=True):
        frequency = np.fft.rfftfreq(len(part), step)
        band = np.clip(np.searchsorted(edges, frequency, side="right") - 1, 0, len(edges) - 2)
        for j, signal in enumerate((rows.residual, rows.measured)):
            power = 2 * np.abs(np.fft.rfft(signal[part])) ** 2 / len(part)
            np.add.at(squares[j], band, power)
    middle = np.sqrt(np.maximum(edges[1:] * edges[:-1], 0.25 * edges[1:] ** 2))
    return np.vstack([middle, np.sqrt(squares / len(rows.residual))])
