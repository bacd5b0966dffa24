"""Force against displacement at the user's hand, compared with the curve of the environment.

Force against velocity over whole cycles of a motion, for each case.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

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
class AbstractCurves(Shown, ByValue):
    """Signals of several simulations;  data: over `case` and `time`."""

    data: xarray.Dataset

    def plot(self) -> matplotlib.figure.Figure:
        """Plot the curves of every case."""
        return figure_of(self)

    def to_netcdf(self, path: str | Path) -> None:
        """Write the curves with their units to a netCDF file."""
        write_netcdf(path, self.data)


def _curves(
    simulations: Mapping[str, Simulation], signals: Mapping[str, tuple[str, int]], after: float
) -> xarray.Dataset:
    """Signals of each simulation from the time `after` (s) on, over `case` and `time`.

    signals: name -> signal and the sign with which it counts
    raises ModelError: no simulation
    """
    import xarray

    if not simulations:
        raise ModelError("simulations: found none, expected at least one, by case")
    kept = [s.data["time"].values >= after - 1e-9 for s in simulations.values()]
    data: dict[str, Any] = {}
    for name, (signal, sign) in signals.items():
        runs = [s[signal] for s in simulations.values()]
        rows = [sign * run.values[k] for run, k in zip(runs, kept, strict=True)]
        attributes = {"units": runs[-1].attrs["units"], "signal": signal}
        data[name] = (("case", "time"), np.array(rows), attributes)
    time = next(iter(simulations.values())).data["time"][kept[0]]
    return xarray.Dataset(data, {"case": list(simulations), "time": time})


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


@dataclass(frozen=True, eq=False)
class ForceVelocity(AbstractCurves):
    """Force against velocity, a panel for each case from top to bottom.

    data: `force` and `velocity` over `case` and `time`
    rms: case -> rms of the force;  at_peak_speed: case -> mean absolute force at the peak speed
    """

    rms: Mapping[str, float]
    at_peak_speed: Mapping[str, float]

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
    data = _curves(simulations, {"force": (force, 1), "velocity": (velocity, 1)}, after)
    rms, peak = {}, {}
    curves = zip(simulations, data["force"].values, data["velocity"].values, strict=True)
    for case, f, v in curves:
        rms[case] = _rms(f)
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
class ForceDisplacement(AbstractCurves):
    """Force against displacement at the user's hand and at the environment.

    data: `force` and `displacement` at the hand, `environment_force` and `environment_displacement`
        at the environment, over `case` and `time`; forces are those that the user and the tip exert
    loops: case -> slope and width at the hand;  environment: case -> those of the environment
        itself
    rms: case -> rms of the user's force minus the force on the environment at the same time, N
    """

    loops: Mapping[str, Loop]
    environment: Mapping[str, Loop]
    rms: Mapping[str, float]

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
    data = _curves(simulations, _SIGNALS, after)
    loops, environment, rms = {}, {}, {}
    for case in simulations:
        x, force, tip, resisting = (data[n].sel(case=case).values for n in _SIGNALS)
        loops[case] = loop_of(x, force, within=within)
        environment[case] = loop_of(tip, resisting, within=within)
        rms[case] = _rms(force - resisting)
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
