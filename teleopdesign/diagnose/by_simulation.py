"""Comparison by simulation: the model moves freely under the recorded forces.

The force error says what force a model leaves along the measured motion. Here the recorded command
and interaction force drive the model from a point of the measured motion for a horizon; the error
is the deviation of its position and velocity. Without a loop that holds the model, a small constant
force leads it away with t^2, and friction decides where it stops. Short horizons test the model;
the whole record tests the sum of its errors.

The joints of an arm move together, so a joint that deviates pulls the others along.

In the recorded closed loop a controller pulls the model back. Its force is the recorded command
plus its response to the deviation: for a spring and damper -(K + B s)(x - x_measured), whatever the
reference was.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.errors import ModelError, did_you_mean, quote
from ..base.files import make_plain
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of
from ..base.units import unit_of
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array
from ..model import Model
from .cores import map_in_threads
from .driven import Driven, RecordedLoop, driven_stretches
from .error import force_error
from .model_data import model_of_body
from .parts import PreparedParts, prepare_parts, remove_links, with_bodies_of
from .parts_fit import error_over_joints

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .diagnosis import Diagnosis

#: s: times until the simulation restarts on the measured motion; at last the whole record
HORIZONS = (0.1, 0.3, 1.0, 3.0, 10.0)
#: horizons whose courses are kept, to be drawn
DRAWN = (1.0, float("inf"))


@dataclass(frozen=True)
class HorizonError:
    """Errors of one body that restarts on the measured motion after each horizon.

    horizon: s; inf: each whole stretch of a record
    position, velocity: rms difference from the measured motion (SI); inf: the motion is not finite
    of_travel, of_speed: the same over the standard deviation of the position, the rms velocity
    """

    use: str
    at: str
    horizon: float
    position: float
    velocity: float
    of_travel: float
    of_speed: float

    @property
    def fit(self) -> float:
        """Fit of the position in %: 100 for the measured motion, 0 for its mean (NRMSE)."""
        return 100.0 * (1.0 - self.of_travel)


@dataclass(frozen=True, eq=False)
class SimulationComparison(Shown, ByValue):
    """A model compared with an experiment by simulation, without estimation.

    fit_error, check_error: relative force errors, for comparison (NaN where there is no such
        record)
    errors: for each use and body, the shortest horizon first
    loop: controller that holds the body, or joint -> controller of that joint of an arm; None: none
    courses: (use, body, horizon) -> (stretches) of time, measured and simulated position, (3, n)
    """

    model: Model
    prepared: PreparedParts
    fit_error: float
    check_error: float
    errors: tuple[HorizonError, ...]
    loop: RecordedLoop | Mapping[str, RecordedLoop] | None = None
    courses: Mapping[tuple[str, str, float], tuple[Array, ...]] = field(default_factory=dict)

    def plot(self) -> Figure:
        """Measured and simulated position with the fit in %, and correlations of the residual."""
        return figure_of(self)

    def error(self, horizon: float, *, use: str = "check", at: str | None = None) -> HorizonError:
        """The errors of one horizon (s; inf: the whole record).

        at: name of the body; None: the first body with such an error
        raises ModelError: there is no error of that horizon, use and body
        """
        for one in self.errors:
            if (one.horizon, one.use) == (horizon, use) and at in (None, one.at):
                return one
        there = ", ".join(f"{e.horizon:g} s ({e.use}, {e.at})" for e in self.errors)
        raise ModelError(f"no error for a horizon of {horizon:g} s ({use}), has {there}")

    @property
    def title(self) -> str:
        """A title in words: whether a loop held the model."""
        how = "freely" if self.loop is None else "in its loop"
        return f"Simulation, driven {how} by the recorded command"


def compare_by_simulation(
    model: Model,
    experiment: Experiment | PreparedParts,
    *,
    loop: RecordedLoop | Mapping[str, RecordedLoop] | None = None,
) -> SimulationComparison:
    """Drive the model by the recorded forces, over horizons from 0.1 s to the whole record.

    model: of an arm with base parameters where they are estimated
    loop: the controller that held the device or each joint of an arm, or a mapping joint ->
        controller; None: nothing holds the model
    raises ExperimentError: the experiment lacks what the comparison needs
    raises ModelError: an effect has no simulated form, or a loop names no joint
    """
    prepared = experiment if isinstance(experiment, PreparedParts) else prepare_parts(experiment)
    model = model if model.links else model.with_links(prepared.initial)
    prepared = with_bodies_of(model, prepared)
    models = {j: model_of_body(model, j) if j else model for j in prepared.parts}
    errors: list[HorizonError] = []
    by_force, courses = {}, dict[tuple[str, str, float], tuple[Array, ...]]()
    for use in ("fit", "check"):
        for driven in driven_stretches(models, prepared, use, _gains(loop, tuple(model.bodies))):
            longest = max((one.length for one in driven), default=0.0)
            horizons = [h for h in HORIZONS if h < longest] + [np.inf] * bool(driven)
            parts = map_in_threads(lambda one, h=horizons: _deviations(one, h), driven)
            for body, at in enumerate(driven[0].places if driven else ()):
                for h, horizon in enumerate(horizons):
                    off = [part[h][:, body] for part in parts]
                    errors.append(_horizon_error(driven, off, use, body, horizon))
                    if horizon in DRAWN:
                        courses[use, at, horizon] = _courses(driven, off, body, horizon)
        by_force[use] = error_over_joints(
            {j: force_error(models[j], remove_links(p.of(use))) for j, p in prepared.parts.items()}
        )
    return SimulationComparison(
        model, prepared, by_force["fit"], by_force["check"], tuple(errors), loop, courses
    )


def simulated_if_possible(diagnosis: Diagnosis) -> SimulationComparison | None:
    """The final model driven freely; None: an effect has no simulated form, or there is no time."""
    try:
        parts = diagnosis.recording.parts
        return None if diagnosis.kind else compare_by_simulation(diagnosis.model, parts)
    except ModelError:
        return None


def _gains(
    loop: RecordedLoop | Mapping[str, RecordedLoop] | None, places: Sequence[str]
) -> dict[str, tuple[float, float]]:
    """Place -> stiffness and damping of its controller.

    raises ModelError: the loop names no joint
    """
    if not isinstance(loop, Mapping):
        loop = dict.fromkeys(places, loop or RecordedLoop(0.0))
    for name in loop:
        if name not in places:
            raise ModelError(
                f"loop: no joint {quote(name)}, has {', '.join(places)}{did_you_mean(name, places)}"
            )
    each = {place: loop.get(place, RecordedLoop(0.0)) for place in places}
    return {place: (one.stiffness, one.damping) for place, one in each.items()}


def simulation_data(comparison: SimulationComparison) -> dict[str, Any]:
    """The comparison as an answer writes it, in SI units; `null`: infinite."""
    axes = {place: body.axis for place, body in comparison.model.bodies.items()}
    loop = comparison.loop
    return {
        "loop": {j: _loop_data(c) for j, c in loop.items()}
        if isinstance(loop, Mapping)
        else _loop_data(loop),
        "horizons": [
            {
                "use": e.use,
                "at": e.at,
                "horizon": {"value": make_plain(e.horizon), "unit": "s"},
                "position": {
                    "value": make_plain(e.position),
                    "unit": unit_of("position", axes[e.at]),
                },
                "velocity": {
                    "value": make_plain(e.velocity),
                    "unit": unit_of("velocity", axes[e.at]),
                },
                "of_travel": make_plain(e.of_travel),
                "of_speed": make_plain(e.of_speed),
            }
            for e in comparison.errors
        ],
    }


def _loop_data(loop: RecordedLoop | None) -> dict[str, float] | None:
    return None if loop is None else {"stiffness": loop.stiffness, "damping": loop.damping}


def _courses(
    driven: Sequence[Driven], deviations: Sequence[Array], body: int, horizon: float
) -> tuple[Array, ...]:
    """Of each stretch: time, measured and simulated position of a body, (3, n)."""
    rows = []
    for one, off in zip(driven, deviations, strict=True):
        motion = one.motions[body]
        at_rows = np.concatenate([np.r_[span] for span in _spans(one, horizon)])
        measured = motion.position[at_rows]
        rows.append(np.array([motion.time[at_rows], measured, measured + off[0]]))
    return tuple(rows)


def _deviations(driven: Driven, horizons: Sequence[float]) -> list[Array]:
    """Simulated less measured position and velocity (2, k, rows) along one stretch, per horizon."""
    spans = [_spans(driven, horizon) for horizon in horizons]
    measured = np.array([[getattr(m, q) for m in driven.motions] for q in ("position", "velocity")])
    courses = iter(driven.courses([span for part in spans for span in part]))
    return [
        np.concatenate([next(courses) - measured[:, :, span] for span in part], axis=2)
        for part in spans
    ]


def _spans(driven: Driven, horizon: float) -> list[slice]:
    """Rows of each restart; one extra row, after which no command follows, is shared by two."""
    rows, step = driven.end - driven.first, driven.motions[0].sample_time
    each = rows if np.isinf(horizon) else max(round(horizon / step), 2)
    starts = range(driven.first, driven.end - 1, each)
    return [slice(begin, min(begin + each + 1, driven.end)) for begin in starts]


def _horizon_error(
    driven: Sequence[Driven], deviations: Sequence[Array], use: str, body: int, horizon: float
) -> HorizonError:
    """The errors of one body over one horizon (s), of all stretches together.

    deviations: of position and velocity (2, rows) on each stretch
    """
    position, velocity = np.concatenate(deviations, axis=1)
    measured = {
        name: np.concatenate([getattr(d.motions[body], name)[d.first : d.end] for d in driven])
        for name in ("position", "velocity")
    }
    by_position, by_velocity = _rms(position), _rms(velocity)
    return HorizonError(
        use,
        driven[0].places[body],
        horizon,
        by_position,
        by_velocity,
        by_position / max(float(np.std(measured["position"])), 1e-300),
        by_velocity / max(_rms(measured["velocity"]), 1e-300),
    )


def _rms(values: Array) -> float:
    """Root of the mean square; inf where a value is not finite."""
    return float(np.sqrt(np.mean(values**2))) if np.isfinite(values).all() else float("inf")
