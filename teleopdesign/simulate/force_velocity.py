"""Force against velocity over whole cycles of a motion, for each case."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..base.errors import ModelError
from ..base.files import write_json, write_netcdf
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of
from .simulation import Simulation

if TYPE_CHECKING:
    import matplotlib.figure
    import xarray


@dataclass(frozen=True, eq=False)
class ForceVelocity(Shown, ByValue):
    """Force against velocity.

    data: `force` and `velocity` over `case` and `time`
    rms: case -> rms of the force;  at_peak_speed: case -> mean absolute force at the peak speed
    """

    data: xarray.Dataset
    rms: Mapping[str, float]
    at_peak_speed: Mapping[str, float]

    def plot(self) -> matplotlib.figure.Figure:
        """Plot one panel for each case, from top to bottom."""
        return figure_of(self)

    def to_netcdf(self, path: str | Path) -> None:
        """Write the curves with their units to a netCDF file."""
        write_netcdf(path, self.data)

    def to_json(self, path: str | Path) -> None:
        """Write the figures of each case to a JSON file."""
        unit = self.data["force"].attrs["units"]
        figures = {
            case: {"rms": self.rms[case], "at_peak_speed": self.at_peak_speed[case], "unit": unit}
            for case in self.rms
        }
        write_json(path, figures)


def force_velocity(
    simulations: Mapping[str, Simulation],
    *,
    force: str = "E",
    velocity: str = "L_velocity",
    after: float = 0.0,
) -> ForceVelocity:
    """The force of each simulation against a velocity.

    simulations: case -> simulation, all on one time grid
    force, velocity: signals; by default the force error R_D - R_M and the velocity of L
    after: start of the whole cycles that are used, s
    raises ModelError: no simulation
    """
    import xarray

    if not simulations:
        raise ModelError("force_velocity: found no simulation, expected at least one, by case")
    forces, speeds = [], []
    for simulation in simulations.values():
        kept = simulation.data["time"].values >= after - 1e-9
        time = simulation.data["time"][kept]
        forces.append(simulation[force].values[kept])
        speeds.append(simulation[velocity].values[kept])
        units = simulation[force].attrs["units"], simulation[velocity].attrs["units"]
    dims = ("case", "time")
    data = xarray.Dataset(
        {
            "force": (dims, np.array(forces), {"units": units[0], "signal": force}),
            "velocity": (dims, np.array(speeds), {"units": units[1], "signal": velocity}),
        },
        {"case": list(simulations), "time": time},
    )
    rms, peak = {}, {}
    for case, f, v in zip(simulations, forces, speeds, strict=True):
        rms[case] = float(np.sqrt(np.mean(f**2)))
        # within a thousandth of the peak speed: 5 degrees of a sinusoid
        peak[case] = float(np.mean(np.abs(f[np.abs(v) > 0.999 * np.abs(v).max()])))
    return ForceVelocity(data, rms, peak)
