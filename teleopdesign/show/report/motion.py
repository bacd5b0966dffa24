"""What a page shows of motion and frequency: simulated motion, and the impedance of each body."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from ...base.errors import ModelError
from ...base.finding import Array, Graph, Series
from ...base.units import unit_of
from ...blocks import free_space
from ...diagnose import Diagnosis, SimulationComparison
from ...diagnose.comparison import energetic_speed, recorded_impedance
from ...diagrams import haptic_interface
from ...frequency import FrequencyResponse, bode
from ..figures.graph import thin_series
from .before_and_after import choose_prefix, size_of

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
        courses = {h: c for (u, a, h), c in comparison.courses.items() if (u, a) == (use, at)}
        axis = comparison.model.body(at).axis
        fit = comparison.error(np.inf, use=use, at=at).fit
        made.append(MotionOverlay(at, use, fit, _overlay(courses, axis)))
    return tuple(made)


def _overlay(courses: dict[float, tuple[Array, ...]], axis: str) -> Graph:
    """Measured and simulated position over time; a model that drifts away leaves the picture."""
    series: list[Series] = []
    scale, low, high = None, 0.0, 0.0
    for horizon, stretches in sorted(courses.items(), reverse=True):
        gap = np.full((3, 1), np.nan)
        time, measured, simulated = np.hstack([p for one in stretches for p in (one, gap)])
        if scale is None:
            scale = choose_prefix(
                unit_of("position", axis), size_of(measured[np.isfinite(measured)])
            )
            low, high = float(np.nanmin(measured)), float(np.nanmax(measured))
            series.append(Series("measured", time, scale.factor * measured, "course"))
        room = 0.5 * (high - low)
        inside = (simulated > low - room) & (simulated < high + room)
        name = "simulated" if np.isinf(horizon) else f"restarted each {horizon:g} s"
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
