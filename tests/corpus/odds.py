"""The odds by which roles of columns are told, estimated from the logs of this folder.

    python tests/corpus/odds.py      prints the odds of `survey/roles.toml`, and in how many choices
                                     of kinds of logs that are left out they are right

A choice is a set of columns of which one has the role. Its probability is

    exp(score of that column) / sum of exp(scores),   score = sum of ln odds * evidence - ln left

and the odds are those of the largest likelihood of all choices, with a normal prior about odds of
one: what no log shows, tells nothing. Odds of 0 are rules, and what a user states decides; neither
is estimated.
"""

from __future__ import annotations

import contextlib
import tempfile
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from corpus.reading import entries, read, unpacked
from scipy.optimize import minimize

from teleopdesign.measurement.survey import forces, position, roles

ODDS = Path(roles.__file__).with_name("roles.toml")
#: roles of which the corpus holds enough choices; standard deviation of the prior of ln odds, with
#: which kinds of logs that are left out are most likely
ROLES, PRIOR = ("position", "actuator_force"), 3.2
STATED = ("its constant is stated",)
#: how near in ln odds two columns are equally likely: another rule then decides
TIE = np.log(roles.AS_LIKELY)


@dataclass(frozen=True, eq=False)
class Choice:
    """evidence: (columns, keys);  left: -ln of what the relation leaves;  right: the true column"""

    kind: str
    evidence: np.ndarray
    left: np.ndarray
    right: int


def choices_of_the_corpus(keys: Mapping[str, Sequence[str]]) -> dict[str, list[Choice]]:
    """The choices of each role on all logs that are read, where its column is not stated.

    keys: role -> its keys of evidence
    """
    out: dict[str, list[Choice]] = {role: [] for role in keys}
    for name, entry in entries().items():
        with tempfile.TemporaryDirectory() as scratch, _kept_scores() as scores_in_turn:
            folder = Path(scratch)
            reading = read(unpacked(entry, folder), entry.get("options", []), folder / "made")
        for role, kept in out.items():
            truth = reading.channels.get(role, {}).get("column")
            for columns in _groups(scores_in_turn, role):
                if truth in columns and len(columns) > 1:
                    of_each = [
                        [evidences.get(key, 0.0) for key in keys[role]]
                        for evidences, _ in columns.values()
                    ]
                    left = -np.log([part for _, part in columns.values()])
                    kind, right = name.partition("/")[0], [*columns].index(truth)
                    kept.append(Choice(kind, np.array(of_each), left, right))
    return out


@contextlib.contextmanager
def _kept_scores() -> Iterator[list[tuple[str, str, dict[str, float], float]]]:
    """(role, column, evidence, part left) of each score, in order; "" parts two choices."""
    kept: list[tuple[str, str, dict[str, float], float]] = []
    score = roles.score_of

    def score_of(role: str, column: Any, *, left: float = 1.0, **more: float) -> float:
        value = score(role, column, left=left, **more)
        if value > -np.inf:
            shown = roles.evidence_of(column, **more)
            kept.append((role, column.name, shown, min(max(left, roles.LEAST_LEFT), 1.0)))
        return value

    def score_beside(*arguments: Any) -> float:
        with patch.object(forces, "score_of", score):
            return beside(*arguments)

    beside = position.score_beside
    with contextlib.ExitStack() as stack:
        for module in (position, forces):
            stack.enter_context(patch.object(module, "score_of", score_of))
        stack.enter_context(patch.object(position, "score_beside", score_beside))
        yield kept


def _groups(scores_in_turn: Sequence[Any], role: str) -> Iterator[dict[str, Any]]:
    """The scores of one choice after the other: a column that comes again begins the next one."""
    columns: dict[str, Any] = {}
    for its_role, column, evidence, left in scores_in_turn:
        if its_role == role:
            if column in columns:
                yield columns
                columns = {}
            columns[column] = evidence, left
    if columns:
        yield columns


def fit_odds(choices: Sequence[Choice], stated: np.ndarray, free: np.ndarray) -> np.ndarray:
    """ln odds of the keys (k,) of the largest likelihood;  stated: those that are not free."""

    def loss(some: np.ndarray) -> tuple[float, np.ndarray]:
        odds = stated.copy()
        odds[free] = some
        value, slope = float(some @ some) / (2 * PRIOR**2), some / PRIOR**2
        for c in choices:
            scores = c.evidence @ odds + c.left
            share = np.exp(scores - scores.max())
            value += float(np.log(share.sum()) + scores.max() - scores[c.right])
            slope = slope + (share / share.sum() @ c.evidence - c.evidence[c.right])[free]
        return value, slope

    odds = stated.copy()
    odds[free] = minimize(loss, np.zeros(int(free.sum())), jac=True).x
    return odds


def right_ones(choices: Sequence[Choice], odds: np.ndarray) -> int:
    """The number of choices in which no column is clearly more likely than the true one."""
    scores = [(c.evidence @ odds + c.left, c.right) for c in choices]
    return sum(bool(s[right] >= s.max() - TIE) for s, right in scores)


def odds_of_the_corpus() -> dict[str, tuple[dict[str, float], int, int]]:
    """Role -> odds by key, right choices of kinds of logs that were left out, all choices."""
    written = tomllib.loads(ODDS.read_text(encoding="utf-8"))
    keys = {role: [key for key, odds in written[role].items() if odds > 0] for role in ROLES}
    out = {}
    for role, choices in choices_of_the_corpus(keys).items():
        stated = np.log([written[role][key] for key in keys[role]])
        free = np.array([key not in STATED for key in keys[role]])
        right = 0
        for kind in {c.kind for c in choices}:
            odds = fit_odds([c for c in choices if c.kind != kind], stated, free)
            right += right_ones([c for c in choices if c.kind == kind], odds)
        best = np.exp(fit_odds(choices, stated, free))
        out[role] = dict(zip(keys[role], best.tolist(), strict=True)), right, len(choices)
    return out


if __name__ == "__main__":
    for role, (odds, right, count) in odds_of_the_corpus().items():
        print(f"[{role}]  # right in {right} of {count} choices of kinds that were left out")
        for key, value in odds.items():
            print(f'"{key}" = {value:.2g}')
