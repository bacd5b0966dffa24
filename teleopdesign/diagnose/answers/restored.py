"""Read a diagnosis back from its answer file and its experiment, without a new search or fit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ...base.errors import ExperimentError, ModelError
from ...blocks import with_block_effects
from ...effects import EFFECTS, Effect, are_alike
from ...measurement.experiment import Experiment
from ...measurement.prepare import Prepared, prepare
from ...model import Model
from ..candidates import Candidate
from ..diagnosis import Diagnosis, OpenQuestion, SetAside, Undetermined
from ..effort import EFFORTS
from ..fit import Fit, estimate
from ..learnable import learnable_from, read_near_reversals
from ..noise_floor import NoiseFloor
from ..one_moment import Moment
from ..ranking import Ranking
from ..repeats import read_repeats
from ..rung import Replaced, Rung, restore_replaced
from ..search_plan import cut_to_windows
from .bodies import known_effect, model_from
from .saved import SavedAnswer

#: fields of an answer that older answers lack
_NEEDED = ("models", "floor", "open", "bandwidth")


@dataclass(frozen=True)
class _Steps:
    """The content of an answer as objects, before any residual is computed.

    models: of each rung
    estimated: the last model, before the error of its readings was removed
    added, replaced, equals, could_be: of each rung
    open: for each question, the accepted effect, and its rivals with their models
    """

    models: tuple[Model, ...]
    estimated: Model
    added: tuple[Candidate | None, ...]
    replaced: tuple[Replaced | None, ...]
    equals: tuple[tuple[Candidate, ...], ...]
    could_be: tuple[tuple[Candidate, ...] | None, ...]
    open: tuple[tuple[Candidate | None, tuple[tuple[Candidate, Model], ...]], ...]


def restore_diagnosis(
    saved: SavedAnswer,
    experiment: Experiment,
    known: Mapping[str, Effect] = EFFECTS,
    *,
    records: Prepared | None = None,
) -> Diagnosis:
    """The diagnosis in an answer, with its errors; residuals are computed, nothing is estimated.

    known: effects by name, with those of the user
    records: prepared records, as of an arm's joint; None: they are prepared here
    It has no rankings: the candidates are in the answer, open questions in `Diagnosis.open`.
    raises ExperimentError: the answer is to another experiment or of an earlier version, or an
        effect is unknown
    """
    saved.require(experiment)
    steps, content = steps_of(saved, known), saved.content
    for model in (*steps.models, steps.estimated, *(m for _, o in steps.open for _, m in o)):
        saved.require_bodies(model, experiment)
    whole = records or prepare(experiment, bandwidth=float(content["bandwidth"]["value"]))
    prepared = cut_to_windows(whole) if records is None else whole
    fits = [
        with_errors_of(row, evaluate_fit(model, prepared))
        for model, row in zip(steps.models, content["ladder"], strict=True)
    ]
    fits[-1] = replace(fits[-1], at_bound=tuple(content.get("at_bound", ())))
    rungs = tuple(
        Rung(added, fit, None, equals, replaced, could_be)
        for added, fit, equals, replaced, could_be in zip(
            steps.added, fits, steps.equals, steps.replaced, steps.could_be, strict=True
        )
    )
    return Diagnosis(
        experiment=experiment,
        prepared=whole,
        verdict=saved.verdict,
        rungs=rungs,
        last=Ranking(fits[-1], ()),
        estimated=evaluate_fit(steps.estimated, prepared),
        floor=_floor(content),
        moment=_moment(content.get("one_moment")),
        on_all_records=content.get("on_all_records"),
        learnable=learnable_from(content),
        near_reversals=read_near_reversals(content),
        repeats=read_repeats(content),
        named=tuple(c for c in steps.added if c is not None and c.key in _named_effects(content)),
        open=tuple(
            OpenQuestion(added, tuple((c, evaluate_fit(m, prepared)) for c, m in others))
            for added, others in steps.open
        ),
        left_out=tuple(content.get("left_out", ())),
        undetermined=tuple(
            Undetermined(_restore_candidate(saved, row, known, "cannot_tell"), row["sentence"])
            for row in content.get("cannot_tell", ())
        ),
        set_aside=_set_aside(saved, known),
        recorded=content,
    )


def _set_aside(saved: SavedAnswer, known: Mapping[str, Effect]) -> tuple[SetAside, ...]:
    """Effects that were accepted and later removed, each with the reason."""
    return tuple(
        SetAside(
            _restore_candidate(saved, row, known, "set_aside"),
            error_from(row["check_error"]),
            row["reason"],
        )
        for row in saved.content.get("set_aside", ())
    )


def with_errors_of(row: Mapping[str, Any], fit: Fit) -> Fit:
    """A fit with the errors that a row of an answer states; NaN where the row states none."""
    return replace(
        fit, fit_error=error_from(row["fit_error"]), check_error=error_from(row["check_error"])
    )


def evaluate_fit(model: Model, prepared: Prepared) -> Fit:
    """A fit with the residuals of a model and their derivatives; no parameter changes.

    Without check records, the held-out blocks are fitted from these values, as by `estimate`.
    """
    return replace(estimate(model, prepared, effort=EFFORTS.stay), model=model)


def steps_of(saved: SavedAnswer, known: Mapping[str, Effect]) -> _Steps:
    """The models and candidates of an answer.

    raises ExperimentError: the answer is of an earlier version, or its parts contradict each other
    """
    _require_models(saved)
    content = saved.content
    rows, models = content["ladder"], content["models"]

    def model(data: Mapping[str, Any], key: str) -> Model:
        return model_from(data, known, file=saved.file, key=key)

    def candidate(place: Mapping[str, Any], key: str, *there: Model) -> Candidate:
        effects = with_block_effects(known)
        effect = known_effect(place["effect"], effects, where=f"{saved.file}: {key}")
        return _candidate_in_model(saved, Candidate(effect, place["at"]), key, there)

    ladder = tuple(model(data, "models.ladder") for data in models["ladder"])
    estimated = model(models["estimated"], "models.estimated")
    last = (ladder[-1], estimated)
    added = tuple(
        None if row["added"] is None else candidate(row["added"], "ladder", *last) for row in rows
    )
    if added[0] is not None or None in added[1:]:
        raise ExperimentError(
            f"{saved.file}: ladder: expected the user's model first (added: null), then effects"
        )
    alike = {
        (group[0]["effect"], group[0]["at"]): tuple(
            candidate(place, "indistinguishable") for place in group[1:]
        )
        for group in content["indistinguishable"]
        if not _is_named_nonetheless(group, known)
    }
    questions = []
    for question in content["open"]:
        first = question["added"]
        others = []
        for row in question["others"]:
            there = model(row["model"], "open")
            others.append((candidate(row, "open", there), there))
        instead = None if first is None else candidate(first, "open", *last)
        questions.append((instead, tuple(others)))
    equals = tuple(() if one is None else alike.get(one.key, ()) for one in added)
    replaced = []
    for row in rows:
        instead = row.get("instead_of")
        if instead is not None and row["added"] is None:
            raise ExperimentError(f"{saved.file}: ladder: instead_of: found it beside added: null")
        place = None if instead is None else {"effect": instead, "at": row["added"]["at"]}
        gone = None if place is None else candidate(place, "ladder", ladder[0])
        replaced.append(None if gone is None else restore_replaced(gone, ladder[0]))
    could_be = tuple(
        None
        if row.get("could_be") is None
        else tuple(candidate(place, "ladder") for place in row["could_be"])
        for row in rows
    )
    return _Steps(ladder, estimated, added, tuple(replaced), equals, could_be, tuple(questions))


def _require_models(saved: SavedAnswer) -> None:
    """Refuse an answer that lacks data for restoring, or a model for each row of its ladder.

    raises ExperimentError: it lacks them
    """
    content = saved.content
    for key in _NEEDED:
        if key not in content:
            raise ExperimentError(
                f'{saved.file}: no key "{key}": the answer of an earlier version, from which a '
                "diagnosis cannot be taken up again; diagnose anew, or leave --answer out"
            )
    rows, models = content["ladder"], content["models"]
    if len(models["ladder"]) != len(rows):
        raise ExperimentError(
            f"{saved.file}: models.ladder: found {len(models['ladder'])} models, expected "
            f"{len(rows)}, one for each row of the ladder"
        )


def _candidate_in_model(
    saved: SavedAnswer, candidate: Candidate, key: str, models: tuple[Model, ...]
) -> Candidate:
    for model in models:
        try:
            there = model.body(candidate.at).has(candidate.effect.name)
        except ModelError as error:
            raise ExperimentError(f"{saved.file}: {key}: {candidate}: {error}") from error
        if not there:
            raise ExperimentError(f"{saved.file}: {key}: {candidate}: its model has no such effect")
    return candidate


def _is_named_nonetheless(group: Sequence[Mapping[str, Any]], known: Mapping[str, Effect]) -> bool:
    """Whether a group is one of `Diagnosis.look_alikes`, which leaves no verdict open."""
    effects = [known.get(place["effect"]) for place in group]
    one, other = effects[0], effects[-1]
    return len(group) == 2 and one is not None and other is not None and are_alike(one, other)


def _restore_candidate(
    saved: SavedAnswer, row: Mapping[str, Any], known: Mapping[str, Effect], key: str
) -> Candidate:
    """The candidate of a row, whether or not a model of the answer has this effect."""
    effects = with_block_effects(known)
    return Candidate(known_effect(row["effect"], effects, where=f"{saved.file}: {key}"), row["at"])


def _named_effects(content: Mapping[str, Any]) -> set[tuple[str, str]]:
    return {(place["effect"], place["at"]) for place in content["missing"]}


def error_from(number: float | None) -> float:
    return float("nan") if number is None else float(number)


def _floor(content: Mapping[str, Any]) -> NoiseFloor:
    return NoiseFloor(
        value=float(content["noise_floor"]),
        source=str(content.get("noise_floor_source", "as the answer says")),
        drawn=float(content["floor"]["drawn"]),
        held=bool(content["floor"]["held"]),
    )


def _moment(entry: Mapping[str, Any] | None) -> Moment | None:
    if entry is None:
        return None
    begin, end = (float(entry[key]["value"]) for key in ("begin", "end"))
    return Moment(
        entry["record"], entry["at"], begin, end, float(entry["left_over_noise_floors_without"])
    )
