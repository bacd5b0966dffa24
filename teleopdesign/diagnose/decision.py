"""Decisions of a diagnosis: which effects count, and which of several candidates is accepted.

Every threshold is a field of `Criteria`. `evidence` decides what counts as noise.

Candidates that count come first, then those that leave fewer squares on the check records
(`rank_key`). Among the candidates that the records cannot distinguish from the best, the simplest
is accepted (`select_simplest`).
"""

from __future__ import annotations

from collections.abc import Sequence

from .candidates import Candidate
from .criteria import CRITERIA
from .evidence import (
    check_score,
    check_squares,
    gain_at_command,
    is_adequate,
    score_at_command,
    whole_score,
)
from .fit import Fit
from .noise_floor import NoiseFloor
from .ranking import REFUSALS, Ranked, Ranking


def lowers_check_squares(base: Fit, other: Fit) -> bool:
    """Whether `other` leaves clearly fewer squares on the check records."""
    return check_squares(other) < (1.0 - CRITERIA.relative_improvement) * check_squares(base)


def refusal(base: Fit, other: Fit) -> str:
    """Why an addition to `base` does not count (a key of `REFUSALS`); "" where it may count.

    An addition that makes the recorded force unpredictable has not explained it.
    """
    already = base.at_command.blind if base.at_command.blind > CRITERIA.blind else 0.0
    if other.at_command.blind - already > CRITERIA.blind:
        return "blind"
    less = lowers_check_squares(base, other)
    return (
        "hides" if less and not gain_at_command(base, other) > CRITERIA.relative_improvement else ""
    )


def is_better(base: Fit, other: Fit, floor: NoiseFloor) -> bool:
    """Whether `other` has the smaller check error by more than chance and by enough to matter.

    Both the error of the force and the error referred to the command must fall. At the command, a
    smaller acting force is no gain. Nor is an error that falls only relative to the acting force.
    """
    before = check_squares(base)
    if not (before > 0.0 and other.check_error < base.check_error):
        return False  # of no error nothing can be less
    of_force = (before - check_squares(other)) / before

    def is_enough(gain: float, score: float) -> bool:
        """Whether a gain of this share of the squares, at this score, is more than chance."""
        return (
            score > CRITERIA.significance
            and gain > CRITERIA.relative_improvement
            and gain > CRITERIA.of_floor * (floor.value / base.check_error) ** 2
        )

    return (
        not refusal(base, other)
        and is_enough(of_force, check_score(base, other))
        and is_enough(gain_at_command(base, other), score_at_command(base, other))
    )


def is_supported(base: Fit, ranked: Ranked, floor: NoiseFloor) -> bool:
    """Whether a candidate is identifiable, lowers the check error enough, and no rule bars it."""
    return (
        ranked.is_identifiable
        and not objection(base, ranked, floor)
        and is_better(base, ranked.fit, floor)
    )


def objection(base: Fit, ranked: Ranked, floor: NoiseFloor) -> str:
    """The rule that excludes a candidate whatever it explains, in words; "" where none does.

    A candidate with a parameter at a bound is another effect, unless it makes the model adequate.
    """
    if ranked.refused or ranked.implausible:
        return REFUSALS.get(ranked.refused, ranked.implausible)
    driven = sorted(set(ranked.fit.at_bound) - set(base.at_bound))
    added = [n for n in driven if n not in base.model.parameters]
    needed = [n for n in added if not ranked.fit.model.declared(n).optional]
    makes_adequate = is_adequate(ranked.fit, floor) and not is_adequate(base, floor)
    if needed and not makes_adequate:
        return f"fits only with {', '.join(needed)} at a bound, where it is another effect"
    return ""


def helps_but_is_barred(base: Fit, ranked: Ranked, floor: NoiseFloor) -> str:
    """The rule that excludes a candidate that lowers the check error by enough.

    returns: "" where no rule does, or the candidate does not lower the error enough
    """
    less = ranked.fit.check_error**2 < (1.0 - CRITERIA.relative_improvement) * base.check_error**2
    if not (less or lowers_check_squares(base, ranked.fit)):
        return ""
    return objection(base, ranked, floor)


def list_displaced_parameters(base: Fit, fit: Fit, *, least: float = 1.0) -> list[str]:
    """Parameters driven to a bound although the records showed their effect in the base.

    least: standard errors by which the effect must differ from its absence. A weaker effect is too
        uncertain to exclude a candidate
    """
    driven = set(fit.at_bound) - set(base.at_bound)
    return sorted(n for n in driven if n in base.model.parameters and _is_there(base, n, least))


