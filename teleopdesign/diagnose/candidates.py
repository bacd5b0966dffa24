"""Candidates: effects of the catalogue that the model lacks and could have."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import sympy as sp

from ..base.errors import ExperimentError
from ..blocks.body import ONE_ONLY
from ..check.hidden_motion import FOR_EACH
from ..effects import (
    CONTACT_ROLES,
    SIGNALS,
    Effect,
    Parameter,
    are_alike,
    delayed,
    depends_on_position,
    depends_on_time,
    period,
)
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from ..model import Model


@dataclass(frozen=True)
class Candidate:
    """An effect at a place of the model."""

    effect: Effect
    at: str

    @property
    def key(self) -> tuple[str, str]:
        """(name, place), as answers write it."""
        return self.effect.name, self.at

    def __str__(self) -> str:
        return f"{self.effect.name} at {self.at}"


#: place and time differ enough if the variance of time among samples of one place is more than this
#: share of the whole. A sweep that returns over a quarter of its travel has 0.06, over a third
#: 0.13, a full return 1. A lower limit confuses a drift with a force of the place; a higher one
#: leaves fewer candidates
RETURNING_SHARE = 0.1
#: bins of the travel, or of the range of speeds, for this test: each covers 1/50, far less than a
#: return
PLACES = 50


def candidates(
    model: Model,
    motions: Sequence[Motion] = (),
    *,
    separate_zeros: Collection[str] = (),
    measured: Collection[str] = (),
) -> tuple[Candidate, ...]:
    """Effects that the model lacks and could take, at each of its places.

    A curve without a named law (`Effect.free`) is no candidate: it would do better than any law. An
    effect that could imitate other effects is a candidate only after these were added
    (`Effect.after`). An effect whose law uses a channel that the records lack is no candidate. Nor
    is an effect of the position, where a body never returns to a place at another time: there it
    cannot be separated from a drift. A periodic effect also returns after each of its periods. Nor
    is an effect of time, where the speed itself follows time.

    motions: of all records
    separate_zeros: files whose positions cannot be compared with those of other files
    measured: bodies whose actuator force was measured, not commanded: a limit, a lag or a delay has
        acted already and is no candidate; the scale of the force may still be wrong, or vary
    """
    possible = []
    for place in model.places:
        body = model.body(place)
        roles = {e.role for e in body.effects} & set(ONE_ONLY)
        motions_here = [m for m in motions if m.body == model.holder(place)]
        for effect in model.known.values():
            if effect.free or (place in model.bodies) == (effect.role in CONTACT_ROLES):
                continue
            if model.holder(place) in measured and _acts_before_what_is_measured(effect):
                continue
            if body.has(effect.name) or effect.role in roles or body.axis in effect.counterparts:
                continue
            if body.lacks(effect) or comes_too_early(effect, place, model):
                continue
            if any(not effect.channels() <= set(m.further) for m in motions_here):
                continue
            if _is_distinguishable(effect, motions_here, separate_zeros):
                possible.append(Candidate(effect, place))
    return tuple(possible)


def comes_too_early(effect: Effect, at: str, model: Model) -> bool:
    """Whether a place lacks a known effect that this one could imitate (`Effect.after`)."""
    return any(n in model.known and not model.body(at).has(n) for n in effect.after)


def restrict_to_curve(model: Model, speeds: float = math.inf) -> Model:
    """The model to which only friction of the speed and a constant force may be added.

    speeds: number of different speeds, which limits the parameters that may be added
    raises ExperimentError: the model has another effect, which needs a time
    """
    for place, body in model.bodies.items():
        for effect in body.effects:
            if not is_static(effect):
                raise ExperimentError(
                    f"model.{place}.effects: {effect.name} needs a time, which a friction curve "
                    "has not: expected friction of the speed, and bias"
                )
    fitting = (e for e in model.known.values() if fits_curve(e, model, speeds))
    return replace(model, known={e.name: e for e in fitting})


def fits_curve(effect: Effect, model: Model, speeds: float) -> bool:
    """Whether an effect is static, and so many different speeds can determine it.

    These are `FOR_EACH` times the parameters of the model with those of the effect.
    """
    values = (v for n, v in model.parameters.items() if not n.endswith(".inertia"))
    new = sum(not p.optional for p in effect.parameters.values())
    return is_static(effect) and FOR_EACH * (sum(not v.fixed for v in values) + new) <= speeds


def list_look_alikes(candidate: Candidate, model: Model) -> list[Candidate]:
    """Effects that the model lacks and that look like the candidate, at the same place.

    One of the two is the commoner by its file (`Effect.commoner`), or the candidate is what the
    other one is on another axis (`Effect.counterparts`), as a constant force is for gravity.
    """
    body, at = model.body(candidate.at), candidate.at
    return [
        Candidate(e, at)
        for e in model.known.values()
        if (are_alike(candidate.effect, e) or candidate.effect.name in e.counterparts.values())
        and not body.has(e.name)
        and body.axis not in e.counterparts
    ]


def bodies_with_measured_force(experiment: Experiment) -> set[str]:
    """Bodies whose actuator force was measured, as their channels state."""
    return {c.body for c in experiment.channels.values() if c.measured and c.body is not None}


@lru_cache(maxsize=256)
def is_static(effect: Effect) -> bool:
    """Whether an effect is a friction of the speed alone, or a constant force."""
    of_speed = {SIGNALS["velocity"], SIGNALS["direction"]}
    signals = effect.expression().free_symbols & set(SIGNALS.values())
    return effect.role in ("force", "friction_level") and not effect.states and signals <= of_speed


@lru_cache(maxsize=256)
def _acts_before_what_is_measured(effect: Effect) -> bool:
    """Whether an actuation effect does more to a command than scale it."""
    if effect.role != "actuation":
        return False
    law = effect.expression()
    scale = sp.diff(law, SIGNALS["command"])
    return bool(effect.states or law.has(delayed) or scale.has(SIGNALS["command"]))


def _is_distinguishable(
    effect: Effect, motions: Sequence[Motion], separate_zeros: Collection[str]
) -> bool:
    """Whether the motions separate an effect of position or time from effects that look like it.

    An effect of position must differ from one of time, and an effect of time from one of speed.
    """
    if motions and depends_on_time(effect) and not tells_speed_from_time(motions):
        return False
    if not motions or not depends_on_position(effect):
        return True
    repeats = period(effect)
    # a period that is a parameter: the fit decides whether the record shows repeats
    if isinstance(repeats, str):
        return True
    return tells_place_from_time(motions, separate_zeros=separate_zeros, turn=repeats)


def tells_place_from_time(
    motions: Sequence[Motion], *, separate_zeros: Collection[str] = (), turn: float | None = None
) -> bool:
    """Whether a body returns to the same places at different times, in all of its motions together.

    separate_zeros: files whose positions cannot be compared with those of other files
    turn: period (m, rad); places that differ by a multiple of it are the same; None: no period
    """
    groups: dict[str, list[Motion]] = {}
    for motion in motions:
        groups.setdefault(motion.file if motion.file in separate_zeros else "", []).append(motion)
    among = whole = 0.0
    for group in groups.values():
        position = np.concatenate([m.position for m in group])
        time = np.concatenate([m.time for m in group])
        # weighted by travel: a body at rest shows one position only, however long it rests
        way = np.concatenate([np.abs(np.gradient(m.position)) * (m.direction != 0) for m in group])
        if not way.any():
            continue
        here = np.mod(position, turn) if turn is not None else position
        spread = _spread_of_time(here, time, way)
        among, whole = among + spread[0], whole + spread[1]
    # whole = 0: no motion is certain
    return among > RETURNING_SHARE * whole or whole == 0.0


def tells_speed_from_time(motions: Sequence[Motion]) -> bool:
    """Whether a body has the same speeds at different times of its records, all taken together.

    Where the speed only grows in each record, friction that changes with time cannot be separated
    from friction that changes with speed.
    """
    speed = np.concatenate([np.abs(m.velocity) for m in motions])
    time = np.concatenate([m.time for m in motions])
    moving = np.concatenate([m.sample_time * (m.direction != 0) for m in motions])
    if not moving.any():
        return True
    among, whole = _spread_of_time(speed, time, moving)
    return among > RETURNING_SHARE * whole


def _spread_of_time(values: Array, time: Array, weight: Array) -> tuple[float, float]:
    """Weighted squares of time: about its mean at equal values, and about its overall mean."""
    size = float(np.ptp(values)) or 1.0
    bins = np.minimum(((values - values.min()) / size * PLACES).astype(int), PLACES - 1)
    there = np.bincount(bins, weight, PLACES)
    mean = np.bincount(bins, weight * time, PLACES) / np.where(there > 0.0, there, 1.0)
    among = float(weight @ (time - mean[bins]) ** 2)
    return among, float(weight @ (time - (weight @ time) / weight.sum()) ** 2)


def make_starts(model: Model, scale: dict[str, float]) -> list[Model]:
    """The model with its absent effects at each combination of their starting values.

    scale: quantity -> its size in the records (SI); a start outside of a parameter's range is
        taken at the end of the range
    returns: the model alone where no effect is absent
    """
    models = [model]
    for name, place in model.absent:
        parameters = model.body(place).effect(name).parameters
        turns = model.body(place).axis == "revolute"
        stated = {n: model.parameters[f"{place}.{name}.{n}"].value for n in parameters}
        held = any(stated[n] for n, p in parameters.items() if p.search.held)
        free = [
            n
            for n, p in parameters.items()
            if (p.search.chosen and not (p.search.held and held))
            or not model.parameters[f"{place}.{name}.{n}"].fixed
        ]
        starts = [{n: v for n, v in stated.items() if n not in free}]
        for n in free:
            starts = [
                s | {n: value}
                for s in starts
                for value in _starts_of(parameters[n], scale, s, turns=turns)
            ]
        models = [
            m.with_values({f"{place}.{name}.{n}": value for n, value in s.items()})
            for m in models
            for s in starts
        ]
    return models


def _starts_of(
    parameter: Parameter, scale: dict[str, float], others: dict[str, float], *, turns: bool
) -> list[float]:
    """Start values of a parameter; others: those of the effect's parameters before it."""
    search = parameter.search
    unit = others[search.of] if search.of else scale[parameter.scale]
    starts = [m * unit for m in search.starts]
    if turns:
        of_a_turn = [2.0 * np.pi / k for k in range(1, search.of_a_turn + 1)]
        starts += [s for s in of_a_turn if s < min(starts)]
    return list(dict.fromkeys(min(max(s, parameter.lower), parameter.upper) for s in starts))
