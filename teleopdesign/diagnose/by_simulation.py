"""Comparison by simulation: the model moves freely under the recorded forces.

The force error says what force a model leaves along the measured motion. Here the recorded command
and interaction force drive the model from a point of the measured motion for a horizon; the error
is the deviation of its position and velocity. Without a loop that holds the model, a small constant
force leads it away with t^2, and friction decides where it stops. Short horizons test the model;
the whole record tests the sum of its errors.

In the recorded closed loop a controller pulls the model back. Its force is the recorded command
plus its response to the deviation: for a spring and damper -(K + B s)(x - x_measured), whatever the
reference was.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ModelError
from ..base.files import make_plain
from ..base.frozen import ByValue
from ..base.shown import html_table
from ..base.units import unit_of
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from ..measurement.prepare import Prepared, prepare
from ..model import Model
from .cores import map_in_threads
from .error import force_error
from .record_offsets import apply_record_offsets
from .simulated_course import LedBody, course_of, led_body, with_whole_dead_times

if TYPE_CHECKING:
    from .arms.prepared import PreparedArm

#: s: times after which the simulation restarts on the measured motion; at last the whole record
HORIZONS = (0.1, 0.3, 1.0, 3.0, 10.0)
#: deflection of ideal friction before it slides, as a part of the travel: far below any error of a
#: free motion. A smaller part needs shorter steps
BRISTLE_SHARE = 2e-5


@check_types
@dataclass(frozen=True)
class RecordedLoop:
    """The controller of the device during the recording, as a spring and a damper.

    stiffness: N/m or N m/rad;  damping: N s/m or N m s/rad;  both finite and not negative
    """

    stiffness: float
    damping: float = 0.0

    def __post_init__(self) -> None:
        if not (0.0 <= self.stiffness < np.inf and 0.0 <= self.damping < np.inf):
            raise ModelError(
                "RecordedLoop: expected stiffness and damping of zero or more, found "
                f"{self.stiffness:g}, {self.damping:g}"
            )


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


@dataclass(frozen=True, eq=False)
class SimulationComparison(ByValue):
    """A model compared with an experiment by simulation, without estimation.

    fit_error, check_error: relative force errors, for comparison (NaN where there is no such
        record)
    errors: for each use and body, the shortest horizon first
    loop: controller that holds the body, or joint -> controller of that joint of an arm; None: none
    """

    model: Model
    prepared: Prepared | PreparedArm
    fit_error: float
    check_error: float
    errors: tuple[HorizonError, ...]
    loop: RecordedLoop | Mapping[str, RecordedLoop] | None = None

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

    def _rows(self) -> list[tuple[str, ...]]:
        rows: list[tuple[str, ...]] = []
        for e in self.errors:
            axis = self.model.body(e.at).axis
            horizon = "whole record" if np.isinf(e.horizon) else f"{e.horizon:g} s"
            rows.append(
                (
                    e.use,
                    e.at,
                    horizon,
                    f"{e.position:.3g} {unit_of('position', axis)}",
                    f"{100 * e.of_travel:.3g} %",
                    f"{e.velocity:.3g} {unit_of('velocity', axis)}",
                    f"{100 * e.of_speed:.3g} %",
                )
            )
        return rows

    def _repr_html_(self) -> str:
        head = ("records", "at", "horizon", "position", "of travel", "velocity", "of speed")
        return html_table(self.title, head, self._rows(), note=self._forces())

    def _forces(self) -> str:
        shown = [("fit", self.fit_error), ("check", self.check_error)]
        return "force error: " + ", ".join(f"{n} {100 * e:.2f} %" for n, e in shown if e == e)

    def __repr__(self) -> str:
        lines = [self.title, f"  {'':<22}{'horizon':>13}{'position rms':>24}{'velocity rms':>26}"]
        for use, at, horizon, position, of_travel, velocity, of_speed in self._rows():
            lines.append(
                f"  {f'{use}, {at}':<22}{horizon:>13}{f'{position} ({of_travel})':>24}"
                f"{f'{velocity} ({of_speed})':>26}"
            )
        return "\n".join([*lines, f"  {self._forces()}"])


@dataclass(frozen=True)
class _Driven:
    """A body to be driven along one stretch, and the rows first to end that count in errors."""

    led: LedBody
    motion: Motion
    first: int
    end: int

    @property
    def length(self) -> float:
        """Seconds from the first to the last row that counts."""
        return (self.end - 1 - self.first) * self.motion.sample_time


def compare_by_simulation(
    model: Model, experiment: Experiment | Prepared, *, loop: RecordedLoop | None = None
) -> SimulationComparison:
    """Drive the model by the recorded forces, over horizons from 0.1 s to the whole record.

    loop: the controller that held the device; None: nothing holds the model
    raises ExperimentError: the experiment lacks what the comparison needs
    raises ModelError: the model has an effect that has no simulated form
    """
    prepared = experiment if isinstance(experiment, Prepared) else prepare(experiment)
    errors = []
    for use in ("fit", "check"):
        for place in model.bodies:
            driven = _driven_stretches(model, prepared, use, place, loop)
            longest = max((d.length for d in driven), default=0.0)
            horizons = [h for h in HORIZONS if h < longest] + [np.inf] * bool(driven)
            errors += [_error(driven, use, place, horizon) for horizon in horizons]
    return SimulationComparison(
        model,
        prepared,
        force_error(model, prepared.of("fit")),
        force_error(model, prepared.of("check")),
        tuple(errors),
        loop,
    )


def simulation_data(comparison: SimulationComparison) -> dict[str, Any]:
    """The comparison as an answer writes it, in SI units; `null`: infinite."""
    axes = {place: body.axis for place, body in comparison.model.bodies.items()}
    loop = comparison.loop
    return {
        "loop": {j: _loop_data(one) for j, one in loop.items()}
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


def _driven_stretches(
    model: Model, prepared: Prepared, use: str, place: str, loop: RecordedLoop | None
) -> list[_Driven]:
    """The stretches of one use and body, each with the body corrected by its record's offsets."""
    stretches = prepared.of(use)
    loop = loop or RecordedLoop(0.0)
    driven = []
    for stretch, (body, motion) in zip(
        stretches, apply_record_offsets(model, stretches), strict=True
    ):
        if motion.body != place:
            continue
        led = led_body(
            with_whole_dead_times(body, motion),
            bristle=max(motion.step, BRISTLE_SHARE * float(np.ptp(motion.position))),
            stiffness=loop.stiffness,
            damping=loop.damping,
        )
        driven.append(_Driven(led, motion, int(stretch.keep[0]), int(stretch.keep[-1]) + 1))
    return driven


