"""Theorems about the passivity of friction, of its cancellation and of sampled controllers.

Every file whose name does not begin with `_` states a theorem, or some of one kind: functions of
numbers with their hypotheses, and as `THEOREM` the questions about devices that they answer, if
any. `settle` asks all theorems. A further theorem is a further file.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from ...base.frozen import Catalogue
from ..claims.claim import Refutation
from ..identified import restate_for_device
from ._theorem import Question, Theorem, TopicClaim, Wall

__all__ = ["THEOREMS", "Question", "Theorem", "TopicClaim", "Wall", "settle"]


_NAMES = sorted(p.stem for p in Path(__file__).parent.glob("*.py") if p.stem[0] != "_")
_FILES = {name: importlib.import_module(f"{__name__}.{name}") for name in _NAMES}
_STATED = {name: file.THEOREM for name, file in _FILES.items() if hasattr(file, "THEOREM")}
THEOREMS: Mapping[str, Theorem] = Catalogue(
    dict(sorted(_STATED.items(), key=lambda item: item[1].order)), "theorem"
)


def settle(
    question: Question, *, simulated: bool = True, theorems: Iterable[Theorem] | None = None
) -> list[TopicClaim]:
    """Claims of all theorems about a question, restated for the whole device.

    simulated: whether simulations replay the motions of refutations
    theorems: theorems to ask; None: all of this folder
    """
    answers = []
    for theorem in THEOREMS.values() if theorems is None else theorems:
        for one in theorem.claims(question):
            covered = theorem.covers(question)
            claim = restate_for_device(question.device, one.claim, besides=covered)
            one = replace(one, claim=claim)
            if simulated and isinstance(claim.verdict, Refutation):
                motion = theorem.simulate(claim.record)
                if motion is not None:
                    one = replace(one, replayed=motion.energy, motion=motion)
            answers.append(one)
    return answers
