"""The bandwidth of the comparison: whether the position still shows a certain motion there."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..diagnose.adequacy import is_adequate
from ..diagnose.fit import estimate
from ..diagnose.narrower_band import narrower_band
from ..diagnose.noise_floor import noise_floor
from ..diagnose.prepare import Prepared
from ..finding import Finding
from ..measurement.bandwidth import hides_motion, motion_beyond, share_in_motion
from ..measurement.experiment import Experiment
from ..model import Model

#: a bandwidth is proposed if the rows in motion are at least this part of those at a bandwidth two
#: octaves lower
ENOUGH = 0.9


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
        if not hides_motion(experiment, body, stated):
            continue
        shares = {b: share_in_motion(experiment, body, b) for b in (stated / 2, stated / 4)}
        moving, could = share_in_motion(experiment, body, stated), shares[stated / 4]
        proposed = max(b for b, share in shares.items() if share >= ENOUGH * could)
        yield Finding(
            "bandwidth",
            "warning",
            f"below {stated:.3g} Hz, the bandwidth of the comparison, the position tells a motion "
            f"in {100 * moving:.0f} % of the rows, below {proposed:.2g} Hz in "
            f"{100 * shares[proposed]:.0f} %. In the other rows static friction balances any "
            f"force, and no model is tested: write bandwidth = {{ value = {proposed:.2g}, "
            'unit = "Hz" } at comparison, or leave it out.',
            {"bandwidth": stated, "proposed": proposed, "seen": moving, "could": could},
            body,
        )


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
