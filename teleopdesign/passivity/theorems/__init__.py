"""Theorems about the passivity of friction, of its cancellation and of sampled controllers.

Every file whose name does not begin with `_` states one theorem as `THEOREM`: functions of numbers
with their hypotheses, and the questions about devices that the theorem answers. `settle` asks all
theorems. A further theorem is a further file.
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


def _theorems() -> Mapping[str, Theorem]:
    names = sorted(p.stem for p in Path(__file__).parent.glob("*.py") if p.stem[0] != "_")
    modules = {name: importlib.import_module(f"{__name__}.{name}") for name in names}
    stated = {n: m.THEOREM for n, m in modules.items()}
    by_order = sorted(stated.items(), key=lambda item: item[1].order)
    return Catalogue(dict(by_order), "theorem")


THEOREMS: Mapping[str, Theorem] = _theorems()


def settle(
    question: Question, *, simulated: bool = True, theorems: Iterable[Theorem] | None = None
) -> list[TopicClaim]:
    """Claims of all theorems about a question, restated for the whole device.

    simulated: whether simulations replay the motions of refutations
    theorems: theorems to ask; None: all of this folder
    """
    answers = []
    for theorem in THEOREMS.values() if theorems is None else theorems:
        if not theorem.applies(question):
            continue
        covered = theorem.covers(question)
        for one in theorem.claims(question):
            claim = restate_for_device(question.device, one.claim, besides=covered)
            one = replace(one, claim=claim)
            answers.append(_replay(theorem, one) if simulated else one)
    return answers


def _replay(theorem: Theorem, one: TopicClaim) -> TopicClaim:
    """A refuted claim with its motion replayed in simulation, if the theorem can simulate it."""
    if not isinstance(one.claim.verdict, Refutation):
        return one
    motion = theorem.simulate(one.claim.record)
    return one if motion is None else replace(one, replayed=motion.energy, motion=motion)
