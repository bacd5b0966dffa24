"""The fit of a model as its user states it: effects without values, and delays of its logs.

With a model that lacks much, a shift may imitate a part of the missing force, as a wrong effect
would. So, like an effect, a shift must not raise the error on the check records. Otherwise it is
held at zero, or at the shift of the arm's other joints, whichever leaves less: one logger writes
all joints in one row, so their shifts are one, unless the check records refute it.

A shift at its bound stands for a part of a dead time that is longer than a logger's. If a dead time
instead of the shift surely leaves less on the check records, the whole delay is physical, and the
shift is held as above, so that candidates can explain it. Otherwise the error with a shift at its
bound may be too small for a search, and a late actuator would seem adequate.

The filter of a force sensor delays the hand's force against the command, and an `actuator_lag` can
imitate this. So the time constant of the filter is estimated where more than noise is left. It is
accepted if its gain is surely more than chance and more than that of every effect.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..base.errors import ModelError
from ..blocks import Value
from ..measurement.prepare import Prepared
from ..measurement.record_clock import CLOCK
from ..model import Model
from .candidates import Candidate, bodies_with_measured_force, make_starts
from .criteria import CRITERIA
from .decision import is_better
from .evidence import check_score, check_squares, is_adequate
from .fit import Fit, estimate, fit_squares
from .noise_floor import NoiseFloor
from .ranking import Ranked
from .record_shift import name_of_hand, shifts_of
from .rung import Replaced, restore_replaced
from .search import estimate_best_start, estimate_from_starts
from .search_plan import PLAN
from .simulated_course import dead_times


def estimate_stated(model: Model, prepared: Prepared) -> Fit:
    """The best fit of a stated model with the shifts of its logs, as every ladder begins."""
    fit = with_late_starts(estimate_values(model, prepared), model, prepared)
    return with_paying_shift(fit, prepared)


def estimate_values(model: Model, prepared: Prepared) -> Fit:
    """The best fit of a stated model: all effects without values at once, or one at a time.

    An effect of several parameters may be misled while other effects are far from their values:
    bristles become rigid where Coulomb's level starts too low. Added to the fit of the other
    effects, it starts like a candidate.
    """
    together = estimate_from_starts(model, prepared)
    bare, missing = _take_out_absent(model)
    if not missing or len(model.absent) == 1:
        return together
    return min((together, _estimate_one_by_one(bare, missing, prepared)), key=fit_squares)


def _estimate_one_by_one(bare: Model, missing: list[Replaced], prepared: Prepared) -> Fit:
    """The fit after these effects were added in turn, each time the one that explains most."""
    fit = estimate_from_starts(bare, prepared)
    while missing:
        fits = {
            one.effect.key: estimate_from_starts(one.back_in(fit.model), prepared, fit, worth=0.0)
            for one in missing
            if not fit.model.body(one.effect.at).lacks(one.effect.effect)
        }
        best = min(fits, key=lambda key: fit_squares(fits[key]))
        fit, missing = fits[best], [one for one in missing if one.effect.key != best]
    return estimate(fit.model, prepared)


def _take_out_absent(model: Model) -> tuple[Model, list[Replaced]]:
    """The model without its absent effects of several parameters, and these effects.

    An absent effect stays where an effect with values needs it.
    """
    absent, rest = [], [Candidate(model.body(at).effect(n), at) for n, at in model.absent]
    rest = [one for one in rest if len(one.effect.parameters) > 1]
    whole = model
    for _ in range(len(rest)):  # an effect that another one needs is removed after it
        for one in list(rest):
            try:
                model = model.without_effect(one.effect.name, at=one.at)
            except ModelError:
                continue
            absent.append(restore_replaced(one, whole))
            rest.remove(one)
    return model, absent


def with_late_starts(fit: Fit, stated: Model, prepared: Prepared) -> Fit:
    """The fit, or a fit that started from a log late by many rows, where that leaves less.

    A log that is late by many rows has a second, worse minimum at a delay of few rows, which a
    search from small delays does not leave.

    fit: of the model as its user stated it
    """
    for shift in shifts_of(fit.model, prepared.stretches):
        if shift.latest <= CLOCK.early * shift.row:
            continue
        start = make_starts(stated, prepared.scales)[0]
        for part in PLAN.late_starts:
            shifts = {**fit.model.record_shift, shift.at: Value(part * shift.latest)}
            rough = estimate_best_start([start.with_record_shift(shifts)], (), prepared)
            if fit_squares(rough) < (1.0 - PLAN.distinct_minimum) * fit_squares(fit):
                fit = min((fit, estimate(rough.model, prepared)), key=fit_squares)
    return fit


def with_paying_shift(fit: Fit, prepared: Prepared) -> Fit:
    """The fit with each body's shift estimated or held, whichever has the lowest check error.

    A shift is held at zero, or at that of the other joints. At its bound it is held too where it
    stands for a dead time.

    fit: with shifts of either kind
    returns: the fit itself where no change leaves less
    """
    known = [Value(0.0, fixed=True)]
    if prepared.late_beside is not None:
        known.append(Value(prepared.late_beside, fixed=True))
    for place, late in fit.model.record_shift.items():
        here = (late.value, True) if late.fixed else (0.0, False)
        for other in (Value(0.0), *known):
            if (other.value, other.fixed) == here:
                continue
            again = _with_shift(fit, place, other, prepared)
            if again.check_error < fit.check_error:
                fit = again
    for shift in shifts_of(fit.model, prepared.stretches):
        if shift.at not in fit.model.bodies:  # a shift of the hand's force: there is no actuator
            continue
        if shift.at_bound and shift.late < 0.0 and _stands_for_a_delay(fit, shift.at, prepared):
            fit = _with_shift(fit, shift.at, known[-1], prepared)
    return fit


def with_late_hand(
    fit: Fit, supported: Sequence[Ranked], floor: NoiseFloor, prepared: Prepared
) -> Fit | None:
    """The fit with the low-pass of a hand's force sensor estimated; None where it is not accepted.

    It is accepted where the fit leaves more than noise, the low-pass lowers the error enough, and
    no supported effect lowers it more.

    supported: effects that the records support in addition to the fit
    """
    least = min((check_squares(r.fit) for r in supported), default=float("inf"))
    if is_adequate(fit, floor):
        return None
    touched = {
        s.motion.body
        for s in prepared.stretches
        if np.ptp(s.motion.interaction) > 0.0 and s.motion.links is None
    }
    for hand in (name_of_hand(body) for body in sorted(touched)):
        if hand in fit.model.record_shift:
            continue
        late = _with_shift(fit, hand, Value(0.0), prepared)
        if late.model.log_late(hand) <= 0.0:  # a sensor cannot be early
            continue
        if check_squares(late) < least and is_better(fit, late, floor):
            return late
    return None


def _with_shift(fit: Fit, place: str, shift: Value, prepared: Prepared) -> Fit:
    """The fit of the same model with another shift of one body's records."""
    shifts = {**fit.model.record_shift, place: shift}
    return estimate(fit.model.with_record_shift(shifts), prepared)


def _stands_for_a_delay(fit: Fit, place: str, prepared: Prepared) -> bool:
    """Whether a dead time in place of a shift at its bound surely leaves less on check records."""
    late = _with_dead_time(fit.model, place, prepared)
    return late is not None and check_score(fit, estimate(late, prepared)) > CRITERIA.significance


def _with_dead_time(model: Model, place: str, prepared: Prepared) -> Model | None:
    """The model with the shift as a dead time of the actuator; None: it cannot have one."""
    body = model.body(place)
    if dead_times(body) or place in bodies_with_measured_force(prepared.experiment):
        return None
    for effect in model.known.values():
        if effect.role != "actuation" or body.has(effect.name):
            continue
        if body.lacks(effect) or body.axis in effect.counterparts:
            continue
        late = model.with_effect(effect, at=place)
        names = dead_times(late.body(place))
        if len(names) == 1:
            shifts = {**model.record_shift, place: Value(0.0)}
            dead_time = {f"{place}.{names[0]}": -model.log_late(place)}
            return late.with_values(dead_time).with_record_shift(shifts)
    return None
