"""Derivatives of simulated signals with respect to parameters, over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ModelError, did_you_mean
from ..diagrams import Diagram
from ..simulate import Sampling, Trajectory
from ..simulate.sampling import SAMPLED
from ..simulate.units import signal_units
from .case import SimulatedCase, case_of
from .differences import SignalSlopes, check_slopes_exist, slopes_of

if TYPE_CHECKING:
    import xarray


@check_types
def sensitivities(
    diagram: Diagram | SimulatedCase,
    parameters: Sequence[str],
    signals: Sequence[str],
    *,
    scales: Mapping[str, float] | None = None,
    duration: float = 0.0,
    inputs: Mapping[str, Any] | None = None,
    motion: Mapping[str, Trajectory] | None = None,
    initial: Mapping[str, float] | None = None,
    computer: Sampling | Literal["continuous"] = SAMPLED,
    step: float = 1e-4,
) -> xarray.Dataset:
    """Derivatives d(signal)/d(parameter) of a simulation at the diagram's values, over time.

    parameters: names of `SimulatedCase`: values of the diagram, initial states, inputs that are
        numbers, sines;  signals: of the simulation, also hidden states
    scales: parameter -> a change that matters (SI); default: its value; required if that is 0
    duration ... step: settings of the simulation, see `study`
    returns: each signal over `parameter` and `time`, in its unit per SI unit of the parameter, from
        central differences of five sizes. SIGNAL_apart over `parameter`: difference of the slopes
        of the two sizes that agree best, over the slope; far below 1 the derivative is right, near
        1 or more there is no derivative (stick and slip, encoder steps). SIGNAL_size: the
        difference that is used, SI
    raises ModelError: no such parameter or signal, a parameter in whole steps, a value of 0 without
        a scale, no simulation at the values
    """
    case = case_of(
        diagram,
        duration=duration,
        inputs=inputs,
        motion=motion,
        initial=initial,
        computer=computer,
        step=step,
    )
    names, wanted = tuple(parameters), tuple(signals)
    check_slopes_exist(case, names, wanted)
    at = np.array([case.value(n) for n in names], dtype=float)
    of = slopes_of(case, names, at, scales_of(names, at, scales or {}), wanted)
    return labelled_slopes(case, of, names, wanted, at)


def scales_of(names: Sequence[str], at: np.ndarray, scales: Mapping[str, float]) -> np.ndarray:
    """The scale of each parameter, (names,): as stated, or the absolute value of the parameter.

    raises ModelError: a scale of an unknown parameter, or a value of 0 without a scale
    """
    for name in scales:
        if name not in names:
            raise ModelError(f'scales: "{name}" does not vary{did_you_mean(name, names)}')
    out = np.array([abs(scales.get(n, x)) for n, x in zip(names, at, strict=True)])
    for name, scale in zip(names, out, strict=True):
        if not 0 < scale < np.inf:
            raise ModelError(
                f'"{name}" is {scale:g}: state in `scales` which change of this parameter matters'
            )
    return out


def labelled_slopes(
    case: SimulatedCase,
    of: SignalSlopes,
    names: tuple[str, ...],
    signals: tuple[str, ...],
    at: np.ndarray,
) -> xarray.Dataset:
    """Slopes as labelled arrays with units."""
    import xarray

    units = signal_units(case.diagram)
    data: dict[str, Any] = {}
    for k, signal in enumerate(signals):
        unit = f"{units(signal)} per unit of the parameter"
        text = {"units": unit, "text": f"how {signal} changes with each parameter"}
        data[signal] = (("parameter", "time"), of.slopes[:, k], text)
        apart = {"units": "1", "text": "slopes of two sizes of difference apart, of the slope"}
        data[f"{signal}_apart"] = ("parameter", of.apart[:, k], apart)
        size = {"units": "SI", "text": "difference of the parameter that is read"}
        data[f"{signal}_size"] = ("parameter", of.sizes[:, k], size)
    coordinates: dict[str, Any] = {
        "parameter": list(names),
        "value": ("parameter", at),
        "unit": ("parameter", [case.unit(n) for n in names]),
        "time": ("time", of.time, {"units": "s"}),
    }
    return xarray.Dataset(data, coordinates, {"diagram": case.diagram.name})
