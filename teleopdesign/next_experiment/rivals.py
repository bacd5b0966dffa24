"""The models that an experiment should distinguish: those that the present records leave open."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..base.errors import ModelError
from ..diagnose.candidates import Candidate
from ..diagnose.diagnosis import Diagnosis
from ..diagnose.fit import Fit, estimate
from ..diagnose.rung import restore_replaced, undo_addition
from ..diagnose.statements import OpenQuestion, OpenRival
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

    For each accepted effect, the effects that could replace it (`Diagnosis.open`) do so in turn.
    Where there are none, and the verdict is undecided or more is missing: the best few effects that
    would be added next.
    """
    rivals: list[Rival] = []
    questions = diagnosis.questions
    for number, question in enumerate(questions):
        if question.added is not None:
            rivals += _rivals_of_question(diagnosis, question, number)
    if not rivals:
        next_ones = [q for q in questions if q.added is None]
        rivals = [Rival(r.candidate, diagnosis.fit(r.model)) for q in next_ones for r in q.others]
    return tuple(rivals) if len(rivals) > 1 else ()


def _rivals_of_question(diagnosis: Diagnosis, question: OpenQuestion, number: int) -> list[Rival]:
    """The accepted effect of a question and its rivals, each in the final model."""
    assert question.added is not None
    rivals = [Rival(question.added, diagnosis.fit(_estimated_model(diagnosis)), number)]
    for other in question.others:
        fit = rival_instead(diagnosis, question.added, other)
        if fit is not None:
            rivals.append(Rival(other.candidate, fit, number))
    return rivals if len(rivals) > 1 else []


def _estimated_model(diagnosis: Diagnosis) -> Model:
    """The final model before its parameters were corrected for errors of the readings."""
    return diagnosis.model if diagnosis.estimated is None else diagnosis.estimated


def rival_instead(diagnosis: Diagnosis, added: Candidate, other: OpenRival) -> Fit | None:
    """The final model with another effect in place of an accepted one; None: not possible.

    The effect that the accepted one replaced is back, unless the other was compared without it too.
    """
    effect, at = other.candidate.effect, other.candidate.at
    compared, names = other.model, effect.parameters
    values = {n: compared.parameters[f"{at}.{effect.name}.{n}"].value for n in names}
    model = _estimated_model(diagnosis)
    if model.body(at).has(effect.name):
        return None  # a later row has added it beside
    row = next(r for r in diagnosis.rungs if r.added == added)
    first, gone = diagnosis.before.model, None
    if row.instead_of is not None:
        gone = Candidate(first.body(added.at).effect(row.instead_of), added.at)
    try:
        model = undo_addition(model, added, None if gone is None else restore_replaced(gone, first))
        if gone is not None and not compared.body(gone.at).has(gone.effect.name):
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
