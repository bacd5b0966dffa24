"""Channels of a whole diagram that are stated wrong: by a factor, a sign, or for each other.

A cut whose recorded signal is 1000 times too large lets every block look wrong: gains, inertias and
stiffnesses take up the factor. The stated diagram tells: one change of one column, or of two that
are exchanged, brings all cuts together.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import combinations

import numpy as np

from ..base.errors import TeleopDesignError
from ..base.sentences import percent
from ..measurement.filtering import Array
from ..measurement.limits import HALF
from .channel_search import LEAST_ERROR, ROWS, TURNED, error_at
from .diagram_experiment import DiagramExperiment
from .reading import diagram_experiment

#: factors of a column in another unit, or with the other sign
FACTORS = (-1.0, 1e-3, 1e3, 1e-2, 1e2, 0.1, 10.0, math.pi / 180.0, 180.0 / math.pi)
#: relative error of the worst cut from which channels are doubted, and up to which changed ones are
#: believed: values of a diagram are starts, wrong by tens of per cent
DOUBTED, BELIEVED = 0.5, 0.3


def doubt_channels(experiment: DiagramExperiment) -> str:
    """A sentence on one change of the channels by which the stated diagram fits; "" where none is.

    The product of the errors at all cuts must fall to a tenth: as many logs have a wrong sign.
    """
    columns = experiment.logs[0].columns.values
    data = {name: np.asarray(values)[:ROWS] for name, values in columns.items()}
    here = _errors(experiment, data)
    if not here or max(here.values()) < DOUBTED:
        return ""
    tested = [
        (words, _errors(experiment, changed)) for words, changed in _changes(experiment, data)
    ]
    able = [(w, e) for w, e in tested if e and max(e.values()) < BELIEVED and _agree(here, e)]
    best = min(able, key=lambda one: _log_sum(one[1]), default=None)
    if best is None or _log_sum(best[1]) > _log_sum(here) + math.log(TURNED):
        return ""
    words, there = best
    before, after = (percent(max(e.values())) for e in (here, there))
    return f"{words} the stated diagram is off by {after} at its worst cut, as it is by {before}"


def _agree(here: Mapping[str, float], there: Mapping[str, float]) -> bool:
    """Whether at least two cuts tell the change: one alone may be wrong itself."""
    return sum(there.get(name, math.inf) < HALF * error for name, error in here.items()) > 1


def _changes(
    experiment: DiagramExperiment, data: Mapping[str, Array]
) -> Iterator[tuple[str, dict[str, Array]]]:
    """Each single change of the data, in words."""
    columns = {n: experiment.channel[n].columns for n in experiment.recorded}
    for name, its in columns.items():
        for factor in FACTORS:
            changed = {c: factor * data[c] for c in its}
            yield f"channels.{name}: with {factor:.3g} times its readings", {**data, **changed}
    for a, b in combinations(columns, 2):
        if len(columns[a]) == len(columns[b]) == 1:
            (one,), (other,) = columns[a], columns[b]
            swapped = {**data, one: data[other], other: data[one]}
            yield f"channels.{a} and channels.{b}: exchanged,", swapped


def _errors(experiment: DiagramExperiment, data: Mapping[str, Array]) -> dict[str, float]:
    """Cut -> relative error of the stated diagram; none where the data cannot be read."""
    channels = {n: dict(table.content) for n, table in experiment.channels.items()}
    if experiment.sample_rate is not None:
        channels["sample_rate"] = {"value": experiment.sample_rate, "unit": "Hz"}
    period, outside = experiment.computer.sample_period, list(experiment.zero)
    try:
        made = diagram_experiment(
            experiment.diagram, data, channels=channels, outside=outside, sample_period=period
        )
    except TeleopDesignError:
        return {}
    return {cut.name: error_at(made, cut) for cut in made.cuts.tested}


def _log_sum(errors: Mapping[str, float]) -> float:
    return float(np.sum(np.log(np.clip([*errors.values()], LEAST_ERROR, None))))