def _is_there(base: Fit, name: str, least: float) -> bool:
    """Whether the records show that the effect of a parameter is present.

    The parameter and all that are not optional must differ from absence by `least` standard errors.
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


def find_superfluous_effect(base: Fit, fit: Fit, candidate: Candidate) -> Candidate | None:
    """The one effect of the base that a candidate at its place makes superfluous.

    The strength of this effect surely differed from zero, and beside the candidate it lies at its
    bound of absence. Where no effect ends so: its strength no longer differs surely from zero.
    returns: None where there is no such effect, or more than one
    """
    gone, ended, open_now = set(list_displaced_parameters(base, fit)), [], []
    for effect in base.model.body(candidate.at).effects:
        strengths = [f"{candidate.at}.{effect.name}.{n}" for n in effect.absent]
        values = [base.model.parameters.get(n) for n in strengths]
        if not values or any(v is None or v.fixed for v in values):
            continue
        if all(
            n in gone and _is_near_absence(fit, n, effect.absent[n.rpartition(".")[2]])
            for n in strengths
        ):
            ended.append(effect)
        elif all(
            CRITERIA.significance * base.model.parameters[n].stderr < base.model.from_absence(n)
            and fit.model.parameters[n].stderr >= fit.model.from_absence(n)
            for n in strengths
        ):
            open_now.append(effect)
    superfluous = ended or open_now
    if len(superfluous) != 1:
        return None
    start = f"{candidate.at}.{superfluous[0].name}."
    sure = list_displaced_parameters(base, fit, least=CRITERIA.indistinguishable)
    left = [n for n in sure if not n.startswith(start)]
    return None if left else Candidate(superfluous[0], candidate.at)


def _is_near_absence(fit: Fit, name: str, absent: float) -> bool:
    """Whether the bound that a parameter was driven to is the one where its effect is absent."""
    declared = fit.model.declared(name)
    value = fit.model.parameters[name].value
    near_lower = abs(value - declared.lower) <= abs(value - declared.upper)
    return absent == (declared.lower if near_lower else declared.upper)


def worth_pursuing(base: Fit, floor: NoiseFloor) -> float:
    """Predicted gain, as a share of the base's squares, from which a search continues.

    The floor is never above a candidate's error. So if the base leaves little more than its floor,
    a candidate is better only if it removes of_floor / (1 + of_floor) of the squares. A start whose
    first step promises less than a third of that is not followed.
    """
    least = CRITERIA.of_floor / (1.0 + CRITERIA.of_floor)
    only_noise = CRITERIA.of_floor * floor.value**2 >= least * base.check_error**2
    return least / 3.0 if only_noise else CRITERIA.worth


def rank_key(ranked: Ranked) -> tuple[bool, float]:
    """Sort key of a ranking: candidates that count come first, then those with fewer check squares.

    The squares are rounded to six digits, which is the accuracy of a search. So candidates with the
    same force keep the order of the catalogue, on any machine.
    """
    return not ranked.counts, float(f"{check_squares(ranked.fit):.6g}")


def select_equals(supported: Sequence[Ranked]) -> list[Ranked]:
    """The supported candidates, in order, that explain the records as well as the best one."""
    best = supported[:1]
    return [r for r in supported if r is best[0] or _is_equal(r, best[0])]


def _is_equal(one: Ranked, best: Ranked) -> bool:
    """Whether the records cannot distinguish a candidate from the best one."""
    least = best.fit.check_error**2
    differ = abs(one.fit.check_error**2 - least) >= CRITERIA.relative_improvement * least
    return not differ and whole_score(one.fit, best.fit) < CRITERIA.indistinguishable


def select_simplest(supported: Sequence[Ranked]) -> Ranked:
    """The simplest supported candidate that explains the records as well as the best one.

    supported: in the order of the ranking
    A candidate that replaces an effect of the model is preferred only where it is better.
    """
    equal = select_equals(supported)
    return min(equal, key=lambda r: (r.instead_of is not None, *simplicity(r.candidate)))


def alternatives_of(
    best: Ranked, ranking: Ranking, base: Fit, floor: NoiseFloor
) -> tuple[Candidate, ...]:
    """Supported candidates that the records cannot distinguish from this one.

    Only candidates with as many necessary parameters count: one that needs more is no simpler
    explanation.
    """
    supported = [r for r in ranking.ranked if is_supported(base, r, floor)]
    return tuple(
        r.candidate
        for r in select_equals(supported)
        if r is not best and simplicity(r.candidate)[0] == simplicity(best.candidate)[0]
    )


def look_alikes_of(one: Ranked, ranking: Ranking) -> tuple[Candidate, ...]:
    """Candidates that explain as much as this one, whether or not it is the best, or supported."""
    parameters = simplicity(one.candidate)[0]
    return tuple(
        r.candidate
        for r in ranking.ranked
        if r is not one and r.counts and _is_equal(r, one)
        if simplicity(r.candidate)[0] == parameters
    )


def select_other_helpers(best: Ranked, ranking: Ranking) -> tuple[Candidate, ...]:
    """Other effects that remove at least half as many check squares as the best, by chance or not.

    They are named where the model before left only noise: there the gain is small, and another
    effect may cause it.
    """
    whole = check_squares(ranking.base)
    least = 0.5 * (whole - check_squares(best.fit))
    others = (r for r in ranking.ranked if r.counts and r.candidate != best.candidate)
    return tuple(r.candidate for r in others if whole - check_squares(r.fit) >= least)


def simplicity(candidate: Candidate) -> tuple[int, int, int]:
    """Numbers of necessary parameters, of effects that must be present, and of optional parameters.

    Fewer is simpler; compared in this order.
    """
    effect = candidate.effect
    optional = sum(p.optional for p in effect.parameters.values())
    return len(effect.parameters) - optional, len(effect.needs), optional
