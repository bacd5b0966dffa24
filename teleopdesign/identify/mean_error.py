"""The standard error of the mean of samples that are not independent."""

from __future__ import annotations

import numpy as np

from ..measurement.filtering import Array


def correlation_length(samples: Array) -> float:
    """Number of samples per independent one: 1 + 2 sum of autocorrelations, to the first < 0."""
    x = samples - samples.mean()
    size = 2 ** int(np.ceil(np.log2(2 * len(x))))
    spectrum = np.fft.rfft(x, size)
    sums = np.fft.irfft(spectrum * spectrum.conj(), size)[: len(x)]
    if sums[0] <= 0.0:
        return 1.0
    # biased sums: those of long lags fall to zero instead of running wild
    correlation = sums / sums[0]
    below = np.flatnonzero(correlation < 0.0)
    last = int(below[0]) if below.size else len(x)
    return float(1.0 + 2.0 * correlation[1:last].sum())


def mean_error(samples: Array) -> float:
    """Standard error of the mean of samples (n,), in their unit.

    Neighbouring samples may be correlated; then fewer samples count as independent.
    """
    independent = min(max(len(samples) / correlation_length(samples), 1.0), float(len(samples)))
    return float(np.std(samples) / np.sqrt(max(independent - 1.0, 1.0)))
