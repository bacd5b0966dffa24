"""Where a model fails: measured and modelled forces together, as labelled data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np

from ..base.errors import ExperimentError, ModelError
from ..base.files import write_netcdf
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of
from ..base.units import unit_of
from ..frequency import FrequencyResponse, recorded_response
from ..measurement.experiment import Experiment
from ..measurement.prepare import Prepared, prepare
from ..model import Model
from ..realise.along_motion import residual_along
from .by_simulation import SimulationComparison, compare_by_simulation
from .candidates import restrict_to_curve
from .covariance import covariance_in_blocks
from .driven import RecordedLoop
from .error import force_error
from .noise_floor import NoiseFloor, noise_floor
from .record_offsets import as_logged

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

    from ..frequency import FrequencyResponse, ParameterCovariance


@dataclass(frozen=True, eq=False)
class Comparison(Shown, ByValue):
    """A model compared with an experiment, without estimation.

    fit_error, check_error: relative force errors (NaN where there is no such record)
    data: per sample of every record and body (dimension "sample"): record, use, body, segment,
        time, position, velocity, direction, the low-passed command, measured, model and residual
        force, and whether the sample counts in the error (samples at the ends do not)
    """

    model: Model
    prepared: Prepared
    fit_error: float
    check_error: float
    floor: NoiseFloor
    data: Dataset

    def covariance(self, blocks: Mapping[str, str] | None = None) -> ParameterCovariance:
        """Covariance of the fitted parameters, for the bands of responses: `bode(covariance=...)`.

        blocks: block of a diagram -> body of the model; None: "Z_M" is the only body
        """
        return covariance_in_blocks(self.model, self.prepared, blocks)

    def impedance(self, at: str | None = None, *, modelled: bool = False) -> FrequencyResponse:
        """Measured force over motion, E/L, with coherence: points for `response.plot(measured=)`.

        at: body; None: the first
        modelled: of the force that the model needs along the same motion: a line
        """
        place = at or next(iter(self.model.bodies))
        return recorded_impedance(self.model, self.prepared, place, modelled=modelled)

    def plot(self, *, before: Comparison | None = None) -> Figure:
        """Residual over time, velocity and position.

        before: of another model of the same records: both residuals on one scale, over the variable
            that carries the effect by which the models differ
        """
        return figure_of(self, before=before)

    def to_netcdf(self, path: str | Path) -> None:
        """Write the data with units to a NetCDF file."""
        write_netcdf(path, self.data)


@overload
def compare(
    model: Model, experiment: Experiment, *, by: Literal["force"] = "force", seed: int = 0
) -> Comparison: ...


@overload
def compare(
    model: Model,
    experiment: Experiment,
    *,
    by: Literal["simulation"],
    loop: RecordedLoop | Mapping[str, RecordedLoop] | None = None,
) -> SimulationComparison: ...


def compare(
    model: Model,
    experiment: Experiment,
    *,
    by: Literal["force", "simulation"] = "force",
    loop: RecordedLoop | Mapping[str, RecordedLoop] | None = None,
    seed: int = 0,
) -> Comparison | SimulationComparison:
    """Compare the model with every record of the experiment, without estimation.

    by: "force": the force that the model leaves along the measured motion; "simulation": how far
        the model deviates when the recorded forces drive it
    loop: for a simulation, the controller that held the device or each joint of an arm, or a
        mapping joint -> controller; None: nothing holds the model
    seed: of the random numbers for the noise floor
    raises ExperimentError: the experiment lacks what the comparison needs
    raises ModelError: a loop is given without a simulation, or the model cannot be simulated
    """
    if by == "simulation":
        if experiment.is_curve:
            raise ExperimentError("compare: a friction curve has no time, so nothing is simulated")
        return compare_by_simulation(model, experiment, loop=loop)
    if loop is not None:
        raise ModelError('compare: a loop is simulated: found by="force", expected "simulation"')
    prepared = prepare(experiment)
    if prepared.is_curve:
        model = restrict_to_curve(model)
    fit_error, check_error = (force_error(model, prepared.of(use)) for use in ("fit", "check"))
    drawn = noise_floor(model, prepared, np.random.default_rng(seed))
    # the noise is no more than what the records themselves leave
    left = check_error if prepared.of("check") else fit_error
    return Comparison(
        model=model,
        prepared=prepared,
        fit_error=fit_error,
        check_error=check_error,
        floor=replace(drawn, value=min(drawn.value, left)),
        data=residual_data(model, prepared),
    )


def residual_data(model: Model, prepared: Prepared) -> Dataset:
    """Forces of the model along every measured motion, as in `Comparison.data`."""
    import xarray as xr

    columns: dict[str, list[Any]] = {}
    for number, stretch in enumerate(prepared.stretches):
        motion = stretch.motion
        along = residual_along(model.body(motion.body), as_logged(model, motion))
        measured = motion.lowpassed(motion.at_rows(motion.command) + motion.interaction)
        residual = motion.lowpassed(along.residual.value)
        n = len(motion.time)
        counts = np.zeros(n, dtype=bool)
        counts[stretch.keep[0] : stretch.keep[-1] + 1] = True
        for name, values in {
            "record": np.full(n, motion.file),
            "use": np.full(n, stretch.use),
            "body": np.full(n, motion.body),
            "segment": np.full(n, number),
            "time": motion.time,
            "position": motion.position,
            "velocity": motion.velocity,
            "direction": motion.direction,
            "command": motion.lowpassed(motion.at_rows(motion.command)),
            "measured": measured,
            "model": measured - residual,
            "residual": residual,
            "counts": counts,
        }.items():
            columns.setdefault(name, []).append(values)
    axis = next(iter(model.bodies.values())).axis
    quantity = dict.fromkeys(("command", "measured", "model", "residual"), "force")
    data = xr.Dataset({k: ("sample", np.concatenate(v)) for k, v in columns.items()})
    for name in ("time", "position", "velocity", *quantity):
        data[name].attrs["units"] = unit_of(quantity.get(name, name), axis)
    return data.set_coords(["record", "use", "body", "segment", "time"])


def recorded_impedance(
    model: Model, prepared: Prepared, place: str, *, modelled: bool = False
) -> FrequencyResponse:
    """Force from command and hand over the motion of a body: E/L of the device alone.

    Forces that nobody recorded and noise of the readings both widen the interval of its magnitude.
    Of all records, up to the bandwidth of the comparison; model: by how much the logs are late
    modelled: of the force that the model needs along the same motion, its nonlinear laws included
    raises ModelError: the records are too short for it
    """
    of_body = [s for s in prepared.stretches if s.motion.body == place]
    positions, forces = [], []
    for stretch in of_body:
        motion = as_logged(model, stretch.motion)
        rows = slice(stretch.keep[0], stretch.keep[-1] + 1)
        force = motion.at_rows(motion.command) + motion.interaction
        if modelled:
            force = force - residual_along(model.body(place), motion).residual.value
        positions.append(motion.position[rows])
        forces.append(force[rows])
    made = recorded_response(
        positions,
        forces,
        sample_time=of_body[0].motion.sample_time,
        up_to=of_body[0].motion.bandwidth,
        unit=unit_of("stiffness", model.body(place).axis),
    )
    if not modelled:
        return made
    return replace(made, cases=("model",), measured=False, band=None, coherence=None)


def energetic_speed(model: Model, prepared: Prepared, place: str) -> float:
    """Speed (m/s or rad/s) at which friction of a constant level is the damper of equal energy.

    Along all records: the mean square velocity over the mean speed
    """
    velocity = np.concatenate(
        [s.motion.velocity[s.keep] for s in prepared.stretches if s.motion.body == place]
    )
    return float(np.mean(velocity**2) / np.mean(np.abs(velocity)))
