"""The climb of one ladder: effects added one at a time, each supported by check records.

An effect that lowers the error without explaining it imitates something else, and is barred.

Values that the fit records do not determine (for example friction and damping, at one speed): if a
check record moves as no fit record does, a complete model has an error there too. An effect that
changes these values may seem to explain the error. So the model is estimated on all records
together, with the effect and without it. The effect must still leave less of the check records, and
surely less of all records, for all were fitted.

Errors of the readings: a structure transmits less of the noise in an acceleration. The error may
    then be smaller, and yet be more noise floors of the new model. In a record with few events (a
    motor that sticks and slips under a coarse encoder) a lag may follow the errors themselves.
"""

from __future__ import annotations

from dataclasses import replace

from ..base.sentences import percent
from ..measurement.prepare import Prepared
from .conclusion import estimable_on_all, remove_doubtful_rung, with_last_corrected
from .criteria import CRITERIA
from .decision import is_better
from .error import force_error
from .fit import Fit, estimate
from .ladder_state import LadderSearch, LadderState, look
from .moves import add, add_two, swap
from .noise_floor import NoiseFloor, noise_floor, say_floors
from .rung import Rung
from .statements import SetAside
from .swap_for_two import swap_for_two
from .transmission import add_transmission


def climb(search: LadderSearch, state: LadderState) -> tuple[LadderState, tuple[Rung, ...]]:
    """The state where the ladder ends, and its rungs with their final errors.

    By these errors an effect may be set aside; the ladder then continues without it, once. What
    comes in its place is often as little there.
    """
    removed = len(state.set_aside)  # those that all joints of an arm together did not support
    while True:
        while removed <= 1 and (moved := make_next_move(search, state, pairs=not removed)):
            barred = bar_what_explains_nothing(search, state, moved)
            if barred is None:
                state = look(search, moved.rungs, moved)
                continue
            stays = len(barred.supported) == len(state.supported)
            state = barred
            if stays:  # no candidate was removed: the same move would follow again
                break
        rungs = with_last_corrected(search, state) if search.is_of_body_in_time else state.rungs
        less = remove_doubtful_rung(search, state, rungs)
        if less is None:
            return state, rungs
        state, removed = look(search, less.rungs, less), removed + 1


def bar_what_explains_nothing(
    search: LadderSearch, state: LadderState, moved: LadderState
) -> LadderState | None:
    """The state before a move, with the move's new effects barred; None: they explain something.

    An effect is barred if it only does what other values of the model do as well, or only weakens
    the errors of the readings. A move that replaces rungs is exempt: it may explain as much as they
    did, more simply.
    """
    before, after = ({r.added.key for r in s.rungs if r.added} for s in (state, moved))
    new = [r for r in moved.rungs if r.added is not None and r.added.key not in state.effects]
    if not search.is_of_body_in_time or not new or not before <= after:
        return None
    if moved.fit.check_error >= state.fit.check_error:
        return None
    last = replace(new[-1], fit=moved.fit)
    prepared = search.prepared
    drawn = noise_floor(moved.fit.model, prepared, search.generator())
    barred = stands_in_for_readings(state.fit, state.floor, last, drawn) or stands_in_for_values(
        state.fit, last, prepared, state.floor
    )
    if barred is None:
        return None
    gone = {r.added.key for r in new if r.added is not None}
    search.progress(f"set aside: {barred}")
    state = replace(
        state,
        supported=tuple(r for r in state.supported if r.candidate.key not in gone),
        set_aside=(*state.set_aside, barred),
    )
    return state.with_floor_limited() if barred.of_readings else state


def make_next_move(search: LadderSearch, state: LadderState, *, pairs: bool) -> LadderState | None:
    """The state after the next move; None: the ladder ends here.

    Two simpler effects take the place of the last one where they leave clearly less. Else, a
    supported effect is added. Where there is none, another effect takes the place of one
    that the records do not tell from it. Where more than a tone is left, two effects are tried that
    mask each other, and a transmission with friction behind it, because a search with one of the
    two does not lead to the other.

    pairs: whether two effects may be added at once
    """
    may_grow = state.step <= search.plan.most_effects
    moved = swap_for_two(search, state)
    moved = moved or (add(search, state) if may_grow else None)
    moved = moved or swap(search, state)
    if moved is not None or not (may_grow and pairs):
        return moved
    if state.tone.holds_all_but_noise(state.fit, state.floor):
        return None
    return add_two(search, state) or add_transmission(search, state)


def stands_in_for_values(
    base: Fit, rung: Rung, prepared: Prepared, floor: NoiseFloor
) -> SetAside | None:
    """The effect of a rung that other values of the base explain as well, with the reason.

    base: the fit without the rung;  returns: None where the effect explains more
    """
    together = estimable_on_all(prepared)
    if together is None or rung.added is None:
        return None
    without, with_it = (estimate(fit.model, together) for fit in (base, rung.fit))
    before, after = (force_error(f.model, prepared.of("check")) for f in (without, with_it))
    falls = after**2 < (1.0 - CRITERIA.relative_improvement) * before**2
    if falls and is_better(without, with_it, floor):
        return None
    reason = (
        f"a fit to all records leaves {percent(before, '.3g')} of the check records without it, "
        f"{percent(after, '.3g')} with it: the fit records do not determine its values"
    )
    return SetAside(rung.added, rung.fit.check_error, reason)


def stands_in_for_readings(
    base: Fit, before: NoiseFloor, rung: Rung, after: NoiseFloor
) -> SetAside | None:
    """The effect of a rung that only weakens the error of sensor readings, with the reason.

    before, after: the noise floors of the two models, as drawn
    Where the readings alone explain the error of the base, an effect that weakens their error must
    leave surely fewer noise floors.
    returns: None where the effect leaves fewer noise floors too, or the base more than noise
    """
    if rung.added is None or not (before.drawn and after.drawn):
        return None
    left, leaves = base.check_error / before.drawn, rung.fit.check_error / after.drawn
    if not is_of_readings(left):
        return None
    if after.drawn < CRITERIA.weakened * before.drawn:
        explains = leaves <= CRITERIA.weakened * left
    else:
        explains = leaves <= CRITERIA.adequate or CRITERIA.weakened * leaves <= left
    if explains:
        return None
    floors, without = say_floors(leaves, ".2g"), say_floors(left, ".2g")
    reason = (
        f"lowers the error from the readings of the sensors, from {100 * before.drawn:.2g} to "
        f"{percent(after.drawn, '.2g')} of the force, but leaves {floors} noise floors, "
        f"{without} without it"
    )
    return SetAside(rung.added, rung.fit.check_error, reason, of_readings=True)


def is_of_readings(floors: float) -> bool:
    """Whether the readings alone explain an error of so many noise floors.

    A floor is known to a fifth. Where even less is left, the values of the model make more of the
    readings' errors than these can contain, and say nothing.
    """
    return CRITERIA.weakened <= floors <= CRITERIA.adequate
