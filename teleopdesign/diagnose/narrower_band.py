"""Bandwidth of a comparison that is too wide: the same model leaves far less in a narrower band.

Steps that the filter of a firmware has smoothed, or steps coarser than stated, look like a motion.
Their second derivative is an acceleration that no force explains. Example: a trolley with a
filtered potentiometer, where the model leaves 80 % up to 9.4 Hz, and 18 % up to 2.3 Hz, there with
mass and friction near the documented ones. An effect at high frequencies only, such as a resonance,
looks the same.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import ExperimentError
from ..measurement.bandwidth import LOWEST
from ..model import Model
from .criteria import CRITERIA, Criteria
from .fit import Fit, estimate
from .prepare import Prepared, prepare


@dataclass(frozen=True)
class NarrowerBand:
    """A bandwidth (Hz) and what a model leaves there, beside the chosen one and what it leaves."""

    bandwidth: float
    error: float
    chosen: float
    error_at_chosen: float

    def __str__(self) -> str:
        return (
            f"up to {self.bandwidth:.3g} Hz this model leaves {100 * self.error:.2g} % of the "
            f"force, up to {self.chosen:.3g} Hz {100 * self.error_at_chosen:.2g} %. Either the "
            "position sensor is filtered or coarser than stated, and shows accelerations that "
            "did not occur, or an effect at high frequencies is missing: try bandwidth = "
            f'{{ value = {self.bandwidth:.3g}, unit = "Hz" }} at comparison'
        )


def narrower_band(
    model: Model, prepared: Prepared, *, criteria: Criteria = CRITERIA
) -> NarrowerBand | None:
    """The widest band in which a model leaves far less than in the band of the comparison.

    None: nowhere, or the experiment states its bandwidth
    """
    experiment, chosen = prepared.experiment, prepared.bandwidth
    if experiment.bandwidth is not None or 0.25 * chosen < LOWEST:
        return None
    here, best = _error(estimate(model, prepared)), None
    for part in (0.25, 0.5):  # a quarter tells, then the widest is taken
        try:
            narrower = prepare(experiment, bandwidth=part * chosen)
        except ExperimentError:
            return best
        there = _error(estimate(model, narrower))
        if not criteria.falls * there < here:
            break
        best = NarrowerBand(part * chosen, there, chosen, here)
    return best


def _error(fit: Fit) -> float:
    """Error on the check records, or on the fit records where there are no others."""
    return fit.fit_error if math.isnan(fit.check_error) else fit.check_error
