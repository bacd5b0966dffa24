"""Theorems about friction, its cancellation and computers: one file each.

Every file that does not begin with `_` states one as `THEOREM`: functions of numbers with their
hypotheses, and what is asked about every device and diagram (`settle`). Adding a theorem is adding
a file.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from ...frozen import Catalogue
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
    """What all theorems say about a question, as claims about the whole device.

    simulated: whether the motions of refutations are replayed in simulation
    theorems: those that are asked; None: all of the folder
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
    """With the motion of its refutation in simulation, where the theorem has one."""
    if not isinstance(one.claim.verdict, Refutation):
        return one
    motion = theorem.simulate(one.claim.record)
    return one if motion is None else replace(one, replayed=motion.energy, motion=motion)
