"""The bandwidth of the comparison: whether the position still shows the motion, and all of it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..base.finding import Finding
from ..check import CheckedRecording, RecordingCheck
from ..diagnose.evidence import is_adequate
from ..diagnose.fit import estimate
from ..diagnose.narrower_band import narrower_band
from ..diagnose.noise_floor import noise_floor
from ..measurement.bandwidth import motion_beyond
from ..measurement.prepare import Prepared
from ..model import Model


def find_wrong_bandwidth(recording: CheckedRecording) -> Iterator[Finding]:
    """As `check_bandwidth`, for the user's model."""
    yield from check_bandwidth(*recording.compared)


CHECK = RecordingCheck(
    order=10, find=find_wrong_bandwidth, unless={"swapped columns": "make the columns agree"}
)


def check_bandwidth(model: Model, prepared: Prepared) -> Iterator[Finding]:
    """A finding on a bandwidth at which a model leaves far more than noise and than at a lower one.

    Otherwise one where the motion exceeds the noise of its readings above the chosen bandwidth.
    """
    chosen = prepared.bandwidth
    narrower = narrower_band(model, prepared)
    if narrower is not None and not _leaves_noise(model, prepared):
        numbers = {"bandwidth": chosen, "proposed": narrower.bandwidth, "error": narrower.error}
        yield Finding("bandwidth", "warning", f"{narrower}.", numbers)
    elif (highest := motion_beyond(prepared.experiment, chosen)) is not None:
        sentence = (
            f"the comparison ends at {chosen:.3g} Hz, but the motion exceeds the noise of its "
            f"readings up to {highest:.3g} Hz. To compare forces that change so fast, such as "
            f"cogging at speed, write bandwidth = {{ value = {highest:.3g}, "
            'unit = "Hz" } at comparison.'
        )
        numbers = {"bandwidth": chosen, "proposed": highest}
        yield Finding("motion beyond the bandwidth", "note", sentence, numbers)


def _leaves_noise(model: Model, prepared: Prepared) -> bool:
    """Whether a model leaves only the errors of the readings, which grow with the bandwidth."""
    fit = estimate(model, prepared)
    return is_adequate(fit, noise_floor(fit.model, prepared, np.random.default_rng(0)))
