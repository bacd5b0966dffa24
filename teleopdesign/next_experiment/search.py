"""The sequence of candidate parts that separates the rivals best."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..diagnose.residual import relative_residuals
from ..measurement.filtering import Array
from ..measurement.prepare import Prepared, prepare
from .family import PathPart
from .limits import Limits
from .rivals import Rival, Sums, normal_matrix, pairs, sums_of
from .synthesis import Bench, PlannedMotion, plan_motion, record_under

#: an additional part may lower the value of the chosen parts by this share, because it dilutes them
DILUTES = 0.02


@dataclass(frozen=True)
class SafeParts:
    """The parts that keep the limits, and the separation of each pair of rivals along them.

    sums: (truth, other) -> sums over the parts
    """

    parts: tuple[PathPart, ...]
    sums: Mapping[tuple[int, int], Sums]

    def worth(self, chosen: Sequence[int]) -> float:
        """Value of a composition: sum over pairs of s^2/(s^2 + 1), s for the less favourable truth.

        s is in noise floors; well above one, a larger s adds almost nothing.
        """
        both: dict[frozenset[int], list[float]] = {}
        for pair, sums in self.sums.items():
            both.setdefault(frozenset(pair), []).append(sums.separation(chosen))
        return sum(min(s) ** 2 / (min(s) ** 2 + 1.0) for s in both.values())

    def best(self, pair: tuple[int, int]) -> float:
        """The largest separation of a pair along any single part, for the less favourable truth."""
        orders = [p for p in self.sums if set(p) == set(pair)]
        parts = range(len(self.parts))
        least = (min(self.sums[p].separation([k]) for p in orders) for k in parts)
        return max(least, default=0.0)


def try_parts(
    parts: Sequence[PathPart],
    rivals: Sequence[Rival],
    prepared: Prepared,
    bench: Bench,
    limits: Mapping[str, Limits],
    *,
    floor: float,
    seed: int,
) -> SafeParts:
    """Separations along each part, with each rival in turn as the truth.

    floor: force (rms) that sensors leave on the present records;  seed: of the sensors' errors
    """
    plans = [plan_motion(p.path, bench) for p in parts]
    simulated = {i: _simulate_plans(r, plans, bench, seed) for i, r in enumerate(rivals)}
    safe = [k for k in range(len(parts)) if all(_is_safe(m, k, limits) for m in simulated.values())]
    present = [normal_matrix(r, prepared) for r in rivals]
    sums: dict[tuple[int, int], Sums] = {}
    for i, truth in enumerate(rivals):
        stretches = [s for s in simulated[i].stretches if _number(s.motion.file) in safe]
        numbers = [safe.index(_number(s.motion.file)) for s in stretches]
        if not stretches:
            break
        residuals = [r for r, _ in relative_residuals(truth.model, stretches)]
        for j, other in enumerate(rivals):
            if (i, j) in pairs(rivals):
                sums[i, j] = sums_of(other, residuals, stretches, numbers, present[j], floor)
    return SafeParts(tuple(parts[k] for k in safe), sums)


def _simulate_plans(
    rival: Rival, plans: Sequence[PlannedMotion], bench: Bench, seed: int
) -> Prepared:
    """Prepared records of all plans, with this rival as the truth."""
    records = tuple(
        record_under(
            rival.model,
            plan,
            bench,
            np.random.default_rng([seed, k]),
            file=str(k),
            use="fit",
        )
        for k, plan in enumerate(plans)
    )
    return prepare(replace(bench.experiment, records=records), bandwidth=bench.bandwidth)


def _number(file: str) -> int:
    return int(file)


def _is_safe(simulated: Prepared, part: int, limits: Mapping[str, Limits]) -> bool:
    """Whether the command of every body keeps its limit along a part."""
    signals = simulated.experiment.records[part].signals
    return all(
        float(np.abs(signals[f"{body}.actuator_force"]).max()) <= limit.force
        for body, limit in limits.items()
    )


def compose(candidates: SafeParts, duration: float, sample_time: float) -> tuple[int, ...]:
    """Choose parts one at a time, by the largest gain, until the time (s) is used.

    returns: numbers of the parts, in order
    """
    chosen: list[int] = []
    reached = 0.0
    while True:
        used = sum(len(candidates.parts[k].path) for k in chosen) * sample_time
        left = [
            k
            for k, part in enumerate(candidates.parts)
            if k not in chosen and (not chosen or used + len(part.path) * sample_time <= duration)
        ]
        if not left:
            return tuple(chosen)
        worth, best = max((candidates.worth([*chosen, k]), k) for k in left)
        if chosen and worth < (1.0 - DILUTES) * reached:
            return tuple(chosen)
        chosen.append(best)
        reached = max(reached, worth)


def join_paths(parts: Sequence[PathPart]) -> Array:
    """The paths of the parts, one after the other."""
    return np.concatenate([p.path for p in parts])
