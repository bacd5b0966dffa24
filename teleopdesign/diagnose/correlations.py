"""What the residual force still has in common with its own past, and with the command.

A right model leaves a residual that depends on neither. The residual is low-passed: below its
bandwidth B only samples 1/(2 B) apart are new, and only these count.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from ..measurement.filtering import Array
from ..measurement.prepare import Prepared
from ..model import Model
from ..realise.along_motion import residual_along
from .record_offsets import as_logged

#: standard deviations of an interval of 99 %
NINETY_NINE = float(ndtri(0.995))
#: most lags that are looked at, in samples 1/(2 B) apart
LAGS = 25


@dataclass(frozen=True)
class ResidualCorrelations:
    """Correlations of the residual force of one body, dimensionless, -1 to 1.

    lag: s, (2 k + 1,);  itself: with its own past, by the lag;  command: with the command, the
        residual later by the lag
    band: 99 % of the correlations of a residual that depends on neither are smaller
    """

    lag: Array
    itself: Array
    command: Array
    band: float


def residual_correlations(model: Model, prepared: Prepared, place: str) -> ResidualCorrelations:
    """Of the longest stretch of the check records, or of the fit records if there are none.

    raises ModelError: the model has no residual along the records
    """
    stretches = [s for s in prepared.of("check") or prepared.of("fit") if s.motion.body == place]
    stretch = max(stretches, key=lambda s: s.counted_time)
    motion, body = as_logged(model, stretch.motion), model.body(place)
    every = max(round(0.5 / stretch.motion.bandwidth / motion.sample_time), 1)
    at = stretch.keep[::every]
    left = motion.lowpassed(residual_along(body, motion).residual.value)[at]
    command = motion.lowpassed(motion.at_rows(motion.command))[at]
    count = min(LAGS, len(at) // 4)
    return ResidualCorrelations(
        np.arange(-float(count), count + 1) * (every * motion.sample_time),
        _correlation(left, left, count),
        _correlation(command, left, count),
        NINETY_NINE / float(np.sqrt(len(at))),
    )


def _correlation(cause: Array, effect: Array, count: int) -> Array:
    """Correlation of two signals, the second later by -count to count samples."""
    a, b = cause - np.mean(cause), effect - np.mean(effect)
    whole = np.correlate(b, a, "full") / max(float(np.linalg.norm(a) * np.linalg.norm(b)), 1e-300)
    middle = len(a) - 1
    return np.asarray(whole[middle - count : middle + count + 1])
