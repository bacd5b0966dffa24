"""Decisions of a diagnosis: which effects count, and the verdict.

Every threshold is a field of `Criteria`. What counts as noise: `adequacy`. Which of several
candidates is taken: `order`.
"""

from __future__ import annotations

from collections.abc import Sequence

from .adequacy import is_adequate
from .candidates import Candidate
from .criteria import CRITERIA, Criteria
from .evidence import (
    chance,
    check_score,
    check_squares,
    gain_at_command,
    score_at_command,
)
from .fit import Fit
from .noise_floor import NoiseFloor
from .one_moment import Moment
from .ranking import REFUSALS, Ranked
from .rung import Rung


def explained_share(before: Fit, after: Fit, floor: NoiseFloor) -> float:
    """Share of the squares above the noise floor that the effects added between two fits explain.

    Of the force or seen at the command, the smaller part.
    """
    of_force = _removed_share(before.check_error, after.check_error, floor.value)
    return min(
        of_force,
        _removed_share(before.at_command.error, after.at_command.error, floor.value_at_command),
    )


def _removed_share(before: float, after: float, floor: float) -> float:
    return (before**2 - after**2) / max(before**2 - floor**2, 1e-300)


def lowers_check_squares(base: Fit, other: Fit, *, criteria: Criteria = CRITERIA) -> bool:
    """Whether `other` leaves fewer squares on the check records, by enough to matter."""
    return check_squares(other) < (1.0 - criteria.relevant) * check_squares(base)


def refusal(base: Fit, other: Fit, *, criteria: Criteria = CRITERIA) -> str:
    """Why an addition to `base` does not count (a key of `REFUSALS`); "" where it may count.

    What makes the recorded force unpredictable has not explained it.
    """
    already = base.at_command.blind if base.at_command.blind > criteria.blind else 0.0
    if other.at_command.blind - already > criteria.blind:
        return "blind"
    if other.at_command.weak and not base.at_command.weak:
        return "weak"
    less = lowers_check_squares(base, other, criteria=criteria)
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
    """The rule that excludes a candidate whatever it explains, in words; "" where none does.

    One that drives a parameter of the model to its bound, and whose effect the model still has,
    describes the records, but is no missing physics beside the model's effects. One that needs a
    parameter at its bound is itself another effect, unless it leaves noise only.
    """
    if ranked.refused or ranked.implausible:
        return REFUSALS.get(ranked.refused, ranked.implausible)
    if floor.jitters and ranked.fit.check_error < criteria.weakened * floor.value:
        return (
            "leaves less than the jitter of the clock alone would: it only weakens the error from "
            "the jitter"
        )
    displaced = list_displaced_parameters(base, ranked.fit, least=criteria.close)
    if gone := [n for n in displaced if not _is_taken_over(n, ranked.candidate)]:
        return f"drives to a bound what the model needs without this effect: {', '.join(gone)}"
    driven = sorted(set(ranked.fit.at_bound) - set(base.at_bound))
    added = [n for n in driven if n not in base.model.parameters]
    needed = [n for n in added if not ranked.fit.model.declared(n).optional]
    if needed and not _makes_adequate(base, ranked.fit, floor, criteria):
        return f"fits only with {', '.join(needed)} at a bound, where it is another effect"
    return ""


def _is_taken_over(name: str, candidate: Candidate) -> bool:
    """Whether a parameter is of an effect whose force a candidate may take over whole."""
    return any(name.startswith(f"{candidate.at}.{e}.") for e in candidate.effect.takes_over)


def helps_but_is_barred(
    base: Fit, ranked: Ranked, floor: NoiseFloor, *, criteria: Criteria = CRITERIA
) -> str:
    """The rule that excludes a candidate that lowers the check error by enough; "" if none."""
    less = ranked.fit.check_error**2 < (1.0 - criteria.relevant) * base.check_error**2
    if not (less or lowers_check_squares(base, ranked.fit, criteria=criteria)):
        return ""
    return objection(base, ranked, floor, criteria=criteria)


def list_displaced_parameters(base: Fit, fit: Fit, *, least: float = 1.0) -> list[str]:
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


def find_superfluous_effect(
    base: Fit, fit: Fit, candidate: Candidate, *, criteria: Criteria = CRITERIA
) -> Candidate | None:
    """The one effect of the base that a candidate at its place makes superfluous; None or several.

    Its strength surely differed from zero, and beside the candidate it ends where it is absent; or,
    where no effect does so, it surely differed from zero before and no longer does.
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
            criteria.surely * base.model.parameters[n].stderr < base.model.from_absence(n)
            and fit.model.parameters[n].stderr >= fit.model.from_absence(n)
            for n in strengths
        ):
            open_now.append(effect)
    superfluous = ended or open_now
    if len(superfluous) != 1:
        return None
    start = f"{candidate.at}.{superfluous[0].name}."
    sure = list_displaced_parameters(base, fit, least=criteria.close)
    left = [n for n in sure if not n.startswith(start)]
    return None if left else Candidate(superfluous[0], candidate.at)


def _is_near_absence(fit: Fit, name: str, absent: float) -> bool:
    """Whether a parameter that was driven to a bound lies at the one where its effect is absent."""
    declared = fit.model.declared(name)
    value = fit.model.parameters[name].value
    near_lower = abs(value - declared.lower) <= abs(value - declared.upper)
    return absent == (declared.lower if near_lower else declared.upper)


def worth_pursuing(base: Fit, floor: NoiseFloor, *, criteria: Criteria = CRITERIA) -> float:
    """Predicted gain, as a share of the base's squares, from which a search continues.

    The floor is never above what a candidate leaves. So beside a base that leaves little more than
    its floor, only what takes away of_floor / (1 + of_floor) of the squares can be better: a first
    step that promises less than a third of that is not followed.
    """
    least = criteria.of_floor / (1.0 + criteria.of_floor)
    only_noise = criteria.of_floor * floor.value**2 >= least * base.check_error**2
    return least / 3.0 if only_noise else criteria.worth


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
    part = explained_share(rungs[0].fit, rungs[-1].fit, floor)
    if part < criteria.mostly or all(r.alternatives for r in added):
        return "undecided"
    return "effects_missing"
