"""What a page shows of motion, force and frequency of a body: graphs with their units.

The residual over what carries it and force in time, before and after; simulated motion; impedance.
An axis has the unit prefix that suits its values: 0.012 m as 12 mm.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...base.errors import ModelError
from ...base.finding import Array, Graph, Series
from ...base.sentences import readable_unit
from ...blocks import free_space
from ...diagnose import Diagnosis, SimulationComparison
from ...diagnose.comparison import energetic_speed, recorded_impedance
from ...diagrams import haptic_interface
from ...frequency import FrequencyResponse, bode
from ..figures.carrier import CarryingVariable
from ..figures.graph import thin_series

#: most points of a profile in each direction, and fewest samples of a point
PROFILE, FEWEST = 24, 3
#: part of the samples outside a band on each side
TAIL = 0.1
#: length of an excerpt in periods at the bandwidth, and its longest part of a stretch
PERIODS, PART = 60.0, 0.25
#: points of each line of an excerpt
EXCERPT_POINTS = 240
#: part of the record's mean square force below which a window counts as quiet
QUIET = 0.03
#: name of the only model of a graph
YOURS = "your model"


@dataclass(frozen=True)
class BodySamples:
    """Samples of one body that count in the error, (n,) each.

    time: s, without gaps;  clock: s, of the record;  residual: one array for each rung
    """

    time: Array
    clock: Array
    stretch: NDArray[np.intp]
    position: Array
    velocity: Array
    command: Array
    direction: NDArray[np.int8]
    measured: Array
    residual: tuple[Array, ...]

    def select_rungs(self, rungs: list[int]) -> BodySamples:
        """The same samples, with the residuals of these rungs."""
        return replace(self, residual=tuple(self.residual[i] for i in rungs))


def plot_over_carrier(
    rows: BodySamples, axis: str, force: Scaled, carrier: CarryingVariable
) -> Graph:
    """Mean residual over the carrier on the first and last rung, and 80 % of the samples."""
    quantity = "force" if carrier.name == "command" else carrier.name
    places = carrier.values(vars(rows))
    scale = choose_prefix(quantity, axis, size_of(places))
    series = []
    for name, residual in _first_and_last(rows.residual):
        if profile := _profile(rows, places, residual):
            place, *force_lines = np.array(profile).T
            mean, low, high = (force.factor * line for line in force_lines)
            series.append(Series(name, scale.factor * place, mean, "model", low, high))
    label = f"residual force ({force.unit})"
    return Graph(f"{carrier.label(axis)} ({scale.unit})", label, tuple(series))


def _first_and_last(residual: tuple[Array, ...]) -> list[tuple[str, Array]]:
    if len(residual) == 1:
        return [(YOURS, residual[0])]
    return [("before", residual[0]), ("after", residual[-1])]


def _profile(
    rows: BodySamples, places: Array, residual: Array
) -> list[tuple[float, float, float, float]]:
    """Mean place, mean, low and high residual of groups of equal size in each direction."""
    groups = []
    for way in (-1, 1):
        this_way = np.flatnonzero(rows.direction == way)
        if len(this_way) < 10 * FEWEST:
            continue
        this_way = this_way[np.argsort(places[this_way], kind="stable")]
        for group in np.array_split(this_way, min(PROFILE, len(this_way) // FEWEST)):
            low, high = np.quantile(residual[group], (TAIL, 1.0 - TAIL))
            mean = float(np.mean(residual[group]))
            groups.append((float(np.mean(places[group])), mean, float(low), float(high)))
        groups.append((float("nan"),) * 4)  # the line breaks where the motion turns
    return groups


def excerpt(rows: BodySamples, axis: str, bandwidth: float) -> Graph:
    """Measured and modelled force where the residual decreased most (or is largest)."""
    window = _window(rows, bandwidth)
    kept = window[:: max(1, len(window) // EXCERPT_POINTS)]  # low-passed: neighbours are alike
    force = choose_prefix("force", axis, size_of(rows.measured[window]))
    series = [Series("measured", rows.clock[kept], force.factor * rows.measured[kept], "course")]
    for name, r in _first_and_last(rows.residual):
        model = force.factor * (rows.measured[kept] - r[kept])
        series.append(Series(name, rows.clock[kept], model, "model"))
    return Graph("time (s)", f"force ({force.unit})", tuple(series))


def _window(rows: BodySamples, bandwidth: float) -> NDArray[np.intp]:
    """Rows of a window of one stretch: that in which the residual decreased most for its force."""
    gain = rows.residual[0] ** 2
    if len(rows.residual) > 1:
        gain = gain - rows.residual[-1] ** 2
    force = rows.measured**2
    least = QUIET * float(np.mean(force))
    best, window = -np.inf, np.arange(len(rows.time))
    for number in np.unique(rows.stretch):
        here = np.flatnonzero(rows.stretch == number)
        step = float(np.median(np.diff(rows.time[here]))) if len(here) > 1 else 1.0
        length = max(2, int(min(PERIODS / bandwidth, PART * len(here) * step) / step))
        if len(here) < length:
            continue
        gained, pushed = (np.convolve(x[here], np.ones(length), "valid") for x in (gain, force))
        share = gained / (pushed + length * least)
        if share.max() > best:
            start = int(np.argmax(share))
            best, window = float(share.max()), here[start : start + length]
    return window


@dataclass(frozen=True)
class Scaled:
    """A unit for display, and the factor from SI to it."""

    unit: str
    factor: float


def choose_prefix(quantity: str, axis: str, size: float) -> Scaled:
    """The unit with the prefix in which a quantity of that size (SI) reads well."""
    factor, unit = readable_unit(quantity, axis, size)
    return Scaled(unit.replace(" ", "·"), factor)


def size_of(values: Array) -> float:
    """Size of values: the 98 % quantile of their magnitudes."""
    return float(np.quantile(np.abs(values), 0.98))


#: roles of effects between command and force, or between two sides of a body: the recorded force
#: and motion are then not those of one impedance
_BETWEEN = ("actuation", "structure")
#: frequencies of a derived response, and where they begin, as a part of the lowest recorded one
LINES, BELOW = 80, 0.5
#: most points of a line over time
POINTS = 600


@dataclass(frozen=True)
class MotionOverlay:
    """The final model driven by the recorded forces, beside the measured motion.

    use: of the records shown;  fit: 100 (1 - rms deviation / standard deviation), %, of the whole
        record in one simulation
    """

    body: str
    use: str
    fit: float
    graph: Graph


@dataclass(frozen=True)
class ImpedanceView:
    """Force over motion of a body: recorded with coherence, and of the final model.

    derived: with friction as a damper at a speed (SI), and the band of the estimates
    along: of the model's force along the recorded motion, computed as the recorded one
    """

    body: str
    speed: float
    recorded: FrequencyResponse
    along: FrequencyResponse
    derived: FrequencyResponse

    @property
    def left_out(self) -> tuple[str, ...]:
        """Effects without a linear form."""
        return tuple(name.partition(".")[2] for name in self.derived.left_out["derived"])


def simulated_motions(
    comparison: SimulationComparison | None, places: Collection[str]
) -> tuple[MotionOverlay, ...]:
    """Of each body among places, on the check records, or the fit records if there are none."""
    if comparison is None:
        return ()
    use = "check" if any(e.use == "check" for e in comparison.errors) else "fit"
    made = []
    for at in dict.fromkeys(e.at for e in comparison.errors if e.use == use and e.at in places):
        fit = comparison.error(np.inf, use=use, at=at).fit
        made.append(MotionOverlay(at, use, fit, _overlay(comparison, use, at)))
    return tuple(made)


def _overlay(comparison: SimulationComparison, use: str, at: str) -> Graph:
    """Measured and simulated position over time; a model that drifts away leaves the picture."""
    courses = {h: c for (u, a, h), c in comparison.courses.items() if (u, a) == (use, at)}
    axis = comparison.model.body(at).axis
    series: list[Series] = []
    scale, low, high = None, 0.0, 0.0
    for horizon, stretches in sorted(courses.items(), reverse=True):
        gap = np.full((3, 1), np.nan)
        time, measured, simulated = np.hstack([p for one in stretches for p in (one, gap)])
        if scale is None:
            scale = choose_prefix("position", axis, size_of(measured[np.isfinite(measured)]))
            low, high = float(np.nanmin(measured)), float(np.nanmax(measured))
            series.append(Series("measured", time, scale.factor * measured, "course"))
        room = 0.5 * (high - low)
        inside = (simulated > low - room) & (simulated < high + room)
        name = "simulated" if np.isinf(horizon) else f"restarted each {horizon:g} s"
        name += f": fit {comparison.error(horizon, use=use, at=at).fit:.1f} %"
        y = np.where(inside, scale.factor * simulated, np.nan)
        series.append(Series(name, time, y, "model"))
    unit = "" if scale is None else f" ({scale.unit})"
    return Graph("time (s)", f"position{unit}", tuple(thin_series(s, POINTS) for s in series))


def impedance_views(diagnosis: Diagnosis) -> tuple[ImpedanceView, ...]:
    """Of each body whose recorded force and motion are those of one impedance."""
    views = []
    for place, body in diagnosis.model.bodies.items():
        if any(e.role in _BETWEEN for e in body.effects):
            continue
        known = (diagnosis.model, diagnosis.prepared, place)
        try:
            recorded, speed = recorded_impedance(*known), energetic_speed(*known)
            along = recorded_impedance(*known, modelled=True)
            derived = bode(
                {"derived": haptic_interface(free_space(body))},
                output="E",
                input="L",
                given="L",
                speed=speed,
                frequency=np.geomspace(
                    BELOW * recorded.frequency[0], recorded.frequency[-1], LINES
                ),
                covariance=diagnosis.covariance({"Z_M": place}),
            )
        except ModelError:
            continue  # too short a record, or no linear form
        if np.isfinite(recorded.magnitude).any():
            views.append(ImpedanceView(place, speed, recorded, along, derived))
    return tuple(views)
