"""Which parameter a measure depends on most: Sobol indices, estimated by SALib.

The first index is the share of the measure's variance that a parameter causes alone. The total
index adds the variance that the parameter causes together with other parameters. The sum of the
first indices is 1 if the parameters act independently of each other.

Derivatives of simulated signals with respect to parameters, over time.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ExperimentError, ModelError, did_you_mean
from ..diagrams import Diagram
from ..simulate import Sampling, Trajectory
from ..simulate.sampling import SAMPLED
from ..simulate.units import signal_units
from .case import SimulatedCase, case_of
from .differences import SignalSlopes, check_slopes_exist, slopes_of
from .points import SAMPLE

if TYPE_CHECKING:
    import xarray

    from .result import Study


#: resamplings of the estimate's interval, as SALib takes by default
_RESAMPLED = 100


def sensitivity(study: Study, measure: str = "") -> xarray.Dataset:
    """`first` and `total` Sobol indices over `parameter`, with half their 95 % intervals.

    measure: name; may be omitted if there is only one
    raises ModelError: the points are not from `sensitivity_samples`, some failed, or the measure
        never varies
    raises ExperimentError: SALib is not installed
    """
    import xarray

    try:
        from SALib.analyze import sobol
    except ImportError:
        raise ExperimentError(
            "sensitivity: Sobol indices need SALib: pip install 'teleopdesign[studies]'"
        ) from None
    if not measure and len(study.measures) != 1:
        raise ModelError(f"sensitivity: which measure? It has {', '.join(study.measures)}")
    name = measure or study.measures[0]
    values, attrs = study[name], study.data.attrs
    if attrs.get("sampling") != "sensitivity" or values.dims != (SAMPLE,):
        raise ModelError(
            "sensitivity: Sobol indices need points of sensitivity_samples alone, and a number at "
            f"each; found {attrs.get('sampling') or 'a grid'} over "
            f"{', '.join(map(str, values.dims))}"
        )
    numbers = values.values.astype(float)
    if bad := int((~np.isfinite(numbers)).sum()):
        raise ModelError(
            f"sensitivity: {name}: {bad} of {len(numbers)} points are no numbers; Sobol "
            "indices need all"
        )
    if np.ptp(numbers) == 0:
        raise ModelError(f"sensitivity: {name}: is {numbers[0]:g} at every point: nothing depends")
    names = json.loads(attrs["axes"])
    problem = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)  # of pandas, inside SALib
        indices = sobol.analyze(
            problem,
            numbers,
            calc_second_order=False,
            num_resamples=_RESAMPLED,
            seed=int(attrs["sampling_seed"]),
        )
    text = {"units": "1"}
    return xarray.Dataset(
        {
            "first": ("parameter", np.asarray(indices["S1"]), text),
            "first_interval": ("parameter", np.asarray(indices["S1_conf"]), text),
            "total": ("parameter", np.asarray(indices["ST"]), text),
            "total_interval": ("parameter", np.asarray(indices["ST_conf"]), text),
        },
        {"parameter": names},
        {"measure": name, "method": "Saltelli et al. (2010), by SALib"},
    )


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
