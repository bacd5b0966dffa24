"""The ladder of all cuts together.

The cuts share no unknown: all that stands between two of them was recorded. So the ladder of the
whole joins their ladders, the largest fall of the error first.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..diagnose import Diagnosis
from .computer_search import ComputerLadder
from .cuts import Cuts

#: an effect and the place where it acts
Key = tuple[str, str]
#: one step of a ladder: what was added, then cut -> fit error and cut -> check error
_Step = tuple[Key, dict[str, float], dict[str, float]]


@dataclass(frozen=True)
class CutsRow:
    """One row of the ladder.

    added: effect and place; None: the diagram as stated, bodies re-estimated
    fit, check: cut -> error
    """

    added: Key | None
    fit: Mapping[str, float]
    check: Mapping[str, float]

    @property
    def fit_error(self) -> float:
        """Root mean square over the cuts."""
        return float(np.sqrt(np.mean(np.square(list(self.fit.values())))))

    @property
    def check_error(self) -> float:
        return float(np.sqrt(np.mean(np.square(list(self.check.values())))))


def join_ladders(
    cuts: Cuts,
    bodies: Mapping[str, Diagnosis],
    joined: Mapping[str, ComputerLadder],
    computer: ComputerLadder | None,
) -> tuple[CutsRow, ...]:
    """The rows over all cuts; the arguments are those of `BlockDiagnosis`."""
    fit = {name: d.before.fit_error for name, d in bodies.items()}
    check = {name: d.before.check_error for name, d in bodies.items()}
    for ladder in (*joined.values(), computer):
        # where no law's effect is accepted, the body alone is estimated, and its clock
        if ladder is not None and (ladder.accepted or not ladder.with_body):
            fit |= ladder.base.errors["fit"]
            check |= ladder.base.errors["check"]
    waiting = [_steps_of_body(name, d, joined.get(name)) for name, d in bodies.items()]
    waiting.append(_steps_of(computer))
    names = [c.name for c in cuts.tested if c.name in check]

    def row(added: Key | None) -> CutsRow:
        return CutsRow(added, {n: fit[n] for n in names}, {n: check[n] for n in names})

    rows = [row(None)]
    while any(waiting):
        falls = [
            sum(check[n] ** 2 - e**2 for n, e in steps[0][2].items()) if steps else -np.inf
            for steps in waiting
        ]
        added = waiting[int(np.argmax(falls))][0][0]
        for steps in waiting:  # an effect of a law that acts in several cuts is one row
            if steps and steps[0][0] == added:
                _, new_fit, new_check = steps.pop(0)
                fit, check = fit | new_fit, check | new_check
        rows.append(row(added))
    return tuple(rows)


def _steps_of_body(name: str, body: Diagnosis, laws: ComputerLadder | None) -> list[_Step]:
    """The effects in the cut of a body: those of the laws that give its command, then its own."""
    steps = _steps_of(laws)
    if steps:  # the body was estimated anew beside all of them
        before = body.before
        steps[-1] = (steps[-1][0], {name: before.fit_error}, {name: before.check_error})
    return steps + [
        (r.added.key, {name: r.fit_error}, {name: r.check_error})
        for r in body.rungs[1:]
        if r.added is not None
    ]


def _steps_of(ladder: ComputerLadder | None) -> list[_Step]:
    """The accepted effects of a ladder of laws, in their order."""
    accepted = () if ladder is None else ladder.accepted
    return [(a.added.key, a.fit.errors["fit"], a.fit.errors["check"]) for a in accepted]
