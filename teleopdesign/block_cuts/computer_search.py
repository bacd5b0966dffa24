"""The ladder of the computer's cuts: which effect of which controller block explains the rest.

Score, thresholds and probabilities are those of a body's diagnosis (`diagnose.evidence`,
`diagnose.criteria`, `diagnose.evidence`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..diagnose.criteria import CRITERIA
from ..diagnose.evidence import SAME, chance, gain_score, removed_share
from ..effects.of_blocks.controllers import CONTROL_EFFECTS
from .computer import Placed
from .control_rows import ControlFit, ControlRows
from .cuts import COMPUTER

#: why an effect of which too many rows say nothing is refused
BLIND = "more than a quarter of the moving rows is blind"
#: most effects that are added: more than three at once were never told apart
_MOST = 3
#: part of what the stated laws leave, below which effects explain it: a right law leaves rounding
_EXPLAINED = 0.1


@dataclass(frozen=True)
class Attempt:
    """One candidate of a step and its fit.

    score: of its gain, in standard deviations of chance;  behind: of the best one's, against it
    refused: why it cannot be accepted; "": it can;  probability: that it is missing
    """

    added: Placed
    fit: ControlFit
    score: float
    behind: float = 0.0
    refused: str = ""
    probability: float = 0.0


@dataclass(frozen=True)
class ComputerStep:
    """One step of the ladder: what was tried, and the accepted one first among its look-alikes.

    accepted: None: nothing was added
    of_body: (effect, place) of a body in the same cut that explains the records equally well
    """

    before: ControlFit
    attempts: tuple[Attempt, ...]
    accepted: Attempt | None
    alike: tuple[Attempt, ...] = ()
    of_body: tuple[tuple[str, str], ...] = ()

    @property
    def likes(self) -> tuple[tuple[str, str], ...]:
        """(effect, place) of what explains the records as well as the accepted effect."""
        return (*(one.added.key for one in self.alike), *self.of_body)


@dataclass(frozen=True)
class ComputerLadder:
    """The ladder of the computer's cuts, or of its laws in the cut of a body.

    floors: cut -> error that sensors and rounding alone leave
    with_body: whether a body is in the cut; else a right law leaves rounding
    """

    base: ControlFit
    steps: tuple[ComputerStep, ...]
    floors: dict[str, float]
    with_body: bool = False

    @property
    def accepted(self) -> tuple[Attempt, ...]:
        """The accepted effects, in their order."""
        return tuple(step.accepted for step in self.steps if step.accepted is not None)

    @property
    def last(self) -> ControlFit:
        """The fit with every accepted effect."""
        return self.accepted[-1].fit if self.accepted else self.base

    @property
    def floor(self) -> float:
        return _floor(self.floors)

    @property
    def is_adequate(self) -> bool:
        """Whether every cut leaves only rounding."""
        errors = self.last.errors["check"]
        return all(e <= CRITERIA.adequate * self.floors[name] for name, e in errors.items())


def _floor(floors: dict[str, float]) -> float:
    """Root mean square of the floors of all cuts."""
    return float(np.sqrt(np.mean(np.square(list(floors.values())))))


def climb(
    data: ControlRows,
    floors: dict[str, float],
    report: Callable[[str], None],
    *,
    beside: Callable[[ComputerStep], ComputerStep] | None = None,
) -> ComputerLadder:
    """Add effects of the computer while the check rows support them.

    beside: a step whose effect was accepted, held against the effects of a body in the same cut;
        None: no body is there
    """
    base = data.base()
    steps: list[ComputerStep] = []
    here = base
    while len(steps) <= _MOST:
        report(f"effects of the computer, beside {len(here.placed)}")
        step = step_of(data, here, floors)
        if beside is not None and step.accepted is not None:
            step = beside(step)
        steps.append(step)
        if step.accepted is None:
            break
        here = step.accepted.fit
        enough = CRITERIA.adequate**2 if beside is not None else 1.0 + CRITERIA.of_floor
        if here.error("check") ** 2 < enough * _floor(floors) ** 2:
            break  # as much noise may be left, or a gain would leave less than rounding alone
    ladder = ComputerLadder(base, tuple(steps), floors, beside is not None)
    return replace(ladder, steps=tuple(_with_probabilities(s, ladder) for s in steps))


def step_of(data: ControlRows, here: ControlFit, floors: dict[str, float]) -> ComputerStep:
    """Fit every candidate, and accept the best one that the check rows support."""
    there = {p.key for p in here.placed}
    attempts = []
    for at in data.places:
        for name, effect in CONTROL_EFFECTS.items():
            filters = effect.on_velocity and not data.part.uses_velocity(at)
            if (name, at) in there or filters or not data.is_candidate(name, at):
                continue
            fit = data.estimate(here, effect, at)
            score = _score(data, here, fit)
            one = Attempt(fit.placed[-1], fit, score)
            attempts.append(replace(one, refused=_reason_against(data, here, one, floors)))
    attempts.sort(key=lambda one: one.fit.error("check"))
    able = [one for one in attempts if not one.refused]
    if not able:
        return ComputerStep(here, tuple(attempts), None)
    best = min(able, key=lambda one: one.fit.error("check"))
    attempts = [replace(one, behind=max(_score(data, one.fit, best.fit), 0.0)) for one in attempts]
    least = best.fit.error("check")
    alike = tuple(
        one
        for one in attempts
        if not one.refused and are_alike(one.fit.error("check"), least, one.behind)
    )
    best = next(one for one in attempts if one.added.key == best.added.key)
    return ComputerStep(
        here, tuple(attempts), best, tuple(o for o in alike if o.added.key != best.added.key)
    )


def are_alike(error: float, least: float, behind: float) -> bool:
    """Whether two candidates explain the records equally well.

    error, least: theirs on the check rows, the better one last;  behind: score of that one
    """
    if behind >= CRITERIA.indistinguishable:
        return False
    return error**2 <= (1.0 + CRITERIA.relative_improvement) * least**2 or behind < 1.0


def _score(data: ControlRows, before: ControlFit, after: ControlFit) -> float:
    return gain_score(before.residual["check"], after.residual["check"], data.blocks["check"])


def _reason_against(
    data: ControlRows, before: ControlFit, one: Attempt, floors: dict[str, float]
) -> str:
    """Why a candidate cannot be accepted; "": it can."""
    floor = _floor(floors)
    old, new = before.error("check"), one.fit.error("check")
    gain = old**2 - new**2
    if one.score < CRITERIA.significance:
        return "its gain may be chance"
    from_absence = abs(one.added.value - one.added.effect.absent)
    if from_absence < CRITERIA.interval * one.fit.stderr[-1]:
        return "its value is absence as well"
    if gain < max(CRITERIA.of_floor * floor**2, CRITERIA.relative_improvement * old**2):
        return "its gain is too small"
    names = one.fit.errors["check"]
    if any(e > max(before.errors["check"][n], floors[n]) * (1.0 + SAME) for n, e in names.items()):
        return "it raises the error of a cut"
    if one.added.effect.name == "delay" and one.added.at == COMPUTER:
        if (
            one.added.value <= data.rows[0].period * (1.0 + SAME)
            and not data.part.computer.one_pass
        ):
            return "a shift of a row belongs to the record"
    if data.blind(one.added, one.fit.placed) > CRITERIA.blind:
        return BLIND
    return ""


def _with_probabilities(step: ComputerStep, ladder: ComputerLadder) -> ComputerStep:
    """The step with the probability of each candidate, as for a body's diagnosis."""
    floor, before = ladder.floor, step.before.error("check")
    accepted = step.accepted
    group = {one.added.key for one in (accepted, *step.alike) if one is not None}
    weights = {
        one.added.key: math.exp(-0.5 * one.behind**2)
        for one in step.attempts
        if not one.refused and (not group or one.added.key in group)
    }
    total = sum(weights.values()) or 1.0
    trusted = 1.0
    if accepted is not None and not ladder.is_adequate:
        # a law without hidden parts leaves rounding alone; where much more is left, the accepted
        # effects stand in for another one
        ends = ladder.base.error("check"), ladder.last.error("check")
        explains = ladder.with_body or ends[1] <= _EXPLAINED * ends[0]
        trusted = removed_share(ends, floor) ** CRITERIA.belief_power if explains else 0.0
        blind = [one for one in step.attempts if one.refused == BLIND]
        if any(one.fit.error("check") < accepted.fit.error("check") for one in blind):
            trusted = 0.0  # a form that does not count explains more

    def probability(one: Attempt) -> float:
        real = weights.get(one.added.key, 0.0) / total * (1.0 - chance(one.score))
        explained = removed_share((before, one.fit.error("check")), floor)
        if one.added.key not in group:
            return CRITERIA.true_of_others * (1.0 - chance(one.score)) * explained
        return float(np.clip(CRITERIA.true_of_accepted * real * trusted, 0.0, 1.0))

    attempts = tuple(replace(one, probability=probability(one)) for one in step.attempts)
    by_key = {one.added.key: one for one in attempts}
    return replace(
        step,
        attempts=tuple(sorted(attempts, key=lambda one: -one.probability)),
        accepted=None if accepted is None else by_key[accepted.added.key],
        alike=tuple(by_key[one.added.key] for one in step.alike),
    )
