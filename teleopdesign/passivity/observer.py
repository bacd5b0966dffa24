"""Passivity observer: the energy that has gone into a port, over a simulation or a recording.

    E[n] = E[n-1] + f[n] (x[n+1] - x[n])          force held between samples: exact
    E[n] = E[n-1] + (f[n] + f[n+1])/2 (x[n+1] - x[n])    force sampled

The force f acts ON the device along its motion x. A device that started at rest has released energy
where E < 0. Hannaford and Ryu, IEEE Trans. Robotics Autom. 18 (2002) 1, add a damper in each sample
in which E would fall below 0: `passivity_controlled`.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ExperimentError, ModelError
from ..base.files import write_netcdf
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of
from ..blocks import NINETY_FIVE
from ..measurement import Experiment, Record
from ..simulate import Simulation

if TYPE_CHECKING:
    import matplotlib.figure
    import xarray

Array = NDArray[np.float64]
#: standard error of a value that is rounded to steps, in widths of a step
_ROUNDED = 12**-0.5
#: energy below this part of all that was turned over is rounding
_ROUNDING = 1e-6
#: a motion that begins with less than this part of its largest speed begins at rest: a hundredth of
#: its largest kinetic energy. Speeds are means over a part of the time, so that single readings of
#: an encoder tell none
_AT_REST, _PART = 0.1, 1 / 200


@dataclass(frozen=True, eq=False)
class PortEnergy(Shown, ByValue):
    """Energy into a port over time.

    data: over `time` (s): `energy` (J, from the start), `stderr` (J, from the noise of the sensors,
        0 where none is stated) and `power` (W)
    """

    data: xarray.Dataset

    @property
    def lowest(self) -> float:
        """Least energy, J; below zero where the port has released more than it took in."""
        return float(self.data["energy"].min())

    @property
    def when(self) -> float:
        """Time of the least energy, s."""
        return float(self.data["time"][int(self.data["energy"].values.argmin())])

    @property
    def certain(self) -> bool:
        """Whether the least energy is below zero by more than its error.

        The error is 1.96 standard errors, or a millionth of all energy that was turned over: the
        rounding of a simulation.
        """
        k = int(self.data["energy"].values.argmin())
        error = NINETY_FIVE * float(self.data["stderr"][k])
        return self.lowest < -max(error, self._rounding())

    @property
    def moves_at_start(self) -> bool:
        """Whether the port moves at the start: then a part of the energy may have been kinetic."""
        return bool(self.data.attrs.get("moves_at_start", False))

    def _rounding(self) -> float:
        return _ROUNDING * float(np.abs(np.diff(self.data["energy"].values)).sum())

    def given_out(self) -> list[tuple[float, float, float]]:
        """Intervals of time in which the port released energy: begin (s), end (s), energy (J), > 0.

        Left out are amounts within 1.96 standard errors of the final energy, or within a millionth
        of all energy that was turned over.
        """
        t, e = self.data["time"].values, self.data["energy"].values
        change = np.diff(e)
        doubt = max(NINETY_FIVE * float(self.data["stderr"].values[-1]), self._rounding())
        edges = np.flatnonzero(np.diff(np.concatenate([[0], (change < 0).astype(int), [0]])))
        pairs = edges.reshape(-1, 2)
        return [
            (float(t[a]), float(t[b]), float(e[a] - e[b])) for a, b in pairs if e[a] - e[b] > doubt
        ]

    def plot(self) -> matplotlib.figure.Figure:
        """Figure of the energy over time with its band, and of the intervals of released energy."""
        return figure_of(self)

    def to_netcdf(self, path: str | Path) -> None:
        """Write energy, standard error and power with their units as a NetCDF file."""
        write_netcdf(path, self.data)


def observe(
    time: Array,
    position: Array,
    force: Array,
    *,
    held: bool = False,
    position_noise: float = 0.0,
    force_noise: float = 0.0,
) -> PortEnergy:
    """Energy into a port from samples of position and force.

    time: s, (n,);  position: m or rad, (n,)
    force: N or N m, (n,), ON the device along its position
    held: whether each force stays until the next sample (a command), or is a sampled signal
    position_noise, force_noise: rms error of each sample, independent, in the units of the samples
    raises ModelError: different numbers of samples, or fewer than three
    """
    import xarray

    n = len(time)
    if not (n == len(position) == len(force)) or n < 3:
        raise ModelError(
            f"observe: expected three samples or more of each, found {n}, {len(position)}, "
            f"{len(force)}"
        )
    travel = np.diff(position)
    acting = force[:-1] if held else (force[1:] + force[:-1]) / 2
    work = acting * travel
    energy = np.concatenate([[0.0], np.cumsum(work)])
    errors = _stderr(acting, travel, held, position_noise, force_noise)
    power = np.gradient(energy, time)
    coordinates = {"time": ("time", np.asarray(time), {"units": "s"})}
    k, (t, x) = max(1, int(_PART * n)), (np.asarray(time), np.asarray(position))
    speeds = np.abs((x[k:] - x[:-k]) / (t[k:] - t[:-k]))
    return PortEnergy(
        xarray.Dataset(
            {
                "energy": ("time", energy, {"units": "J", "text": "into the port"}),
                "stderr": ("time", errors, {"units": "J"}),
                "power": ("time", power, {"units": "W"}),
            },
            coordinates,
            {"moves_at_start": int(speeds[0] > _AT_REST * speeds.max())},
        )
    )


def _stderr(
    acting: Array, travel: Array, held: bool, position_noise: float, force_noise: float
) -> Array:
    """Standard error of the energy at each sample, (n,), to first order in the noise.

    The energy depends on an inner position x[k] through acting[k-1] - acting[k], on the first and
    the last position through the force there, and on a force f[k] through the travel along which
    the force acts.
    """
    steps = np.concatenate([[0.0], (acting[:-1] - acting[1:]) ** 2])
    inside = np.concatenate([[0.0], np.cumsum(steps)])
    ends = np.concatenate([[0.0], acting[0] ** 2 + acting**2])
    along = travel if held else np.concatenate([travel[:1] / 2, (travel[1:] + travel[:-1]) / 2])
    pulled = np.concatenate([[0.0], np.cumsum(along**2)])
    if not held:  # the last force so far acts along half of the travel before it
        pulled[1:] += (travel / 2) ** 2
    variance = position_noise**2 * (inside + ends) + force_noise**2 * pulled
    return np.asarray(np.sqrt(variance))


def observe_simulation(
    simulation: Simulation, *, motion: str = "L", force: str = "R_V"
) -> PortEnergy:
    """Energy into a port of a simulated diagram.

    The sum has an error from the curvature between rows, so simulate with `every_step=True`.

    motion: position of the port, m or rad;  force: ON the device along this motion, N or N m
    returns: energy over time, J; negative where the port has released more than it took in
    """
    return observe(
        simulation.data["time"].values, simulation[motion].values, simulation[force].values
    )


def observe_record(
    experiment: Experiment,
    record: Record,
    *,
    body: str = "device",
    force: str = "interaction_force",
) -> PortEnergy:
    """Energy into a body through a measured force, over one record without interruption.

    The standard errors come from the resolution and the noise of the channels in the experiment.

    body: name of the body
    force: "interaction_force", a sampled signal, or "actuator_force", held between samples
    raises ExperimentError: the record has no such force or position, or has several segments
    """
    names = f"{body}.position", f"{body}.{force}"
    for name in names:
        if name not in record.signals:
            raise ExperimentError(
                f"{record.file}: has no {name}, found {', '.join(sorted(record.signals))}"
            )
    if len(record.segments) > 1:
        raise ExperimentError(
            f"{record.file}: {len(record.segments)} segments, energy is counted over one"
        )
    errors = []
    for name in names:
        channel = experiment.channels[name]
        errors.append(float(np.hypot(_ROUNDED * (channel.resolution or 0.0), channel.noise or 0.0)))
    return observe(
        record.time,
        record.signals[names[0]],
        record.signals[names[1]],
        held=force == "actuator_force",
        position_noise=errors[0],
        force_noise=errors[1],
    )


@dataclass(frozen=True, eq=False)
class PassivityControlled(ByValue):
    """A force with the damper of the passivity controller added.

    force: N, (n,);  damping: of the added damper at each sample, N s/m, (n,)
    energy: into the port, J, (n,); below zero only where the velocity is zero, or where the damping
        is limited by `largest`
    """

    force: Array
    damping: Array
    energy: Array


def passivity_controlled(
    velocity: Array, force: Array, *, period: float, largest: float = np.inf
) -> PassivityControlled:
    """Passivity controller: adds a damper in each sample in which E would fall below 0.

    Hannaford and Ryu, IEEE Trans. Robotics Autom. 18 (2002) 1.

    velocity: travel of each sample over the period, m/s, (n,)
    force: ON the device along its motion, held over the sample, N, (n,)
    period: s;  largest: most damping that may be added, N s/m
    raises ModelError: period not > 0, or different numbers of velocities and forces
    """
    if period <= 0 or len(velocity) != len(force):
        raise ModelError(
            f"passivity_controlled: expected a period > 0 and as many forces as velocities, found "
            f"{period}, {len(force)}, {len(velocity)}"
        )
    damping, energy = np.zeros(len(force)), np.zeros(len(force))
    total = 0.0
    for n, (v, f) in enumerate(zip(velocity, force, strict=True)):
        total += period * f * v
        if total < 0 and v:
            damping[n] = min(-total / (period * v * v), largest)
            total += period * damping[n] * v * v
        energy[n] = total
    return PassivityControlled(force + damping * velocity, damping, energy)
