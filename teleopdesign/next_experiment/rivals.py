"""The models that an experiment should distinguish: those that the present records leave open.

Their separation along a motion is to first order. One model is the truth; the force that it needs
along a motion acts on the other, whose parameters are re-estimated on the present records and the
new one together:

    left = d + J step,   step = -(N + J'J)^-1 J'd,   d = residual(other) - residual(truth)

with J the tangents of the other's residual along the new motion and N those of the present fit.
Sums over parts of a motion add, so any composition of parts is evaluated without new residuals.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ModelError
from ..diagnose.candidates import Candidate
from ..diagnose.diagnosis import Diagnosis
from ..diagnose.fit import Fit, estimate
from ..diagnose.least_squares import solve_normal
from ..diagnose.residual import relative_residuals
from ..diagnose.rung import restore_replaced, undo_addition
from ..diagnose.statements import OpenQuestion, OpenRival
from ..effects import SIGNALS
from ..measurement.filtering import Array
from ..measurement.prepare import Prepared, Stretch
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


@dataclass(frozen=True)
class Sums:
    """Sums over the rows of k parts (leading axis) for one truth and one other model.

    squares: of d, (k,);  gradient: J'd, (k, p);  normal: J'J, (k, p, p)
    noise: (k,) squares of the truth's residual, or of the noise floor of the present records in as
        many rows, whichever is larger
    present: normal matrix of the present fit records, (p, p)
    """

    squares: Array
    gradient: Array
    normal: Array
    noise: Array
    present: Array

    def separation(self, parts: Sequence[int] | NDArray[np.intp]) -> float:
        """Remaining error along these parts, in noise floors of the parts."""
        chosen = list(parts)
        normal, gradient = self.normal[chosen].sum(0), self.gradient[chosen].sum(0)
        step = -solve_normal(self.present + normal, gradient)
        left = float(self.squares[chosen].sum() + 2 * gradient @ step + step @ normal @ step)
        noise = float(self.noise[chosen].sum())
        return float(np.sqrt(max(left, 0.0) / max(noise, 1e-300)))


def normal_matrix(rival: Rival, prepared: Prepared) -> Array:
    """J'J of a model by its free parameters on the fit records."""
    stretches = prepared.of("fit")
    parts = relative_residuals(rival.model, stretches, rival.fit.free)
    p = len(rival.fit.free)
    return sum(
        (s.weight * d @ d.T for s, (_, d) in zip(stretches, parts, strict=True)), np.zeros((p, p))
    )


def sums_of(
    other: Rival,
    truth_left: Sequence[Array],
    stretches: Sequence[Stretch],
    part_of: Sequence[int],
    present: Array,
    floor: float,
) -> Sums:
    """The sums for one other model, along parts that were simulated with one truth.

    truth_left: the truth's residual on the rows that count, per stretch
    part_of: number of the part of each stretch
    floor: force (rms) that sensors leave on the present records. A motion that hardly moves the
        body has a lower floor, but the present records limit the accuracy
    """
    k, p = max(part_of) + 1, len(other.fit.free)
    squares, noise, rows = np.zeros(k), np.zeros(k), np.zeros(k)
    gradient, normal = np.zeros((k, p)), np.zeros((k, p, p))
    parts = relative_residuals(other.model, stretches, other.fit.free)
    for i, s, truth_residual, (r, d) in zip(part_of, stretches, truth_left, parts, strict=True):
        apart = r - truth_residual
        squares[i] += s.weight * float(apart @ apart)
        gradient[i] += s.weight * (d @ apart)
        normal[i] += s.weight * (d @ d.T)
        noise[i] += s.weight * float(truth_residual @ truth_residual)
        rows[i] += s.weight * len(s.keep)
    return Sums(squares, gradient, normal, np.maximum(noise, rows * floor**2), present)


def floor_force(prepared: Prepared, floor: float) -> float:
    """Force (rms) that sensors leave on the check records (without these, on the fit records).

    floor: noise floor as a relative error
    """
    check = prepared.of("check") or prepared.of("fit")
    return floor * rms_measured(check)


def rms_measured(stretches: Sequence[Stretch]) -> float:
    """Rms of the measured force over the rows that count."""
    rows = sum(s.weight * len(s.keep) for s in stretches)
    return float(np.sqrt(sum(s.measured for s in stretches) / rows))


def present_separation(truth: Rival, other: Rival, prepared: Prepared, floor: float) -> float:
    """The separation on the check records of the present data, if `truth` is true.

    Without check records: on the fit records.  floor: relative noise floor
    """
    fit, check = prepared.of("fit"), prepared.of("check") or prepared.of("fit")
    present = normal_matrix(other, prepared)
    on_fit = _sums_against(truth, other, fit, present)
    step = -solve_normal(present, on_fit.gradient.sum(0))
    shown = on_fit if check is fit else _sums_against(truth, other, check, present)
    left = float(
        shown.squares.sum() + 2 * shown.gradient.sum(0) @ step + step @ shown.normal.sum(0) @ step
    )
    return float(np.sqrt(max(left, 0.0) / sum(s.measured for s in check)) / floor)


def _sums_against(truth: Rival, other: Rival, stretches: Sequence[Stretch], present: Array) -> Sums:
    truth_left = [r for r, _ in relative_residuals(truth.model, stretches)]
    return sums_of(other, truth_left, stretches, [0] * len(stretches), present, 0.0)
