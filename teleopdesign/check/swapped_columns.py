"""Swapped columns of one quantity: those of two bodies, which fit far better exchanged."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import combinations

from ..base.finding import Finding
from ..measurement.experiment import Experiment
from ..measurement.prepare import Prepared, prepare
from ..model import Model
from .force_balance import ForceBalance, force_balances

#: columns may be swapped if at least UNEXPLAINED of the force is left unexplained, and swapping
#: them leaves less than SWAPPED of this
UNEXPLAINED, SWAPPED = 0.25, 0.5


def check_swapped(
    model: Model, prepared: Prepared, balances: Mapping[str, ForceBalance]
) -> Iterator[Finding]:
    """Findings on columns that fit far better if swapped, where the residual is large."""
    before = _find_worst(balances)
    if before < UNEXPLAINED or len(model.bodies) < 2:
        return
    keys = prepared.experiment.channels
    for one, two in combinations(model.bodies, 2):
        for quantity in ("position", "actuator_force", "interaction_force"):
            a, b = f"{one}.{quantity}", f"{two}.{quantity}"
            if a not in keys or b not in keys:
                continue
            other = prepare(
                _exchange_columns(prepared.experiment, a, b), bandwidth=prepared.bandwidth
            )
            after = _find_worst(force_balances(model, other, timed=False))
            if after < SWAPPED * before:
                yield Finding(
                    "swapped columns",
                    "warning",
                    f"the columns of {a} and {b} seem swapped: {100 * before:.2g} % of the force "
                    f"in motion is left unexplained, {100 * after:.2g} % the other way round.",
                    {"as_given": before, "swapped": after},
                )


def _find_worst(balances: Mapping[str, ForceBalance]) -> float:
    return max((b.left for b in balances.values()), default=0.0)


def _exchange_columns(experiment: Experiment, a: str, b: str) -> Experiment:
    records = tuple(
        replace(r, signals={**r.signals, a: r.signals[b], b: r.signals[a]})
        for r in experiment.records
    )
    return replace(experiment, records=records)
