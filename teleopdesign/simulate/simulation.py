"""Simulate a diagram with the compiled kernel."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..base.errors import ModelError, unknown
from ..base.files import write_beside, write_netcdf
from ..base.frozen import ByName, ByValue
from ..base.shown import Shown, figure_of
from ..blocks import Body
from ..diagrams import Diagram
from .on_grid import Input, describe_rounding
from .sampling import SAMPLED, Sampling
from .setup import Setup, prepare
from .trajectory import Trajectory
from .units import signal_units

if TYPE_CHECKING:
    import matplotlib.figure
    import xarray

    from ..realise.kernel import Timing


#: give over the travel of a motion, from which the scheme says so: on driven masses a thousandth
#: moves the position by some per cent of the travel. Lower: said where it matters to few
SOFT = 1e-3


@dataclass(frozen=True, eq=False)
class Simulation(Shown, ByName, ByValue):
    """Signals over time.

    data: one variable for each signal and hidden state over `time` (s), with units in the
        attributes; at a sample, the measured signals are those just before the command changes
    """

    diagram: Diagram
    data: xarray.Dataset

    def __getattr__(self, name: str) -> Any:
        # the Dataset is made when it is first asked for: that takes longer than a short simulation
        make = self.__dict__.get("_make")
        if name != "data" or make is None:
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        data = make()
        self.__dict__["data"] = data
        self.__dict__.pop("_make", None)
        return data

    def __getstate__(self) -> dict[str, Any]:
        return {"diagram": self.diagram, "data": self.data}

    def _names(self) -> list[str]:
        return list(map(str, self.data))

    def __getitem__(self, name: str) -> xarray.DataArray:
        if name not in self.data and name in self.diagram.outside:
            raise ModelError(
                f'simulation: "{name}" comes from outside, as it was given in `inputs`: it is no '
                "result, unless it is the force that a prescribed motion needs"
            )
        if name not in self.data:
            raise ModelError(f"simulation: {unknown('signal', name, self.data)}")
        return self.data[name]

    def plot(self, *names: str) -> matplotlib.figure.Figure:
        """Plot signals over time, one panel each; default: motion, commanded force, interaction."""
        return figure_of(self, *names)

    def to_netcdf(self, path: str | Path) -> None:
        """Write the signals with their units to a netCDF file."""
        write_netcdf(path, self.data)

    def to_csv(self, path: str | Path) -> None:
        """Write time and signals as columns, such as "X [m]", that `teleopdesign new` reads."""
        columns = {"time": self.data["time"], **{str(n): x for n, x in self.data.items()}}
        units = (x.attrs["units"] for x in columns.values())
        names = [n if u == "1" else f"{n} [{u}]" for n, u in zip(columns, units, strict=True)]
        with write_beside(path) as part:
            table = np.column_stack([x.values for x in columns.values()])
            np.savetxt(part, table, "%.9g", ",", header=",".join(names), comments="")


def simulate(
    diagram: Diagram,
    *,
    duration: float,
    inputs: Mapping[str, Input] | None = None,
    motion: Mapping[str, Trajectory] | None = None,
    initial: Mapping[str, float] | None = None,
    computer: Sampling | Literal["continuous"] = SAMPLED,
    step: float = 1e-4,
    give: float = 1e-5,
    long_step: Literal["refine", "refuse"] = "refine",
    every_step: bool = False,
    estimate_error: bool = False,
    jit: bool = True,
) -> Simulation:
    """Simulate a diagram from t = 0: all its signals over time.

    inputs: signals from outside (SI): a number, a function of time, a `sine`, a pair (times,
        samples) as it was recorded, linear in between, or samples on the grid of the run (those
        that the computer reads: one a sample; others: one each half `step`, linear in between where
        a run needs a shorter step); 0 by default
    motion: motions that are prescribed; the force that this takes becomes a result (R_V)
    initial: state -> start, such as "L", "L_velocity" or "Z_M_presliding_bristle"; else 0
    computer: how controllers are sampled; "continuous": they are not, as in `to_iosystem`
    step: inner step, s, rounded down to divide the sample period
    give: m or rad; ideal Coulomb friction is a spring that deflects by this before it slides, with
        its damper. `scheme` of the data names each motion whose travel is not far longer
    long_step: a step too long for bristle or oscillations is made shorter, or refused
    every_step: rows at every inner step instead of every sample (continuous: of 1 ms)
    estimate_error: run again with half and a quarter of the step (7 times the work) and return for
        each signal an attribute `step_error`, the largest difference between the three over its
        largest size; large where stick and slip make motion chaotic. Where friction is ideal,
        `give_error` is in the same way the difference to a run with a tenth of the give
    jit: False runs the generated code in plain Python, as a nonlinear python-control system among
        the controllers does in any case: some hundred times slower
    raises ModelError: block without laws, unknown signal, step refused or force not finite

        >>> device = td.hand(mass=0.2, damping=2.0, stiffness=0.0)
        >>> diagram = td.haptic_interface(device)
        >>> run = td.simulate_diagram(diagram, duration=0.1, inputs={"R_D": 1.0})
        >>> round(float(run["L"][-1]), 4)
        0.0184
    """
    arguments: dict[str, Any] = {"duration": duration, "inputs": inputs, "motion": motion}
    arguments |= {"initial": initial, "computer": computer, "step": step, "jit": jit}
    setup = prepare(diagram, give=give, **arguments)
    rows, timing = setup.run_resolved(long_step=long_step, every_step=every_step)
    result = _label_rows(diagram, setup, rows, timing, every_step)
    if estimate_error:
        columns = setup.program.layout.columns
        errors = {"step_error": _step_errors(setup, rows, timing, every_step)}
        if has_ideal_friction(diagram):
            stiffer = prepare(diagram, give=give / 10, **arguments)
            errors["give_error"] = _give_errors(stiffer, rows)
        for kind, sizes in errors.items():
            for name, error in zip(columns, sizes, strict=True):
                result.data[name].attrs[kind] = float(error)
    return result


def _give_errors(stiffer: Setup, rows: np.ndarray) -> np.ndarray:
    """Largest relative difference of each column to a run whose friction gives less."""
    again, _ = stiffer.run_resolved(long_step="refine", every_step=False)
    stride = max(round((len(rows) - 1) / max(len(again) - 1, 1)), 1)
    return _differences([rows[::stride][: len(again)], again])


def has_ideal_friction(diagram: Diagram) -> bool:
    """Whether a body has friction without a shape, which gives by a little in a simulation."""
    return any(True for _ in _ideal_motions(diagram))


def _ideal_motions(diagram: Diagram) -> Iterator[str]:
    """Motions of the bodies with friction without a shape."""
    for part in diagram.bodies:
        roles = {e.role for e in part.body.effects} if isinstance(part.body, Body) else set()
        if "friction_level" in roles and "friction_shape" not in roles:
            yield part.motion


def _step_errors(setup: Setup, rows: np.ndarray, timing: Timing, every_step: bool) -> np.ndarray:
    """Largest relative difference of each column between the step, its half and its quarter.

    Three runs, not two: where laws have kinks the error depends on where in a step they fall, and
    may be as large with half the step. Of 1684 signals of 1000 drawn machines two runs fell below
    half the true error in 19, three in none (`tests/exact/test_step_error.py`).
    """
    runs = [rows]
    for finer in (2, 4):
        again, _ = setup.run(setup.timing(finer * timing.inner), every_step=every_step)
        runs.append(again[:: finer if every_step else 1])
    return _differences(runs)


def _differences(runs: list[np.ndarray]) -> np.ndarray:
    """Largest difference of each column between runs (rows, columns), over its largest size."""
    spread = np.max(runs, axis=0) - np.min(runs, axis=0)
    size = np.maximum(np.abs(runs[-1]).max(axis=0), np.finfo(float).tiny)
    return np.asarray(spread.max(axis=0) / size)


def _label_rows(
    diagram: Diagram, setup: Setup, rows: np.ndarray, timing: Timing, every_step: bool
) -> Simulation:
    """A simulation whose data set is made from the rows when it is first used."""
    result = object.__new__(Simulation)
    make = partial(_dataset, diagram, setup, rows, timing, every_step)
    result.__dict__.update(diagram=setup.diagram, _make=make)
    return result


def describe_give(diagram: Diagram, give: float, signals: Mapping[str, np.ndarray]) -> str:
    """Motions that are hardly longer than what ideal friction gives, as an end of the scheme; "".

    give: m or rad;  signals: by name, (n,)
    """
    shares = {
        m: give / travel
        for m in _ideal_motions(diagram)
        if m in signals and (travel := float(np.ptp(signals[m]))) > 0.0
    }
    soft = [f"{share:.2g} of the travel of {m}" for m, share in shares.items() if share > SOFT]
    return f", friction gives by {give:g}: {', '.join(soft)}, so state less `give`" if soft else ""


def _dataset(
    diagram: Diagram, setup: Setup, rows: np.ndarray, timing: Timing, every_step: bool
) -> xarray.Dataset:
    import xarray

    step = timing.step if every_step else timing.period
    units, texts = signal_units(setup.diagram), setup.diagram.texts
    signals = dict(zip(setup.program.layout.columns, rows.T, strict=True))
    data = {
        name: ("time", x, {"units": units(name), "text": texts.get(name, "")})
        for name, x in signals.items()
    }
    time = ("time", step * np.arange(len(rows)), {"units": "s"})
    scheme = f"exponential Runge-Kutta of order 4, step {timing.step * 1e3:.4g} ms"
    late = setup.delays[: len(timing.late)]
    scheme += describe_rounding(
        [setup.sampling.delay, *late], [timing.lag, *timing.late], timing.step
    )
    scheme += describe_give(diagram, setup.give, signals)
    if setup.program.has_code:
        scheme += ", in plain Python: a block is known as code only"
    attrs = {"diagram": setup.diagram.name, "step_s": timing.step, "scheme": scheme}
    attrs |= {f"parameter {n}": v for n, v in setup.diagram.values.items()}
    return xarray.Dataset(data, {"time": time}, attrs)
