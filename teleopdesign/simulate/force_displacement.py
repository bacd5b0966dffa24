"""Force against displacement at the user's hand, compared with the curve of the environment.

Force against velocity over whole cycles of a motion, for each case.
"""

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


@dataclass(frozen=True)
class Loop:
    """Slope (N/m) of a force over a displacement, and width of the loop between directions (N).

    N m/rad and N m on a revolute axis. The width of a loop with Coulomb friction is twice its
    level.
    """

    stiffness: float
    width: float


@dataclass(frozen=True, eq=False)
class ForceDisplacement(Shown, ByValue):
    """Force against displacement at the user's hand and at the environment.

    data: `force` and `displacement` at the hand, `environment_force` and `environment_displacement`
        at the environment, over `case` and `time`; forces are those that the user and the tip exert
    loops: case -> slope and width at the hand;  environment: case -> those of the environment
        itself
    rms: case -> rms of the user's force minus the force on the environment at the same time, N
    """

    data: xarray.Dataset
    loops: Mapping[str, Loop]
    environment: Mapping[str, Loop]
    rms: Mapping[str, float]

    def plot(self) -> matplotlib.figure.Figure:
        """Plot displacement and force over time, and force over displacement."""
        return figure_of(self)

    def to_netcdf(self, path: str | Path) -> None:
        """Write the curves with their units to a netCDF file."""
        write_netcdf(path, self.data)

    def to_json(self, path: str | Path) -> None:
        """Write the figures of each case to a JSON file (N, N/m)."""
        figures = {
            case: {
                "stiffness": loop.stiffness,
                "width": loop.width,
                "environment_stiffness": self.environment[case].stiffness,
                "environment_width": self.environment[case].width,
                "rms_difference": self.rms[case],
            }
            for case, loop in self.loops.items()
        }
        write_json(path, figures)


def force_displacement(
    simulations: Mapping[str, Simulation],
    *,
    within: tuple[float, float] | None = None,
    after: float = 0.0,
) -> ForceDisplacement:
    """The user's force over the motion of the master, and the tip's force over the slave's motion.

    simulations: case -> simulation of a teleoperator, all on one time grid
    within: displacements between which slope and width are fitted, m (default: the middle half of
        the stroke)
    after: start of the whole cycles that are used, s
    raises ModelError: the motion never passes these displacements in both directions
    """
    import xarray

    if not simulations:
        raise ModelError("force_displacement: found no simulation, expected at least one, by case")
    rows: dict[str, list[np.ndarray]] = {name: [] for name in _SIGNALS}
    loops, environment, rms = {}, {}, {}
    for case, simulation in simulations.items():
        kept = simulation.data["time"].values >= after - 1e-9
        time = simulation.data["time"][kept]
        signals = {n: sign * simulation[s].values[kept] for n, (s, sign) in _SIGNALS.items()}
        for name, values in signals.items():
            rows[name].append(values)
        loops[case] = loop_of(signals["displacement"], signals["force"], within=within)
        there = signals["environment_displacement"]
        environment[case] = loop_of(there, signals["environment_force"], within=within)
        rms[case] = float(np.sqrt(np.mean((signals["force"] - signals["environment_force"]) ** 2)))
    data = xarray.Dataset(
        {
            name: (
                ("case", "time"),
                np.array(values),
                {"units": "m" if "displacement" in name else "N", "signal": _SIGNALS[name][0]},
            )
            for name, values in rows.items()
        },
        {"case": list(simulations), "time": time},
    )
    return ForceDisplacement(data, loops, environment, rms)


#: signal of the teleoperator, and the sign that makes a push into the environment positive
_SIGNALS = {
    "displacement": ("X_m", 1),
    "force": ("F_m", 1),
    "environment_displacement": ("X_s", 1),
    "environment_force": ("F_s", -1),
}


def loop_of(
    displacement: np.ndarray,
    force: np.ndarray,
    *,
    within: tuple[float, float] | None = None,
) -> Loop:
    """Slope and width of a loop, by least squares of k x + F_0 +- width/2 (sign of the direction).

    displacement, force: (n,), m and N
    within: displacements that are used, m (default: the middle half of the stroke)
    raises ModelError: the motion never passes these displacements in both directions
    """
    low, high = float(displacement.min()), float(displacement.max())
    first, last = within or (low + (high - low) / 4, high - (high - low) / 4)
    way = np.sign(np.gradient(displacement))
    used = (displacement >= first) & (displacement <= last) & (way != 0)
    if len(np.unique(way[used])) < 2:
        raise ModelError(
            f"force over displacement: the motion, {low:.4g} to {high:.4g} m, does not pass "
            f"{first:.4g} to {last:.4g} m both ways"
        )
    design = np.column_stack([displacement[used], np.ones(used.sum()), way[used]])
    (slope, _, half), *_ = np.linalg.lstsq(design, force[used], rcond=None)
    return Loop(float(slope), 2 * float(half))
