"""The bandwidth of the comparison: whether the position still shows a certain motion there."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..base.finding import Finding
from ..diagnose.adequacy import is_adequate
from ..diagnose.fit import estimate
from ..diagnose.narrower_band import narrower_band
from ..diagnose.noise_floor import noise_floor
from ..measurement.bandwidth import motion_beyond
from ..measurement.experiment import Experiment
from ..measurement.hidden_motion import find_hidden_motion
from ..measurement.prepare import Prepared
from ..model import Model


def check_bandwidth(model: Model, prepared: Prepared) -> Iterator[Finding]:
    """Findings on a bandwidth that is too high for the position readings, or below the motion.

    A bandwidth is too high where far fewer rows show a certain motion than at a lower one, or where
    the user's model leaves far more than at a lower one, and more than noise.
    """
    experiment, stated = prepared.experiment, prepared.bandwidth
    narrower = narrower_band(model, prepared)
    if narrower is not None and not _leaves_noise(model, prepared):
        numbers = {"bandwidth": stated, "proposed": narrower.bandwidth, "error": narrower.error}
        yield Finding("bandwidth", "warning", f"{narrower}.", numbers)
    else:
        yield from _motion_beyond(experiment, stated)
    for body in experiment.bodies:
        hidden = find_hidden_motion(experiment, body, stated)
        if hidden is None:
            continue
        numbers = {"bandwidth": stated, "proposed": hidden.proposed, "seen": hidden.moving}
        numbers["could"] = hidden.could
        yield Finding("bandwidth", "warning", str(hidden), numbers, body)


def _leaves_noise(model: Model, prepared: Prepared) -> bool:
    """Whether a model leaves only the errors of the readings, which grow with the bandwidth."""
    fit = estimate(model, prepared)
    return is_adequate(fit, noise_floor(fit.model, prepared, np.random.default_rng(0)))


def _motion_beyond(experiment: Experiment, chosen: float) -> Iterator[Finding]:
    """A finding where the motion exceeds the noise of its readings above the chosen bandwidth."""
    highest = motion_beyond(experiment, chosen)
    if highest is None:
        return
    yield Finding(
        "motion beyond the bandwidth",
        "note",
        f"the comparison ends at {chosen:.3g} Hz, but the motion exceeds the noise of its "
        f"readings up to {highest:.3g} Hz. To compare forces that change so fast, such as cogging "
        f'at speed, write bandwidth = {{ value = {highest:.3g}, unit = "Hz" }} at comparison.',
        {"bandwidth": chosen, "proposed": highest},
    )
