"""Whether records support a candidate, and which others they support as well."""

from __future__ import annotations

from .candidates import Candidate
from .diagnosis import is_adequate
from .evidence import chance
from .fit import Fit
from .noise_floor import NoiseFloor
from .rank import (
    RELEVANT,
    Ranked,
    Ranking,
    check_score,
    check_squares,
    refusal,
    seen_gain,
    seen_score,
    whole_score,
)
from .search import WORTH

#: a gain counts from this many standard deviations of its chance part, or, where it makes an
#: adequate model of one that is not, from what one catalogue in a hundred reaches by chance ...
SURE, BY_CHANCE = 4.0, 0.01
#: ... and from this part of the noise floor's square: while a body is stuck or turns, its friction
#: is known no better than that, and less may be the method's own
OF_FLOOR = 0.5
#: candidates that lie closer than this (standard deviations) explain the record equally well
CLOSE = 3.0


def is_supported(base: Fit, ranked: Ranked, floor: NoiseFloor) -> bool:
    """Whether a candidate can be told, lowers the check error enough, and leaves the rest in place.

    One that drives a parameter of the model to its bound takes the place of an effect that is
    there: it describes the records, but is no missing physics beside the model's own. One that
    needs a parameter of its own at its bound is itself another effect, unless it leaves noise only.
    """
    driven = set(ranked.fit.at_bound) - set(base.at_bound)
    own = [n for n in driven if n not in base.model.parameters]
    return (
        ranked.told
        and not displaced(base, ranked.fit)
        and (
            all(ranked.fit.model.declared(n).optional for n in own)
            or _settles(base, ranked.fit, floor)
        )
        and is_better(base, ranked.fit, floor)
    )


def displaced(base: Fit, found: Fit) -> list[str]:
    """Parameters driven to a bound whose effect the records tell from its absence in the base."""
    driven = set(found.at_bound) - set(base.at_bound)
    return sorted(n for n in driven if n in base.model.parameters and _is_there(base, n))


def _settles(base: Fit, other: Fit, floor: NoiseFloor) -> bool:
    """Whether `other` is an adequate model where the base was not."""
    return is_adequate(other, floor) and not is_adequate(base, floor)


def _is_there(base: Fit, name: str) -> bool:
    """Whether the records tell the effect that a parameter belongs to from its absence."""
    effect = name.rpartition(".")[0]
    values = {n: v for n, v in base.model.parameters.items() if n.rpartition(".")[0] == effect}
    return all(v.fixed or not v.stderr >= base.model.from_absence(n) for n, v in values.items())


def is_better(base: Fit, other: Fit, floor: NoiseFloor) -> bool:
    """Whether `other` has the smaller check error by more than chance and by enough to matter.

    In both figures: of the force, and seen at the command, where less force acting gains nothing.
    A force that is only smaller relative to what acts is no gain either.
    """
    before = check_squares(base)
    of_force = (before - check_squares(other)) / before
    return (
        not refusal(base, other)
        and other.check_error < base.check_error
        and _is_enough(base, other, of_force, check_score(base, other), floor)
        and _is_enough(base, other, seen_gain(base, other), seen_score(base, other), floor)
    )


def _is_enough(base: Fit, other: Fit, gain: float, score: float, floor: NoiseFloor) -> bool:
    """Whether so large a part of the squares, gained with this score, is more than chance."""
    return (
        (score > SURE or _settles(base, other, floor))
        and gain > RELEVANT
        and gain > OF_FLOOR * (floor.value / base.check_error) ** 2
        and chance(score) * len(base.model.known) < BY_CHANCE
    )


def worth_pursuing(base: Fit, floor: NoiseFloor) -> float:
    """Part of the base's squares from which a gain by a first step is worth following up.

    The floor is never above what a candidate leaves. So beside a base that leaves little more than
    its floor, only what takes away OF_FLOOR / (1 + OF_FLOOR) of the squares can be better: a first
    step that promises less than a third of that is not followed.
    """
    least = OF_FLOOR / (1.0 + OF_FLOOR)
    only_noise = OF_FLOOR * floor.value**2 >= least * base.check_error**2
    return least / 3.0 if only_noise else WORTH


def alike(supported: list[Ranked]) -> list[Ranked]:
    """Those of the supported candidates that explain the records as well as the best."""
    return [r for r in supported if r is supported[0] or _equal(r, supported[0])]


def equals_of(
    best: Ranked, ranking: Ranking, base: Fit, floor: NoiseFloor
) -> tuple[Candidate, ...]:
    """Candidates that the records do not tell from this one.

    One that needs more parameters to do as well explains nothing that the simpler does not.
    """
    supported = [r for r in ranking.ranked if is_supported(base, r, floor)]
    return tuple(
        r.candidate
        for r in alike(supported)
        if r is not best and simplicity(r)[0] == simplicity(best)[0]
    )


def _equal(one: Ranked, best: Ranked) -> bool:
    """Whether the records do not tell a candidate from the best one."""
    near = abs(one.fit.check_error - best.fit.check_error) < 0.02 * best.fit.check_error
    return near and whole_score(one.fit, best.fit) < CLOSE


def simplicity(ranked: Ranked) -> tuple[int, int]:
    """Parameters that must be estimated, and effects that must be there: fewer is simpler."""
    effect = ranked.candidate.effect
    return sum(not p.optional for p in effect.parameters.values()), len(effect.needs)
