"""A force that no law of the catalogue describes: the final model with a curve in its place.

Where more than noise is left, each curve of the catalogue that has no named law (`Effect.free`) is
added to the final model. Of those that explain most of what is left, the best is stated with its
model, so that work can go on with it. It is no candidate, and the verdict does not change. A curve
that explains less bends towards any other law.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from ..base.codec import INLINE, Error
from ..base.frozen import ByValue
from ..base.sentences import percent
from ..effects import EFFECTS, depends_on_position
from ..measurement.friction_curve import count_speeds
from ..measurement.prepare import Prepared
from ..model import Model
from .candidates import Candidate, fits_curve, tells_place_from_time
from .criteria import CRITERIA
from .decision import is_better
from .evidence import explained_share
from .fit import Fit
from .noise_floor import NoiseFloor
from .search import estimate_from_starts


@dataclass(frozen=True, eq=False)
class FreeForm(ByValue):
    """A curve through values that explains a force which no named law describes.

    candidate: the curve and its place;  model: the final model with it
    fit_error, check_error: of this model
    """

    candidate: Annotated[Candidate, INLINE]
    model: Model
    fit_error: Error
    check_error: Error

    def __str__(self) -> str:
        of = "position" if depends_on_position(self.candidate.effect) else "speed"
        what = "force" if of == "position" else "friction"
        return (
            f"no named law: a {what} of the {of} that no law of the catalogue describes is there; "
            f"with {self.candidate} the model leaves {percent(self.check_error, '.3g')} "
            f"(fit {percent(self.fit_error, '.3g')})"
        )


def free_form(fit: Fit, floor: NoiseFloor, prepared: Prepared) -> FreeForm | None:
    """The curve that leaves least beside the final model; None where none explains most of that.

    fit: of the final model, on these records. At a joint of an arm no curve is tried: the links
    would have to be estimated with it.
    """
    if prepared.is_linked:
        return None
    fits = {
        c: estimate_from_starts(fit.model.with_effect(c.effect, at=c.at), prepared, fit)
        for c in _curves(fit.model, prepared)
    }
    better = {
        c: one
        for c, one in fits.items()
        if is_better(fit, one, floor) and explained_share(fit, one, floor) >= CRITERIA.mostly
    }
    if not better:
        return None
    best = min(better, key=lambda c: better[c].check_error)
    one = better[best]
    return FreeForm(best, one.model, one.fit_error, one.check_error)


def _curves(model: Model, prepared: Prepared) -> list[Candidate]:
    """The curves that the bodies lack and that their motions can tell from a drift."""
    curves = []
    for place, body in model.bodies.items():
        motions = [s.motion for s in prepared.stretches if s.motion.body == place]
        separate = {s.motion.file for s in prepared.stretches if s.has_zero_offset}
        for effect in EFFECTS.values():
            if not effect.free or body.has(effect.name):
                continue
            if prepared.is_curve:
                speeds = count_speeds(motion.velocity for motion in motions)
                if not fits_curve(effect, model, speeds):
                    continue
            of_place = depends_on_position(effect)
            if of_place and not tells_place_from_time(motions, separate_zeros=separate):
                continue
            curves.append(Candidate(effect, place))
    return curves
