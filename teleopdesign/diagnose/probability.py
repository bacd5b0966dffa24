"""Probability that a candidate is the missing effect, from its fits along the ladder.

It is calibrated on diagnoses of cases from an independent simulator, not by a formula that assumes
white noise. In these cases the final error decides whether an accepted effect is true: where it is
noise, nearly all accepted effects are true; where it is much larger, a wrong effect may have
imitated one that the catalogue lacks. On a real machine more than noise is nearly always left.
There the probability follows from what the effect explains beside free functions of the motion
(`free_functions`): an effect of the right form explains as much as they do.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from .candidates import Candidate
from .criteria import CRITERIA
from .decision import helps_but_is_barred, select_other_helpers
from .evidence import chance, floors_left, is_adequate, removed_share
from .free_functions import Belief
from .ladder_state import LadderEnd
from .noise_floor import NoiseFloor
from .ranking import Ranked, Ranking
from .rung import Rung
from .statements import VerdictName


@dataclass(frozen=True)
class CandidateEvidence:
    """The evidence of one step of a ladder for a candidate.

    accepted: it was added on this step;  as_good: it explains the records as well as the added
        effect
    share: its probability among the candidates that this step cannot distinguish; they sum to one
    explained: part of the squares above the noise floor that it removes on this step
    left: error after the last step, in noise floors
    barred: the rule that excludes it on this step, whatever it explains; "" where none
    belief: what the effect that was added on this step explains in the final model, beside free
        functions; None: it cannot be taken from this model
    from_noise: the step began with a model that leaves only noise
    at_most: least probability of the accepted effects that it requires: it cannot act without
        them; None: it requires none
    """

    ranked: Ranked
    accepted: bool
    as_good: bool
    share: float
    explained: float
    left: float
    barred: str = ""
    belief: Belief | None = None
    from_noise: bool = False
    at_most: float | None = None

    def probability(self) -> float:
        """Probability that the effect is missing, 0 to 1."""
        real = self.share * (1.0 - chance(self.ranked.score))
        if not np.isfinite(real):  # a model that runs away has no error: nothing speaks for it
            return 0.0
        if not (self.accepted or self.as_good):
            return CRITERIA.true_of_others * real * self.explained
        trusted = 1.0
        if self.left > CRITERIA.adequate:
            # more than noise is left: is the form of the effect right?
            trusted = 0.0 if self.belief is None else self.belief.share**CRITERIA.belief_power
        if self.from_noise:  # a true effect explains nearly all force above the noise
            trusted *= self.explained
        alone = max(CRITERIA.true_of_accepted * real * trusted, 0.0)
        return float(alone if self.at_most is None else min(alone, self.at_most))


def evidence_of(end: LadderEnd) -> list[CandidateEvidence]:
    """The evidence for every candidate at every step."""
    evidence = _evidence_alone(end)
    accepted = {one.ranked.candidate.key: one.probability() for one in evidence if one.accepted}
    most = _limit_by_requirements(end, accepted)
    return [
        replace(one, at_most=most.get(one.ranked.candidate.key)) if one.accepted else one
        for one in evidence
    ]


def _limit_by_requirements(
    end: LadderEnd, accepted: Mapping[tuple[str, str], float]
) -> dict[tuple[str, str], float]:
    """Largest probability of each accepted effect (name, place), by the effects it requires."""
    most: dict[tuple[str, str], float] = {}
    for level in sorted(set(accepted.values()), reverse=True):
        likely = {key for key, probability in accepted.items() if probability >= level}
        for candidate in select_independent(end, likely):
            most.setdefault(candidate.key, level)
    return most


def _evidence_alone(end: LadderEnd) -> list[CandidateEvidence]:
    """The evidence for every candidate at every step, regardless of the effects it requires."""
    steps: list[tuple[Rung | None, Ranking]] = [
        (r, r.ranking) for r in end.rungs if r.ranking is not None
    ]
    steps.append((None, end.last))
    last, floor = end.after, end.floor
    evidence = []
    for rung, ranking in steps:
        share = shares(ranking, rung)
        for ranked in ranking.ranked:
            key = ranked.candidate.key
            accepted = rung is not None and rung.added is not None and rung.added.key == key
            barred = end.reason_set_aside(key)
            before, after = ranking.base.check_error, ranked.fit.check_error
            if not accepted and not barred:
                barred = helps_but_is_barred(ranking.base, ranked, floor)
            evidence.append(
                CandidateEvidence(
                    ranked=ranked,
                    accepted=accepted,
                    as_good=rung is not None and key in {c.key for c in rung.alternatives},
                    share=share[key],
                    explained=removed_share((before, after), floor.value),
                    left=floors_left(last, floor),
                    barred=barred,
                    belief=None
                    if rung is None or rung.added is None
                    else end.beliefs.get(rung.added.key),
                    from_noise=is_adequate(ranking.base, floor),
                )
            )
    return evidence


def probable(end: LadderEnd) -> tuple[Candidate, ...]:
    """The accepted effects that are at least as likely as not, in the order added."""
    likely = {
        one.ranked.candidate.key
        for one in evidence_of(end)
        if one.accepted and one.probability() >= CRITERIA.named
    }
    return select_independent(end, likely)


def select_independent(end: LadderEnd, named: Collection[tuple[str, str]]) -> tuple[Candidate, ...]:
    """Accepted effects with these keys, in order, without those that require an effect not named.

    named: (name, place)
    """
    model, there = end.before.model, []
    for rung in end.rungs:
        new = rung.added
        if new is None or new.key not in named or model.body(new.at).lacks(new.effect):
            continue
        there.append(new)
        # an effect that it replaced stays: it makes no effect possible that the ladder refused
        model = model.with_effect(new.effect.name, at=new.at)
    return tuple(there)


def shares(ranking: Ranking, rung: Rung | None) -> dict[tuple[str, str], float]:
    """Share of each candidate among those that the ranking cannot distinguish; they sum to one.

    The accepted effect shares with those as good, and with a rarer look-alike at its weight. A
    candidate that was not accepted and drives a parameter to a bound has no share.
    returns: all zero where no candidate has a share
    """
    accepted = rung is not None and rung.added is not None
    if rung is not None and rung.added is not None:
        alike = {c.key for c in (rung.added, *rung.alternatives)}
        rarer = {c.key for c in list_rarer(rung.added, ranking)} - alike
        first = next(r.behind for r in ranking.ranked if r.candidate.key == rung.added.key)
    else:
        alike, rarer = {r.candidate.key for r in ranking.ranked}, set()
        first = 0.0
    bound = set(ranking.base.at_bound)
    weights = {}
    for r in ranking.ranked:
        driven = set(r.fit.at_bound) - bound
        # an accepted effect may have a parameter at its bound, because it was supported with it
        serious = r.counts and r.candidate.key in alike | rarer and (accepted or not driven)
        weight = CRITERIA.rarity_weight if r.candidate.key in rarer else 1.0
        weights[r.candidate.key] = (
            weight * math.exp(-0.5 * max(r.behind - first, 0.0) ** 2) if serious else 0.0
        )
    total = sum(weights.values()) or 1.0
    return {k: w / total for k, w in weights.items()}


def list_rarer(added: Candidate, ranking: Ranking) -> list[Candidate]:
    """Candidates at the same place whose files call the added effect the commoner one."""
    others = (r.candidate for r in ranking.ranked if r.candidate.at == added.at)
    return [c for c in others if c.effect.commoner == added.effect.name]


def verdict(rungs: Sequence[Rung], floor: NoiseFloor) -> VerdictName:
    """The verdict by the rungs alone, whatever the probabilities of their effects."""
    added = [r for r in rungs if r.added is not None]
    if not added:
        adequate = is_adequate(rungs[-1].fit, floor)
        return "model_adequate" if adequate else "undecided"
    return "undecided" if all(r.alternatives for r in added) else "effects_missing"


def leave_unnamed(rung: Rung, named: Collection[Candidate]) -> Rung:
    """A rung that is not named, with all other candidates that explain a good part of its gain.

    A rung with alternatives lists already the effects that it cannot be distinguished from.
    """
    if rung.added is None or rung.added in named or rung.alternatives:
        return rung
    if rung.could_be is not None:
        return rung
    ranking = rung.ranking
    best = next((r for r in ranking.ranked if r.candidate == rung.added), None) if ranking else None
    if ranking is None or best is None:
        return rung
    return replace(rung, could_be=select_other_helpers(best, ranking))
