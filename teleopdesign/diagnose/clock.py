"""Whether a shift of the records' clock pays: it counts only where it explains unseen records.

Estimated on the fit records beside a model that lacks much, a shift may take up a part of what is
missing, as a wrong effect would. Like an effect it must not raise the error on the check records.

A shift that ends at its bound describes a part of a dead time that is longer than a logger's. Where
a dead time in its place surely leaves less on the check records, all of it is physics, and the
shift is held at none: the candidates are held against the model without it. Otherwise what a shift
at its bound leaves may be too little for a search, and a late actuator passes for an adequate one.
"""

from __future__ import annotations

from ..blocks import Value
from ..model import Model
from .candidates import bodies_with_measured_force, make_starts
from .criteria import CRITERIA
from .evidence import check_score
from .fit import Fit, estimate, fit_squares, rough_fit
from .prepare import Prepared
from .record_shift import CLOCK, shifts_of
from .search_plan import PLAN
from .simulated_course import dead_times


def with_late_starts(fit: Fit, stated: Model, prepared: Prepared) -> Fit:
    """The fit, or one that began with a log much later than a row, where that leaves less.

    Beside the fit of a log that is late by many rows lies a poor one that is late by few, and its
    parameters lead nowhere else.
    fit: of the model as its user stated it
    """
    for shift in shifts_of(fit.model, prepared.stretches):
        if shift.latest <= CLOCK.early * shift.row:
            continue
        start = make_starts(stated, prepared.scales)[0]
        for part in PLAN.late_starts:
            shifts = {**fit.model.record_shift, shift.at: Value(part * shift.latest)}
            rough = rough_fit(start.with_record_shift(shifts), prepared)
            if fit_squares(rough) < (1.0 - PLAN.elsewhere) * fit_squares(fit):
                fit = min((fit, estimate(rough.model, prepared)), key=fit_squares)
    return fit


def with_paying_shift(fit: Fit, prepared: Prepared) -> Fit:
    """The fit with each body's shift estimated, or held at none, whichever leaves less unseen.

    One at its bound is held at none too where it stands for a dead time.
    fit: with shifts of either kind;  returns: the fit itself where the other kind leaves no less
    """
    for place, late in fit.model.record_shift.items():
        again = _with_shift(fit, place, Value(0.0, fixed=not late.fixed), prepared)
        if again.check_error < fit.check_error:
            fit = again
    for shift in shifts_of(fit.model, prepared.stretches):
        if shift.at_bound and shift.late < 0.0 and _stands_for_a_delay(fit, shift.at, prepared):
            fit = _with_shift(fit, shift.at, Value(0.0, fixed=True), prepared)
    return fit


def _with_shift(fit: Fit, place: str, shift: Value, prepared: Prepared) -> Fit:
    """The fit of the same model with another kind of shift of one body's records."""
    shifts = {**fit.model.record_shift, place: shift}
    return estimate(fit.model.with_record_shift(shifts), prepared)


def _stands_for_a_delay(fit: Fit, place: str, prepared: Prepared) -> bool:
    """Whether a dead time in the place of a shift at its bound surely leaves less unseen."""
    late = _with_dead_time(fit.model, place, prepared)
    return late is not None and check_score(fit, estimate(late, prepared)) > CRITERIA.sure


def _with_dead_time(model: Model, place: str, prepared: Prepared) -> Model | None:
    """The model with the shift as a dead time of the actuator; None where none could be missing."""
    body = model.body(place)
    if dead_times(body) or place in bodies_with_measured_force(prepared.experiment):
        return None
    for effect in model.known.values():
        if effect.role != "actuation" or body.lacks(effect) or body.axis in effect.elsewhere:
            continue
        late = model.with_effect(effect, at=place)
        names = dead_times(late.body(place))
        if len(names) == 1:
            shifts = {**model.record_shift, place: Value(0.0)}
            dead_time = {f"{place}.{names[0]}": -model.command_late(place)}
            return late.with_values(dead_time).with_record_shift(shifts)
    return None
