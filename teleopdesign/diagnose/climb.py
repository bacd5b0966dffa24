"""The climb of one ladder: effects added one at a time, each supported by check records."""

from __future__ import annotations

from dataclasses import replace

from .adequacy import is_a_tone
from .conclusion import remove_doubtful_rung, with_last_corrected
from .ladder_state import LadderSearch, LadderState, look
from .moves import add, add_two, swap
from .noise_floor import noise_floor
from .rung import Rung
from .stand_in import stands_in_for_readings, stands_in_for_values
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

    First, a supported effect is added. Where there is none, another effect takes the place of one
    that the records do not tell from it. Where more than a tone is left, two effects are tried that
    mask each other, and a transmission with friction behind it, because a search with one of the
    two does not lead to the other.

    pairs: whether two effects may be added at once
    """
    may_grow = state.step <= search.plan.most_effects
    moved = add(search, state) if may_grow else None
    moved = moved or swap(search, state)
    if moved is not None or not (may_grow and pairs):
        return moved
    if is_a_tone(state.fit, state.tone, state.floor):
        return None
    return add_two(search, state) or add_transmission(search, state)
