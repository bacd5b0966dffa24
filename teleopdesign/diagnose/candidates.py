"""Which effects may be missing: those of the catalogue that the model could take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from ..blocks.body import ONE_ONLY
from ..effects import CONTACT_ROLES, SIGNALS, Effect
from ..measurement.motion import Motion
from ..model import Model


@dataclass(frozen=True)
class Candidate:
    """An effect at a place."""

    effect: Effect
    at: str

    @property
    def key(self) -> tuple[str, str]:
        """(name, place), as answers write it."""
        return self.effect.name, self.at

    def __str__(self) -> str:
        return f"{self.effect.name} at {self.at}"


#: path over travel from which a motion counts as one that comes back to where it was
COMES_BACK = 1.5


def candidates(model: Model, motions: Sequence[Motion] = ()) -> tuple[Candidate, ...]:
    """Effects that the model lacks and could take, at each of its places.

    motions: those that decide; where a body only ever goes on, place and time are one, and no
    effect of the place can be told from a drift: it is no candidate there
    """
    possible = []
    for place in model.places:
        body = model.body(place)
        roles = {e.role for e in body.effects} & set(ONE_ONLY)
        for effect in model.known.values():
            if (place in model.bodies) == (effect.role in CONTACT_ROLES):
                continue
            if body.has(effect.name) or effect.role in roles or body.axis in effect.elsewhere:
                continue
            if effect.expression().has(SIGNALS["position"]) and not _comes_back(place, motions):
                continue
            if not body.lacks(effect):
                possible.append(Candidate(effect, place))
    return tuple(possible)


def _comes_back(place: str, motions: Sequence[Motion]) -> bool:
    positions = [m.position for m in motions if m.body == place]
    return not positions or any(
        float(np.sum(np.abs(np.diff(x)))) > COMES_BACK * float(np.ptp(x)) for x in positions
    )


def started(model: Model, scale: dict[str, float]) -> list[Model]:
    """The model with its absent effects at each combination of their starting values.

    scale: quantity -> the record's own size of it (SI)
    returns: the model itself where no effect is absent
    """
    models = [model]
    for name, place in model.absent:
        parameters = model.body(place).effect(name).parameters
        free = [
            n
            for n, p in parameters.items()
            if p.search.chosen or not model.parameters[f"{place}.{name}.{n}"].fixed
        ]
        grids = [
            [m * scale[parameters[n].scale] for m in parameters[n].search.starts] for n in free
        ]
        names = [f"{place}.{name}.{n}" for n in free]
        models = [
            m.with_values(dict(zip(names, values, strict=True)))
            for m in models
            for values in product(*grids)
        ]
    return models
