"""The models that an experiment should distinguish: those that the present records leave open."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..base.errors import ModelError
from ..diagnose.candidates import Candidate
from ..diagnose.diagnosis import Diagnosis, OpenQuestion
from ..diagnose.fit import Fit, estimate
from ..diagnose.open_questions import open_questions
from ..effects import SIGNALS
from ..model import Model


@dataclass(frozen=True)
class Rival:
    """A model that may be the truth, fitted to the present records.

    candidate: the effect in which it differs from its rivals
    question: number; models with the same number are rivals
    """

    candidate: Candidate
    fit: Fit
    question: int = 0

    @property
    def model(self) -> Model:
        """The fitted model, for records with a correct clock."""
        return self.fit.model.with_record_shift({})

    def __str__(self) -> str:
        return str(self.candidate)


def rivals_of(diagnosis: Diagnosis) -> tuple[Rival, ...]:
    """Models that the records of a diagnosis leave open; empty where the records decide.

    For each accepted effect, the effects that could replace it (`open_questions`) do so in turn.
    Where there are none, and the verdict is undecided or more is missing: the best few effects that
    would be added next.
    """
    rivals: list[Rival] = []
    questions = open_questions(diagnosis)
    for number, question in enumerate(questions):
        if question.added is not None:
            rivals += _rivals_of_question(diagnosis, question, number)
    if not rivals:
        next_ones = [q for q in questions if q.added is None]
        rivals = [Rival(c, fit) for q in next_ones for c, fit in q.others]
    return tuple(rivals) if len(rivals) > 1 else ()


def _rivals_of_question(diagnosis: Diagnosis, question: OpenQuestion, number: int) -> list[Rival]:
    """The accepted effect of a question and its rivals, each in the final model."""
    assert question.added is not None
    rivals = [Rival(question.added, diagnosis.estimated, number)]
    for candidate, other_fit in question.others:
        fit = rival_instead(diagnosis, question.added, candidate, other_fit)
        if fit is not None:
            rivals.append(Rival(candidate, fit, number))
    return rivals if len(rivals) > 1 else []


def rival_instead(diagnosis: Diagnosis, added: Candidate, other: Candidate, fit: Fit) -> Fit | None:
    """The final model with another effect in place of an accepted one; None: not possible.

    The effect that the accepted one replaced is back, unless the other was compared without it too.
    fit: the fit by which the other effect was compared
    """
    effect, at = other.effect, other.at
    names = effect.parameters
    values = {n: fit.model.parameters[f"{at}.{effect.name}.{n}"].value for n in names}
    model = diagnosis.estimated.model
    if model.body(at).has(effect.name):
        return None  # a later rung has added it beside
    rung = next(r for r in diagnosis.rungs if r.added == added)
    gone = rung.instead_of
    try:
        model = rung.undo_addition(model)
        if gone is not None and not fit.model.body(gone.at).has(gone.effect.name):
            model = model.without_effect(gone.effect.name, at=gone.at)  # the other needs it no more
        return estimate(model.with_effect(effect, at=at, values=values), diagnosis.prepared)
    except ModelError:
        return None  # a later effect needs the one that would go


def depends_on_time(rivals: Sequence[Rival]) -> bool:
    """Whether the law of an effect in question depends on time itself, as in a warm-up."""
    return any(r.candidate.effect.expression().has(SIGNALS["time"]) for r in rivals)


def pairs(rivals: Sequence[Rival]) -> list[tuple[int, int]]:
    """(truth, other): both orders of every two rivals of one question."""
    return [
        (i, j)
        for i, a in enumerate(rivals)
        for j, b in enumerate(rivals)
        if i != j and a.question == b.question
    ]
