"""What a diagnosis decides: what counts, which of several is taken, and the verdict.

Every threshold is a field of `Criteria`. There is one order of candidates: those that count come
first, then those that leave fewer squares on the check records (`rank_key`); among those that the
records do not tell from the best, the simplest is taken (`preferred`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .candidates import Candidate
from .criteria import CRITERIA, Criteria
from .evidence import (
    chance,
    check_score,
    check_squares,
    gain_at_command,
    score_at_command,
    whole_score,
)
from .fit import Fit
from .noise_floor import NoiseFloor
from .one_moment import Moment, worst_moment
from .outside_tone import Tone
from .prepare import Prepared
from .ranking import REFUSALS, Ranked, Ranking
from .rung import Rung


@dataclass(frozen=True)
class Floors:
    """The noise floor of a model, twice.

    drawn: what its readings, drawn anew, leave
    allowed: what counts as noise in decisions: never above what the records themselves leave, nor
        far above the floor of the user's model
    """

    drawn: NoiseFloor
    allowed: NoiseFloor


def bounded_by_what_is_left(drawn: NoiseFloor, here: Fit, ranking: Ranking) -> NoiseFloor:
    """The noise floor, at most the error of the model or of any identifiable candidate.

    Without what is missing a parameter may be led where sensor noise would ask for any force: what
    the records themselves leave shows that it does not. Moments of reading that jitter are seen in
    the readings, though: a candidate that leaves less than they make weakens what they make.
    """
    left = [here.check_error]
    if not drawn.jitters:
        left += [r.fit.check_error for r in ranking.ranked if r.counts]
    return replace(drawn, value=min(drawn.value, *left))


def allowed_floor(
    bounded: NoiseFloor, first: NoiseFloor, stated: Fit, *, criteria: Criteria = CRITERIA
) -> NoiseFloor:
    """A noise floor, limited by the first floor or by the error of the user's fitted model.

    An effect that makes sensors count for much more would hide what it leaves in their noise.
    """
    most = max(criteria.louder * first.value, criteria.hidden * stated.check_error)
    return bounded.at_most(most)


def is_noise(check_error: float, floor: NoiseFloor, *, criteria: Criteria = CRITERIA) -> bool:
    """Whether an error of this size on the check records counts as noise."""
    return check_error <= criteria.adequate * floor.value


def is_a_tone(fit: Fit, tone: Tone, floor: NoiseFloor, *, criteria: Criteria = CRITERIA) -> bool:
    """Whether a plain tone explains all but noise."""
    squares = check_squares(fit)
    left = fit.check_error * float(np.sqrt(tone.squares / squares)) if squares > 0.0 else 0.0
    return is_noise(left, floor, criteria=criteria)


def is_adequate(fit: Fit, floor: NoiseFloor, *, criteria: Criteria = CRITERIA) -> bool:
    """Whether the error on the check records counts as noise, as a force and at the command.

    A model that is blind in much of the motion says too little to be adequate.
    """
    command_error = fit.at_command
    at_command = (
        command_error.error <= criteria.adequate * floor.value_at_command
        and command_error.blind <= criteria.blind
    )
    return is_noise(fit.check_error, floor, criteria=criteria) and at_command


def floors_left(fit: Fit, floor: NoiseFloor) -> float:
    """Check error in noise floors: of the force or at the command, the larger."""
    if not (floor.value and math.isfinite(fit.at_command.error)):
        return float("inf")
    return max(fit.check_error / floor.value, fit.at_command.error / floor.value_at_command)


def explained(before: Fit, after: Fit, floor: NoiseFloor) -> float:
    """Share of the squares above the noise floor that the effects added between two fits explain.

    Of the force or seen at the command, the smaller part.
    """
    of_force = _taken_away(before.check_error, after.check_error, floor.value)
    return min(
        of_force,
        _taken_away(before.at_command.error, after.at_command.error, floor.value_at_command),
    )


def _taken_away(before: float, after: float, floor: float) -> float:
    return (before**2 - after**2) / max(before**2 - floor**2, 1e-300)


def refusal(base: Fit, other: Fit, *, criteria: Criteria = CRITERIA) -> str:
    """Why an addition to `base` does not count (a key of `REFUSALS`); "" where it may count.

    What makes the recorded force unpredictable has not explained it.
    """
    already = base.at_command.blind if base.at_command.blind > criteria.blind else 0.0
    if other.at_command.blind - already > criteria.blind:
        return "blind"
    if other.at_command.weak and not base.at_command.weak:
        return "weak"
    less = check_squares(other) < (1.0 - criteria.relevant) * check_squares(base)
    return "hides" if less and not gain_at_command(base, other) > criteria.relevant else ""


def is_better(base: Fit, other: Fit, floor: NoiseFloor, *, criteria: Criteria = CRITERIA) -> bool:
    """Whether `other` has the smaller check error by more than chance and by enough to matter.

    In both figures: of the force, and seen at the command, where less force acting gains nothing.
    A force that is only smaller relative to what acts is no gain either.
    """
    before = check_squares(base)
    of_force = (before - check_squares(other)) / before

    def is_enough(gain: float, score: float) -> bool:
        """Whether a gain of this share of the squares, at this score, is more than chance."""
        return (
            (score > criteria.sure or _makes_adequate(base, other, floor, criteria))
            and gain > criteria.relevant
            and gain > criteria.of_floor * (floor.value / base.check_error) ** 2
            and chance(score) * len(base.model.known) < criteria.by_chance
        )

    return (
        not refusal(base, other, criteria=criteria)
        and other.check_error < base.check_error
        and is_enough(of_force, check_score(base, other))
        and is_enough(gain_at_command(base, other), score_at_command(base, other))
    )


def _makes_adequate(base: Fit, other: Fit, floor: NoiseFloor, criteria: Criteria) -> bool:
    """Whether `other` is an adequate model where the base was not."""
    adequate = is_adequate(other, floor, criteria=criteria)
    return adequate and not is_adequate(base, floor, criteria=criteria)


def is_supported(
    base: Fit, ranked: Ranked, floor: NoiseFloor, *, criteria: Criteria = CRITERIA
) -> bool:
    """Whether a candidate is identifiable, lowers the check error enough, and nothing bars it."""
    return (
        ranked.is_identifiable
        and not objection(base, ranked, floor, criteria=criteria)
        and is_better(base, ranked.fit, floor, criteria=criteria)
    )


def objection(
    base: Fit, ranked: Ranked, floor: NoiseFloor, *, criteria: Criteria = CRITERIA
) -> str:
    """Which check bars a candidate however much it explains, in words; "" where none does.

    One that drives a parameter of the model to its bound, and whose effect the model still has,
    describes the records, but is no missing physics beside the model's effects. One that needs a
    parameter at its bound is itself another effect, unless it leaves noise only.
    """
    if ranked.refused or ranked.implausible:
        return REFUSALS.get(ranked.refused, ranked.implausible)
    if floor.jitters and ranked.fit.check_error < criteria.weakened * floor.value:
        return (
            "leaves less than the jitter of the clock makes without it: it weakens what that makes"
        )
    if gone := displaced(base, ranked.fit, least=criteria.close):
        return f"drives {', '.join(gone)} to a bound, which the model needs without it"
    driven = sorted(set(ranked.fit.at_bound) - set(base.at_bound))
    added = [n for n in driven if n not in base.model.parameters]
    needed = [n for n in added if not ranked.fit.model.declared(n).optional]
    if needed and not _makes_adequate(base, ranked.fit, floor, criteria):
        return f"needs {', '.join(needed)} at a bound: it is another effect"
    return ""


def helps_but_is_barred(
    base: Fit, ranked: Ranked, floor: NoiseFloor, *, criteria: Criteria = CRITERIA
) -> str:
    """Which check bars a candidate that lowers the check error by enough to matter; "" if none."""
    least = 1.0 - criteria.relevant
    helps = (
        check_squares(ranked.fit) < least * check_squares(base)
        or ranked.fit.check_error**2 < least * base.check_error**2
    )
    if not helps:
        return ""
    return objection(base, ranked, floor, criteria=criteria)


def displaced(base: Fit, fit: Fit, *, least: float = 1.0) -> list[str]:
    """Parameters driven to a bound whose effect the records tell from its absence in the base.

    least: standard errors from absence. Of one that hardly differs from it nothing is known that a
    candidate could contradict: it bars none
    """
    driven = set(fit.at_bound) - set(base.at_bound)
    return sorted(n for n in driven if n in base.model.parameters and _is_there(base, n, least))


def _is_there(base: Fit, name: str, least: float) -> bool:
    """Whether the records show that the effect of a parameter is present.

    By all that it cannot be without; what is optional may be open.
    """
    effect = name.rpartition(".")[0]
    values = {
        n: v
        for n, v in base.model.parameters.items()
        if n.rpartition(".")[0] == effect and (n == name or not base.model.declared(n).optional)
    }
    return all(
        v.fixed or not least * v.stderr >= base.model.from_absence(n) for n, v in values.items()
    )


def superfluous_beside(
    base: Fit, fit: Fit, candidate: Candidate, *, criteria: Criteria = CRITERIA
) -> Candidate | None:
    """The one effect of the base that a candidate at its place makes superfluous; None or several.

    Its strength surely differed from zero, and beside the candidate it ends where it is absent; or,
    where no effect does so, it surely differed from zero before and no longer does.
    """
    gone, ended, open_now = set(displaced(base, fit)), [], []
    for effect in base.model.body(candidate.at).effects:
        strengths = [f"{candidate.at}.{effect.name}.{n}" for n in effect.absent]
        values = [base.model.parameters.get(n) for n in strengths]
        if not values or any(v is None or v.fixed for v in values):
            continue
        if all(
            n in gone and _near_absence(fit, n, effect.absent[n.rpartition(".")[2]])
            for n in strengths
        ):
            ended.append(effect)
        elif all(
            criteria.surely * base.model.parameters[n].stderr < base.model.from_absence(n)
            and fit.model.parameters[n].stderr >= fit.model.from_absence(n)
            for n in strengths
        ):
            open_now.append(effect)
    superfluous = ended or open_now
    if len(superfluous) != 1:
        return None
    start = f"{candidate.at}.{superfluous[0].name}."
    sure = displaced(base, fit, least=criteria.close)
    left = [n for n in sure if not n.startswith(start)]
    return None if left else Candidate(superfluous[0], candidate.at)


def _near_absence(fit: Fit, name: str, absent: float) -> bool:
    """Whether a parameter that was driven to a bound lies at the one where its effect is absent."""
    declared = fit.model.declared(name)
    value = fit.model.parameters[name].value
    near_lower = abs(value - declared.lower) <= abs(value - declared.upper)
    return absent == (declared.lower if near_lower else declared.upper)


def worth_pursuing(base: Fit, floor: NoiseFloor, *, criteria: Criteria = CRITERIA) -> float:
    """Share of the base's squares that a first step must gain for the search to go on.

    The floor is never above what a candidate leaves. So beside a base that leaves little more than
    its floor, only what takes away of_floor / (1 + of_floor) of the squares can be better: a first
    step that promises less than a third of that is not followed.
    """
    least = criteria.of_floor / (1.0 + criteria.of_floor)
    only_noise = criteria.of_floor * floor.value**2 >= least * base.check_error**2
    return least / 3.0 if only_noise else criteria.worth


def rank_key(ranked: Ranked) -> tuple[bool, float]:
    """Sort key of a ranking: candidates that count first, then by squares on the check records."""
    return not ranked.counts, check_squares(ranked.fit)


def alike(supported: Sequence[Ranked], *, criteria: Criteria = CRITERIA) -> list[Ranked]:
    """The supported candidates, in order, that explain the records as well as the best one."""
    best = supported[:1]
    return [r for r in supported if r is best[0] or _equal(r, best[0], criteria)]


def _equal(one: Ranked, best: Ranked, criteria: Criteria) -> bool:
    """Whether the records cannot distinguish a candidate from the best one."""
    near = abs(one.fit.check_error - best.fit.check_error) < criteria.near * best.fit.check_error
    return near and whole_score(one.fit, best.fit) < criteria.close


def preferred(supported: Sequence[Ranked], *, criteria: Criteria = CRITERIA) -> Ranked:
    """Of the supported candidates, in order, the simplest that explains as well as the best.

    What the user's model has is believed: an effect in the place of another only where it is
    better.
    """
    equal = alike(supported, criteria=criteria)
    return min(equal, key=lambda r: (r.instead_of is not None, *simplicity(r)))


def alternatives_of(
    best: Ranked,
    ranking: Ranking,
    base: Fit,
    floor: NoiseFloor,
    *,
    criteria: Criteria = CRITERIA,
) -> tuple[Candidate, ...]:
    """Candidates that the records cannot distinguish from this one.

    One that needs more parameters to do as well explains nothing that the simpler does not.
    """
    supported = [r for r in ranking.ranked if is_supported(base, r, floor, criteria=criteria)]
    return tuple(
        r.candidate
        for r in alike(supported, criteria=criteria)
        if r is not best and simplicity(r)[0] == simplicity(best)[0]
    )


def others_that_help(best: Ranked, ranking: Ranking) -> tuple[Candidate, ...]:
    """What else takes away at least half of what the best does, whether or not by more than chance.

    To be said where the model before left only noise: there a gain is small, and what brings it
    about may be something else.
    """
    whole = check_squares(ranking.base)
    least = 0.5 * (whole - check_squares(best.fit))
    others = (r for r in ranking.ranked if r.counts and r.candidate != best.candidate)
    return tuple(r.candidate for r in others if whole - check_squares(r.fit) >= least)


def simplicity(ranked: Ranked) -> tuple[int, int, int]:
    """Parameters that must be estimated, effects that must be there, and optional parameters.

    Fewer is simpler.
    """
    effect = ranked.candidate.effect
    optional = sum(p.optional for p in effect.parameters.values())
    return len(effect.parameters) - optional, len(effect.needs), optional


def moment_above_noise(
    fit: Fit, prepared: Prepared, floor: NoiseFloor, *, criteria: Criteria = CRITERIA
) -> Moment | None:
    """The one moment that holds all that a model leaves above noise; None where none does."""
    if is_adequate(fit, floor, criteria=criteria):
        return None
    moment = worst_moment(fit, prepared, floor)
    return moment if moment is not None and moment.without <= criteria.adequate else None


def verdict(
    rungs: Sequence[Rung],
    floor: NoiseFloor,
    moment: Moment | None = None,
    *,
    criteria: Criteria = CRITERIA,
) -> str:
    """ "effects_missing", "model_adequate" or "undecided".

    moment: as `moment_above_noise` says; what is left at one moment only is no missing physics
    """
    added = [r for r in rungs if r.added is not None]
    if not added:
        adequate = is_adequate(rungs[-1].fit, floor, criteria=criteria) or moment is not None
        return "model_adequate" if adequate else "undecided"
    part = explained(rungs[0].fit, rungs[-1].fit, floor)
    if part < criteria.mostly or all(r.alternatives for r in added):
        return "undecided"
    return "effects_missing"
