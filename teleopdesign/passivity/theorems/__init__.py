"""Theorems about the passivity of friction, of its cancellation and of sampled controllers.

Every file whose name does not begin with `_` states a theorem, or some of one kind, as functions of
numbers with their hypotheses. A theorem about devices also has `claims`, which answers a question
with claims about friction, walls and computers alone: none where the theorem says nothing about it.
All claims come from functions with hypotheses, so no claim is made outside of the hypotheses.
`ORDER` is the place among all theorems: continuous time before computers, friction before walls.
`settle` asks all theorems. A further theorem is a further file.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from ...base.frozen import Catalogue
from ..claims.claim import Refutation
from ..identified import restate_for_device
from ._theorem import Question, TopicClaim, Wall, simulate_cycle

__all__ = ["THEOREMS", "Question", "TopicClaim", "Wall", "settle"]

_NAMES = sorted(p.stem for p in Path(__file__).parent.glob("*.py") if p.stem[0] != "_")
_FILES = {name: importlib.import_module(f"{__name__}.{name}") for name in _NAMES}
_ABOUT_DEVICES = [name for name, file in _FILES.items() if hasattr(file, "claims")]
#: name of a file -> its claims, in the order of the theorems
THEOREMS: Mapping[str, Callable[[Question], Sequence[TopicClaim]]] = Catalogue(
    {n: _FILES[n].claims for n in sorted(_ABOUT_DEVICES, key=lambda n: _FILES[n].ORDER)}, "theorem"
)


def settle(question: Question, *, simulated: bool = True) -> list[TopicClaim]:
    """Claims of all theorems about a question, restated for the whole device.

    simulated: whether simulations replay the motions of refutations
    """
    answers = []
    for one in (one for claims in THEOREMS.values() for one in claims(question)):
        claim = restate_for_device(question.device, one.claim, besides=one.covers)
        one = replace(one, claim=claim)
        if simulated and isinstance(claim.verdict, Refutation):
            motion = simulate_cycle(claim.record)
            if motion is not None:
                one = replace(one, replayed=motion.energy, motion=motion)
        answers.append(one)
    return answers
