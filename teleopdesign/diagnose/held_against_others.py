"""Effects of one joint tested on the whole arm: which stay when all joints are estimated together.

The records of one joint may support an effect that imitates a missing effect of another joint, or
an error of the links' parameters. When all joints are estimated together, such an effect no longer
lowers the error, and is set aside.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import takewhile

from .criteria import CRITERIA
from .decision import is_better
from .ladder_state import look
from .noise_floor import noise_floor
from .part_search import PartSearch
from .parts import PreparedParts
from .parts_fit import PartsFit, PartsRung, estimate_parts
from .stand_in import is_of_readings
from .statements import SetAside

#: reason why an effect is refused although the records of one joint supported it
NO_HELP = "it lowers the error no more once all joints are estimated together"
#: the same reason for an effect that only attenuates readings: error and noise floor fall together
NO_MORE_THAN_NOISE = "it only weakens the noise of the sensors"


def hold_against_others(
    joint: PartSearch, rungs: tuple[PartsRung, ...], prepared: PreparedParts
) -> tuple[PartSearch, tuple[PartsRung, ...]]:
    """The rungs of a joint's ladder, each with all joints estimated again.

    rungs: the ladder of the arm so far, those of this joint last; rungs that the joint's ladder
        still starts with are not estimated again
    returns: the joint, its ladder cut at the first refused effect, which is set aside; and the
        ladder of the arm with the joint's remaining rungs
    """
    there = [r for r in rungs if r.added is not None and r.added.at == joint.name]
    kept = _count_held(joint, there)
    longer = list(rungs[: len(rungs) - len(there) + kept - 1])
    waiting, why = list[PartsRung](), ""
    for i, rung in enumerate(joint.state.rungs[kept:], kept):
        last = waiting[-1] if waiting else longer[-1]
        models = {n: f.model for n, f in last.fit.fits.items()} | {joint.name: rung.fit.model}
        fit = estimate_parts(models, prepared)
        waiting.append(PartsRung(rung.added, fit, rung.instead_of, joint.other))
        why = refusal(joint, last.fit, fit)
        if why:
            break
        # of two effects that mask each other only the second helps, when both are in the model
        before, after = longer[-1].fit.fits[joint.name], fit.fits[joint.name]
        if is_better(before, after, joint.state.floor):
            longer, waiting, kept = [*longer, *waiting], [], i + 1
    if waiting:
        joint = _cut_ladder(joint, kept, waiting, why or NO_HELP)
    return joint, tuple(longer)


def _count_held(joint: PartSearch, there: Sequence[PartsRung]) -> int:
    """Number of leading rungs that the ladders of joint and arm share; the user's model counts."""
    ours = ((r.added, r.instead_of) for r in joint.state.rungs[1:])
    held = ((r.added, r.instead_of) for r in there)
    pairs = zip(held, ours, strict=False)
    return 1 + sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], pairs))


def refusal(joint: PartSearch, before: PartsFit, after: PartsFit) -> str:
    """Why an effect is removed once all joints are estimated together; "": it stays.

    An effect may transmit less of the sensor noise: the hidden tip of a structure follows the
    measured force and a part of its noise. Such an effect must lower the error more than the noise,
    and where the readings alone explain the error before, it must leave surely fewer noise floors.
    """
    if after.check_error > before.check_error:
        return NO_HELP
    records, name = joint.search.prepared, joint.name
    sensors, there = (
        noise_floor(fit.fits[name].model, records, joint.search.generator()).drawn ** 2
        for fit in (before, after)
    )
    kept = 1.0 - CRITERIA.relative_improvement
    if there >= kept * sensors:
        return ""
    left, leaves = (fit.check_errors[name] ** 2 for fit in (before, after))
    of_readings = sensors > 0.0 and is_of_readings((left / sensors) ** 0.5)
    most = CRITERIA.weakened**2 if of_readings else kept
    explains = leaves * sensors <= most * there * left
    return "" if explains else NO_MORE_THAN_NOISE


def _cut_ladder(joint: PartSearch, kept: int, refused: Sequence[PartsRung], why: str) -> PartSearch:
    """The joint with the first `kept` rungs of its ladder; the refused effects are set aside.

    refused: with all joints estimated again
    """
    state = joint.state
    aside = [
        SetAside(
            r.added, r.fit.check_errors[joint.name], why, of_readings=why == NO_MORE_THAN_NOISE
        )
        for r in refused
        if r.added is not None
    ]
    fewer = replace(state.with_rungs(state.rungs[:kept]), set_aside=(*state.set_aside, *aside))
    return replace(joint, state=look(joint.search, fewer.rungs, fewer))
