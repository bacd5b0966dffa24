"""Fit of parameters, so that a simulation follows measured signals.

    fitted = td.fit_simulation(
        diagram,
        {"time": t, "L": position},
        {"Z_M.inertia": (0.05, 0.5), "Z_M.coulomb.level": (0.05, 2.0)},
        inputs={"R_V": force},
    )

The method is bounded least squares (scipy) from the best of many points. Slopes are differences of
simulations side by side. The fit compares whole motions. For unstable or chaotic motions, or for a
long record of a device that nothing holds, use `td.fit`: it compares forces along the measured
motion.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ModelError
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of, look
from ..diagrams import Diagram
from ..passivity.intervals.box import ValueBox
from ..simulate import Sampling
from ..simulate.sampling import SAMPLED
from ..simulate.simulation import has_ideal_friction
from ..simulate.units import signal_units
from ..studies.case import SimulatedCase, case_of
from ..studies.differences import check_slopes_exist
from ..studies.sensitivity import labelled_slopes
from .follow import Followed, Target, follow, rms_of
from .measured_signals import MeasuredSignals, measured_signals
from .problem import box_of_parameters

if TYPE_CHECKING:
    import matplotlib.figure
    import xarray


#: relative distance of an instant from a sample that counts as none
_ROUNDING = 1e-9
#: most samples of the computer between two rows: logs of a loop have a row for each sample or for
#: some tens of them. Times in ms that are read as s make a thousand of one
_RAREST = 300


@dataclass(frozen=True, eq=False)
class SimulationFit(Shown, ByValue):
    """A diagram whose simulation follows measured signals.

    case: with `values`;  errors: standard errors; NaN for parameters in `at_ends` (of their
        intervals) and `undetermined` (others can replace them, or no signal depends on them), and
        for all if the motion depends on one of them by jumps
    apart: parameter -> relative difference of the slopes behind its error, see `sensitivities`
    rms: signal -> rms of simulated minus measured (SI);  of_signal: the same over the standard
        deviation of the measured signal;  before: of_signal with the diagram's values, NaN if these
        have no simulation
    by_give: signal -> rms by which a tenth of the give would move it, over `rms`; {}: no friction
        is ideal
    data: SIGNAL_measured and SIGNAL_simulated over `time`
    sensitivities: of the signals at `values`;  searches: number of searches from different points
    agreeing: number of searches that ended at these values
    """

    case: SimulatedCase
    values: Mapping[str, float]
    errors: Mapping[str, float]
    at_ends: tuple[str, ...]
    undetermined: tuple[str, ...]
    apart: Mapping[str, float]
    rms: Mapping[str, float]
    of_signal: Mapping[str, float]
    before: Mapping[str, float]
    by_give: Mapping[str, float]
    data: xarray.Dataset
    sensitivities: xarray.Dataset
    searches: int
    agreeing: int

    @property
    def diagram(self) -> Diagram:
        """The diagram with the fitted values."""
        return self.case.diagram

    @property
    def remarks(self) -> tuple[str, ...]:
        """Warnings to read before the values are used."""
        return tuple(look(self, "notes"))

    def plot(self) -> matplotlib.figure.Figure:
        """Plot measured and simulated signals, with the difference below each."""
        return figure_of(self)


@check_types
def fit_simulation(
    diagram: Diagram | SimulatedCase,
    data: Any,
    parameters: Mapping[str, tuple[float, float]],
    *,
    signals: Mapping[str, str] | None = None,
    noise: Mapping[str, float] | None = None,
    inputs: Mapping[str, Any] | None = None,
    motion: Mapping[str, Any] | None = None,
    initial: Mapping[str, float] | None = None,
    computer: Sampling | Literal["continuous"] = SAMPLED,
    step: float = 1e-4,
    give: float = 1e-5,
    starts: int = 15,
    seed: int = 0,
) -> SimulationFit:
    """Values of parameters whose simulation follows measured signals, with standard errors.

    data: "time" (s; the simulation starts at 0) and samples by signal, SI, NaN where one lacks; a
        DataFrame with such a column or index; a Dataset over `time`; a `Simulation`; or a `Record`,
        whose time is counted from its first sample
    parameters: names of `SimulatedCase` -> (low, high), "initial.L" and the like included; searched
        in logarithms if high is 10 low or more
    signals: simulated signal -> its name in the data; default: all columns with the same name
    noise: signal -> standard deviation (SI) for its weight; default: the residual of the fit
    inputs, motion: as in `simulate`, or the name of a column of the data. A motion is
        differentiated twice without a low-pass: with steps of an encoder, `td.fit` is better
    initial, computer, step, give: as in `simulate`; what ideal friction gives may move the values,
        and `remarks` says so. A `SimulatedCase` keeps all its settings except the
        duration: up to the last whole sample of the computer within the data
    starts: number of points, besides the diagram's values, from which searches may begin
    returns: standard errors are valid for measurement errors that are correlated over at most 0.25
        s (a 30th of a shorter record), and for a model that is right except for the parameters:
        they do not contain errors of the model
    raises ModelError: no such parameter, signal or column, no interval, no simulation anywhere,
        rows so far apart that their time is hardly in s
    """
    measured = measured_signals(data)
    settings = {"initial": initial, "computer": computer, "step": step, "give": give}
    case = _case(diagram, measured, inputs or {}, motion or {}, settings)
    box = box_of_parameters(parameters)
    names = dict(signals) if signals is not None else _namesakes(case, measured)
    check_slopes_exist(case, box.names, tuple(names))
    for end in (box.low, box.high):
        case.with_values(box.named(np.array(end)))
    kept = measured.time <= case.duration * (1 + _ROUNDING)
    columns = {s: measured.column(c)[kept] for s, c in names.items()}
    target = Target(measured.time[kept], columns, noise or {})
    return _result(case, box, target, follow(case, box, target, starts, seed))


def _case(
    diagram: Diagram | SimulatedCase,
    measured: MeasuredSignals,
    inputs: Mapping[str, Any],
    motion: Mapping[str, Any],
    settings: Mapping[str, Any],
) -> SimulatedCase:
    """The case to simulate, over the time of the data."""
    driven = {n: measured.course(x) if isinstance(x, str) else x for n, x in inputs.items()}
    moved = {n: measured.motion(x) if isinstance(x, str) else x for n, x in motion.items()}
    case = case_of(diagram, inputs=driven, motion=moved, **settings)
    period = (SAMPLED if isinstance(case.computer, str) else case.computer).period
    _check_rows_are_dense(measured, period)
    # never beyond the last instant: what drives the simulation is not known there
    samples = max(np.floor(measured.time[-1] / period * (1 + _ROUNDING)), 1.0)
    return replace(case, duration=float(samples * period))


def _check_rows_are_dense(measured: MeasuredSignals, period: float) -> None:
    """Refuse rows that are far apart for a computer of that period, s: minutes of simulation."""
    apart = float(np.median(np.diff(measured.time)))
    if apart > _RAREST * period:
        raise ModelError(
            f"fit_simulation: time: rows are {apart:g} s apart, {apart / period:.3g} samples of a "
            f"computer with a period of {period:g} s, expected at most {_RAREST}: time is in s, "
            "not in ms; if it is right, state a slower computer"
        )


def _namesakes(case: SimulatedCase, measured: MeasuredSignals) -> dict[str, str]:
    """Measured columns with the name of a simulated signal, except inputs and motions."""
    known, driving = case.setup().program.layout.columns, {*case.inputs, *case.motion}
    names = {n: n for n in measured.columns if n in known and n not in driving}
    if not names:
        raise ModelError(
            f"fit_simulation: data: none of {', '.join(measured.columns)} is a signal of the "
            "simulation: say by `signals` which is"
        )
    return names


def _moved_by_give(case: SimulatedCase, target: Target, simulated: np.ndarray) -> np.ndarray | None:
    """Rms by which a tenth of the give moves each signal; None: no friction is ideal.

    simulated: the signals at the times of the target
    """
    if not has_ideal_friction(case.diagram):
        return None
    stiffer = replace(case, give=case.give / 10.0).simulate()
    signals = np.array([stiffer[name].values for name in target.names])
    return rms_of(target.at_times(stiffer.data["time"].values, signals) - simulated)


def _result(case: SimulatedCase, box: ValueBox, target: Target, end: Followed) -> SimulationFit:
    import xarray

    names, of = target.names, end.slopes
    simulated = target.at_times(of.time, of.signals)
    units = signal_units(case.diagram)
    columns = {}
    for k, name in enumerate(names):
        unit = {"units": units(name)}
        columns[f"{name}_measured"] = ("time", target.values[k], unit)
        columns[f"{name}_simulated"] = ("time", simulated[k], unit)
    rms, before = (rms_of(x - target.values) for x in (simulated, end.at_start))

    def by_signal(numbers: np.ndarray) -> dict[str, float]:
        return dict(zip(names, map(float, numbers), strict=True))

    def those(mask: np.ndarray) -> tuple[str, ...]:
        return tuple(n for n, holds in zip(box.names, mask, strict=True) if holds)

    fitted = case.with_values(box.named(end.values))
    moved = _moved_by_give(fitted, target, simulated)
    return SimulationFit(
        fitted,
        box.named(end.values),
        box.named(end.errors),
        those(end.is_at_end),
        those(~end.is_determined),
        box.named(end.apart),
        by_signal(rms),
        by_signal(rms / target.size),
        by_signal(before / target.size),
        by_signal(moved / rms) if moved is not None else {},
        xarray.Dataset(columns, {"time": ("time", target.time, {"units": "s"})}),
        labelled_slopes(case, of, box.names, names, end.values),
        end.searches,
        end.agreeing,
    )
