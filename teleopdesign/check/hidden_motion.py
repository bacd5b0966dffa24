"""Records with too few rows in motion: where friction holds the body, no model is tested.

The higher the bandwidth of the comparison, the more reading error is in the velocity. Rows in which
it cannot be distinguished from rest test no model with dry friction.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ..base.finding import Finding
from ..measurement.bandwidth import HIGHEST, LOWEST
from ..measurement.encoder import rests
from ..measurement.experiment import Experiment
from ..measurement.limits import HALF, NEARLY_ALL
from ..measurement.motion import motions
from ..measurement.prepare import Prepared, Stretch
from ._recording import CheckedRecording, RecordingCheck

if TYPE_CHECKING:
    from ..model import Model

#: independent values for each free parameter, at which the smaller model fails, from which a
#: larger one counts, and fewest that check a model: as many again are left to contradict it.
#: Lower: chance is named; higher: short records say nothing
FOR_EACH = 2.0


def find_hidden_motion(recording: CheckedRecording) -> Iterator[Finding]:
    """Bandwidths that hide a motion, and records in which too little moves to test a model."""
    if recording.prepared is None:
        return
    model, prepared = recording.compared
    motions = [s.motion for s in prepared.of("check")]
    if motions and all(rests(m.position, m.step) for m in motions):
        sentence = (
            "The body rests throughout the check records, where any friction explains the force: "
            "they cannot check a model. Choose check records in which the body moves."
        )
        yield Finding("hidden motion", "warning", sentence, stops=True)
    why, least = _lack_of_motion(prepared, model)
    is_mended = False
    for body in prepared.experiment.bodies:
        numbers = _band_that_shows_more(prepared, body)
        if numbers and numbers["proposed"] * numbers["shown"] >= least:
            is_mended = True
            sentence = (
                f"Below {prepared.bandwidth:.3g} Hz, the bandwidth of the comparison, the position "
                f"tells a motion in {100 * numbers['seen']:.0f} % of the rows, below "
                f"{numbers['proposed']:.2g} Hz in {100 * numbers['shown']:.0f} %. In the other "
                "rows static friction balances any force, and no model is tested: write bandwidth "
                f'= {{ value = {numbers["proposed"]:.2g}, unit = "Hz" }} at comparison, or leave '
                "it out."
            )
            yield Finding("bandwidth", "warning", sentence, numbers, body, stops=bool(why))
    if why and not is_mended:
        yield Finding("hidden motion", "warning", why, stops=True)


CHECK = RecordingCheck(order=210, find=find_hidden_motion, may_stop=True)


def _band_that_shows_more(prepared: Prepared, body: str) -> dict[str, float]:
    """Bandwidths (Hz) and shares of the rows (0 to 1) in which they show a motion of a body.

    "bandwidth" of the comparison and "seen" there; "could" be seen two octaves below; the highest
    one "proposed" that shows most of this, and "shown" there. Empty where little is hidden.
    """
    experiment, bandwidth = prepared.experiment, prepared.bandwidth
    lower = (bandwidth / 2, bandwidth / 4)
    shares = {b: _share_in_motion(experiment, body, b) for b in (bandwidth, *lower)}
    could = shares[lower[1]]
    if lower[1] < LOWEST or shares[bandwidth] >= HALF * could:
        return {}
    proposed = max(b for b in lower if shares[b] >= NEARLY_ALL * could)
    numbers = {"bandwidth": bandwidth, "proposed": proposed, "seen": shares[bandwidth]}
    return numbers | {"could": could, "shown": shares[proposed]}


def _share_in_motion(experiment: Experiment, body: str, bandwidth: float) -> float:
    """Share (0 to 1) of the fitted rows in which the position shows a direction of motion.

    bandwidth: Hz. A wider band leaves more reading error in the velocity. Where a velocity cannot
        be distinguished from rest, friction balances any force, so no model can be rejected there.
    """
    resolution = experiment.channels[f"{body}.position"].resolution
    directions = [
        motion.direction != 0
        for record in experiment.fit_records
        if bandwidth <= HIGHEST / record.sample_time
        for motion in motions(record, body, bandwidth=bandwidth, resolution=resolution)
    ]
    return float(np.mean(np.concatenate(directions))) if directions else 0.0


def _lack_of_motion(prepared: Prepared, model: Model) -> tuple[str, float]:
    """Why the records test the model too little, and the bandwidth (Hz) at which each row would do.

    Below a bandwidth B a signal holds 2 B independent values a second. Rows of a fit hold at least
    as many as parameters are estimated from them, and those of a check `FOR_EACH`.

    returns: "" and 0 where the records test it enough
    """
    estimated = float(sum(not v.fixed for v in model.parameters.values()))
    for use, least in (("fit", estimated), ("check", FOR_EACH)):
        stretches = prepared.of(use)
        seconds = sum(_tested_time(s, model) for s in stretches)
        if stretches and 2.0 * prepared.bandwidth * seconds < least:
            sentence = (
                f"The position tells a motion for only {seconds:.2g} s of the {use} records. At "
                "other times static friction balances any force, and no model is tested: record "
                "more motion."
            )
            return sentence, least / (2.0 * sum(s.counted_time for s in stretches))
    return "", 0.0


def _tested_time(stretch: Stretch, model: Model) -> float:
    """Time (s) for which a stretch tests the model of its body."""
    motion = stretch.motion
    if model.body(motion.body).level() == 0:
        return stretch.counted_time
    moving = np.count_nonzero(motion.direction[stretch.keep])
    return moving * stretch.weight * motion.sample_time
