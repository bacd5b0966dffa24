"""The Coulomb level from runs at constant speed, as the papers identify it.

Half the difference of the forces that move a body forward and backward at one speed is its friction
at that speed: gravity, offsets and all forces that depend on position alone cancel if both runs
cover the same travel. A straight line through friction over speed gives the Coulomb level at rest,
and the viscous damping as its slope.

Bernstein, Lawrence, Pao, World Haptics 2005, section 5; Mahvash, Okamura, ICRA 2006, figure 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.errors import ExperimentError
from ..base.files import make_plain, write_json
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of
from ..base.units import unit_of
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array
from .steady_runs import SteadyRun, mean_error, steady_runs

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: part of the travel of the shorter one of two runs that both runs must cover
OVERLAP = 0.3
#: relative difference of two speeds that count as one
SAME_SPEED = 0.1


@dataclass(frozen=True, eq=False)
class LevelAtSpeed(ByValue):
    """Friction at one speed, from pairs of runs in both directions; SI, with standard errors.

    friction: half the difference of forward and backward force;  middle: half their sum
    pairs: number of pairs
    """

    speed: float
    friction: float
    friction_error: float
    middle: float
    middle_error: float
    pairs: int


@dataclass(frozen=True, eq=False)
class Line(ByValue):
    """A straight line, force = level + damping speed, with standard errors; SI.

    chi_squared: per degree of freedom; NaN without a degree of freedom
    """

    level: float
    level_error: float
    damping: float
    damping_error: float
    chi_squared: float


@dataclass(frozen=True, eq=False)
class CoulombLevel(Shown, ByValue):
    """Friction over speed, from runs at constant speed.

    runs: all runs in the recording;  speeds: friction at each speed with runs in both directions
    line: friction over speed, whose level is the Coulomb level; None without two speeds in both
        directions
    forward, backward: force over speed in one direction, whose level is that of friction and
        constant forces; None without two speeds in that direction
    """

    experiment: str
    axis: str
    runs: tuple[SteadyRun, ...]
    speeds: tuple[LevelAtSpeed, ...]
    line: Line | None
    forward: Line | None
    backward: Line | None

    def plot(self) -> Figure:
        """Plot force against velocity: every run, and the line with the level at rest."""
        return figure_of(self)

    def as_dict(self) -> dict[str, Any]:
        """Plain data, SI units; null for a number that is not finite."""
        force, speed = unit_of("force", self.axis), unit_of("velocity", self.axis)
        data = {
            "experiment": self.experiment,
            "coulomb_level": None if self.level is None else list(self.level),
            **{
                name: None if line is None else dict(vars(line))
                for name, line in self.lines.items()
            },
            "speeds": [vars(s) for s in self.speeds],
            "runs": [
                {"file": r.file, "start": r.start, "velocity": r.velocity, "duration": r.duration,
                 "force": float(np.mean(r.force)), "stderr": mean_error(r.force)}
                for r in self.runs
            ],
            "units": {"force": force, "velocity": speed},
        }  # fmt: skip
        content: dict[str, Any] = make_plain(data)
        return content

    def to_json(self, path: str | Path) -> None:
        """Write the result as JSON."""
        write_json(path, self.as_dict())

    @property
    def level(self) -> tuple[float, float] | None:
        """Coulomb level and its standard error; None with runs in one direction only.

        From the line through speeds in both directions; else the mean of the lines of each
        direction, which need no common speeds, but the same constant forces along all runs.
        """
        if self.line is not None:
            return self.line.level, self.line.level_error
        if self.forward is None or self.backward is None:
            return None
        error = float(np.hypot(self.forward.level_error, self.backward.level_error)) / 2
        return (self.forward.level + self.backward.level) / 2, error

    @property
    def lines(self) -> dict[str, Line | None]:
        """The three lines by name: "both ways", "forward", "backward"."""
        return {"both ways": self.line, "forward": self.forward, "backward": self.backward}


def coulomb_level(
    experiment: Experiment,
    *,
    body: str = "device",
    tolerance: float = 0.05,
    shortest: float = 0.3,
) -> CoulombLevel:
    """Friction over speed, and the Coulomb level, from runs at constant speed both ways.

    tolerance, shortest: of runs, see `steady_runs`
    raises ExperimentError: no run at constant speed
    """
    runs = steady_runs(experiment, body=body, tolerance=tolerance, shortest=shortest)
    if not runs:
        raise ExperimentError(
            f"{experiment.folder.name}: coulomb_level: no run of {shortest:g} s at a speed within "
            f"{100 * tolerance:g} %"
        )
    speeds = _group_by_speed(_pairs(runs))
    ways = {
        way: _line(
            np.array([abs(r.velocity) for r in runs if r.direction == way]),
            np.array([way * float(np.mean(r.force)) for r in runs if r.direction == way]),
            np.array([mean_error(r.force) for r in runs if r.direction == way]),
        )
        for way in (1, -1)
    }
    return CoulombLevel(
        experiment=experiment.title or experiment.folder.name,
        axis=experiment.axis(body),
        runs=runs,
        speeds=speeds,
        line=_line(
            np.array([s.speed for s in speeds]),
            np.array([s.friction for s in speeds]),
            np.array([s.friction_error for s in speeds]),
        ),
        forward=ways[1],
        backward=ways[-1],
    )


@dataclass(frozen=True)
class _Pair:
    """A forward and a backward run at one speed, over their common travel."""

    speed: float
    forward: float
    backward: float
    error: float


def _pairs(runs: Sequence[SteadyRun]) -> list[_Pair]:
    """Each forward run with the matching backward run nearest in time; each is used once."""
    free = [r for r in runs if r.direction < 0]
    pairs = []
    for run in (r for r in runs if r.direction > 0):
        fitting = [other for other in free if _fit(run, other)]
        if not fitting:
            continue
        other = min(fitting, key=lambda r: (r.file != run.file, abs(r.start - run.start)))
        free.remove(other)
        pairs.append(_pair(run, other))
    return pairs


def _common(one: SteadyRun, other: SteadyRun) -> tuple[float, float]:
    low = max(one.position.min(), other.position.min())
    return float(low), float(min(one.position.max(), other.position.max()))


def _fit(one: SteadyRun, other: SteadyRun) -> bool:
    low, high = _common(one, other)
    shorter = min(np.ptp(one.position), np.ptp(other.position))
    close = abs(abs(one.velocity) - abs(other.velocity)) <= SAME_SPEED * abs(one.velocity)
    return bool(close and high - low >= OVERLAP * shorter)


def _pair(forward: SteadyRun, backward: SteadyRun) -> _Pair:
    low, high = _common(forward, backward)
    parts = [r.force[(r.position >= low) & (r.position <= high)] for r in (forward, backward)]
    speed = (abs(forward.velocity) + abs(backward.velocity)) / 2
    error = float(np.sqrt(sum(mean_error(p) ** 2 for p in parts))) / 2
    return _Pair(speed, float(parts[0].mean()), float(parts[1].mean()), error)


def _group_by_speed(pairs: Sequence[_Pair]) -> tuple[LevelAtSpeed, ...]:
    """Pairs of one speed together; their scatter is used if it exceeds their errors."""
    groups: list[list[_Pair]] = []
    for pair in sorted(pairs, key=lambda p: p.speed):
        if groups and pair.speed <= (1 + SAME_SPEED) * groups[-1][0].speed:
            groups[-1].append(pair)
        else:
            groups.append([pair])
    return tuple(_level(group) for group in groups)


def _level(group: Sequence[_Pair]) -> LevelAtSpeed:
    n = len(group)
    half = np.array([(p.forward - p.backward) / 2 for p in group])
    middle = np.array([(p.forward + p.backward) / 2 for p in group])
    of_fits = float(np.sqrt(np.mean([p.error**2 for p in group]) / n))
    scatter = [float(np.std(x, ddof=1) / np.sqrt(n)) if n > 1 else 0.0 for x in (half, middle)]
    return LevelAtSpeed(
        speed=float(np.mean([p.speed for p in group])),
        friction=float(half.mean()),
        friction_error=max(of_fits, scatter[0]),
        middle=float(middle.mean()),
        middle_error=max(of_fits, scatter[1]),
        pairs=n,
    )


def _line(speed: Array, force: Array, error: Array) -> Line | None:
    """Weighted line through forces with standard errors, (n,) each; None below two speeds."""
    if len(speed) < 2 or speed.max() <= (1 + SAME_SPEED) * speed.min():
        return None
    # an error of 0 (noise-free data) must not take all the weight
    weight = 1 / np.maximum(error, max(1e-3 * float(error.max()), 1e-12))
    columns = weight[:, None] * np.column_stack([np.ones_like(speed), speed])
    covariance = np.linalg.inv(columns.T @ columns)
    level, damping = covariance @ columns.T @ (weight * force)
    left = weight * force - columns @ np.array([level, damping])
    freedom = len(speed) - 2
    chi = float(left @ left / freedom) if freedom else float("nan")
    # a line that does not fit is off by what it leaves, not by what single runs say
    wider = np.sqrt(max(chi, 1.0)) if freedom else 1.0
    errors = wider * np.sqrt(np.diag(covariance))
    return Line(float(level), float(errors[0]), float(damping), float(errors[1]), chi)
