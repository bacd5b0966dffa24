"""Bandwidth of a comparison that is too wide: the same model leaves far less in a narrower band.

A position sensor may be coarser than stated, or its steps may be smoothed by the filter of a
firmware. Such steps look like a motion, and their second derivative is an acceleration that no
force explains. Example: a trolley with a filtered potentiometer. The model leaves 80 % up to 9.4
Hz, and 18 % up to 2.3 Hz, there with mass and friction near the documented ones. An effect at high
frequencies only, such as a resonance, looks the same.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from ..base.errors import ExperimentError
from ..base.sentences import percent
from ..measurement.bandwidth import LOWEST
from ..measurement.prepare import Prepared, prepare
from ..model import Model
from .criteria import CRITERIA
from .diagnosis import Diagnosis
from .evidence import Errors
from .fit import estimate


@dataclass(frozen=True)
class NarrowerBand:
    """A narrower bandwidth (Hz) and the error there, with the chosen bandwidth and its error.

    error, error_at_chosen: relative force errors of the same model, estimated in each band
    """

    bandwidth: float
    error: float
    chosen: float
    error_at_chosen: float

    def __str__(self) -> str:
        return (
            f"up to {self.bandwidth:.3g} Hz this model leaves {percent(self.error, '.2g')} of the "
            f"force, up to {self.chosen:.3g} Hz {percent(self.error_at_chosen, '.2g')}. Either the "
            "position sensor is filtered or coarser than stated, and shows accelerations that "
            "did not occur, or an effect at high frequencies is missing: try bandwidth = "
            f'{{ value = {self.bandwidth:.3g}, unit = "Hz" }} at comparison'
        )


def narrower_band(model: Model, prepared: Prepared) -> NarrowerBand | None:
    """The widest narrower band in which a model leaves far less than in the band of the comparison.

    A half and a quarter of the bandwidth are compared.
    returns: None where there is none, where the experiment states its bandwidth, or where a quarter
        is too low
    """
    experiment, chosen = prepared.experiment, prepared.bandwidth
    if experiment.bandwidth is not None or 0.25 * chosen < LOWEST:
        return None
    here, best = _error(estimate(model, prepared)), None
    # a quarter shows whether the error falls; then the widest band is taken
    for part in (0.25, 0.5):
        try:
            narrower = prepare(experiment, bandwidth=part * chosen)
        except ExperimentError:
            return best
        there = _error(estimate(model, narrower))
        if not CRITERIA.far_larger * there < here:
            break
        best = NarrowerBand(part * chosen, there, chosen, here)
    return best


def narrower_to_search(diagnosis: Diagnosis) -> NarrowerBand | None:
    """The band for a second search, where the first search leaves more than noise.

    returns: None where only noise is left, or the user's model leaves no less in a narrower band;
        for an arm, where a band is one for all joints, and for a friction curve, without time
    """
    if diagnosis.joints or diagnosis.kind or not diagnosis.more_is_missing:
        return None
    return narrower_band(diagnosis.before.model, diagnosis.prepared)


def choose_band(wide: Diagnosis, narrow: Diagnosis) -> Diagnosis:
    """The diagnosis in the narrower band if its final model leaves far less; else the first one.

    Where the final model explains the high frequencies, such as a resonance, its error is small in
    the wide band too.
    """
    if not CRITERIA.far_larger * _error(narrow.after) < _error(wide.after):
        return wide
    words = (
        f"all that is faster than {narrow.bandwidth:.3g} Hz: the final model of the "
        f"search up to {wide.bandwidth:.3g} Hz leaves {percent(_error(wide.after), '.2g')} of "
        "the force. Either the position sensor is filtered or coarser than stated, or an effect at "
        "high frequencies is missing"
    )
    return replace(narrow, left_out=(*narrow.left_out, words))


def _error(errors: Errors) -> float:
    """Error on the check records; on the fit records where there is no check error."""
    return errors.fit_error if math.isnan(errors.check_error) else errors.check_error