def _error(driven: Sequence[_Driven], use: str, place: str, horizon: float) -> HorizonError:
    """Errors over one horizon (s), of all stretches together."""
    parts = map_in_threads(lambda d: _deviations(d, horizon), driven)
    x, v = (np.concatenate([part[i] for part in parts]) for i in range(2))
    rows = [(d.motion, d.first, d.end) for d in driven]
    return horizon_error(use, place, horizon, x, v, rows)


def horizon_error(
    use: str,
    at: str,
    horizon: float,
    position: Array,
    velocity: Array,
    rows: Sequence[tuple[Motion, int, int]],
) -> HorizonError:
    """The errors of a body over one horizon, from its deviations at all rows together.

    position, velocity: simulated less measured, (rows,)
    rows: of each stretch its motion, the first row that counts and the row after the last one
    """
    measured = {
        name: np.concatenate([getattr(m, name)[first:end] for m, first, end in rows])
        for name in ("position", "velocity")
    }
    by_position, by_velocity = _rms(position), _rms(velocity)
    return HorizonError(
        use,
        at,
        horizon,
        by_position,
        by_velocity,
        by_position / max(float(np.std(measured["position"])), 1e-300),
        by_velocity / max(_rms(measured["velocity"]), 1e-300),
    )


def _rms(values: Array) -> float:
    """Root of the mean square; inf where a value is not finite."""
    return float(np.sqrt(np.mean(values**2))) if np.isfinite(values).all() else float("inf")


def _deviations(driven: _Driven, horizon: float) -> tuple[Array, Array]:
    """Simulated less measured position and velocity along one stretch, restarted each horizon."""
    motion, first, end = driven.motion, driven.first, driven.end
    rows = end - first
    each = rows if np.isinf(horizon) else max(round(horizon / motion.sample_time), 2)
    x, v = [], []
    for begin in range(first, end - 1, each):
        # one extra row, which is not counted: no command follows the last row of a course
        part = slice(begin, min(begin + each + 1, end))
        course = course_of(driven.led, motion, part)
        x.append(course.position - motion.position[part])
        v.append(course.velocity - motion.velocity[part])
    return np.concatenate(x), np.concatenate(v)
