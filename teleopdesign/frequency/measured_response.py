"""Measured frequency responses: from python-control data, from arrays, or from simulation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from ..base.errors import ModelError
from ..diagrams import Diagram
from ..simulate import Sampling
from ..simulate.sampling import SAMPLED
from .cases import cases_of
from .response import FrequencyResponse, phase_of, ratio_unit
from .sinusoid import BRISTLE_SHARE, Sinusoid, steady_harmonics

if TYPE_CHECKING:
    import control


def measured_response(
    values: control.FrequencyResponseData | np.ndarray | Sequence[complex],
    *,
    frequency: np.ndarray | Sequence[float] | None = None,
    output: str = "R_M",
    input: str = "R_D",
    unit: str = "1",
    case: str = "measured",
) -> FrequencyResponse:
    """A measured response, drawn as points in the plots of the model.

    values: `control.FRD` of one input and one output, or complex numbers (n,) at `frequency` in Hz
    output, input: signals;  unit: of output per input
    raises ModelError: another shape, or frequency missing, not rising or not positive
    """
    if not isinstance(values, np.ndarray | Sequence):
        data, omega = np.asarray(values.frdata), np.asarray(values.omega)
        if data.ndim == 3 and data.shape[:2] != (1, 1):
            raise ModelError(
                f"measured_response: found {data.shape[1]} inputs and {data.shape[0]} outputs, "
                "expected one of each: index the data"
            )
        numbers, f = data.reshape(-1), omega / (2 * np.pi)
    elif frequency is None:
        raise ModelError("measured_response: arrays need frequency, in Hz")
    else:
        numbers, f = np.asarray(values, dtype=complex), np.asarray(frequency, dtype=float)
    if numbers.shape != f.shape or f.ndim != 1:
        raise ModelError(
            f"measured_response: values of shape {numbers.shape} at frequencies of shape {f.shape}"
        )
    if not len(f) or f[0] <= 0 or (np.diff(f) <= 0).any():
        raise ModelError("measured_response: frequency must be positive and rise")
    return _points(numbers[None, :], [case], f, output, input, unit)


def simulated_response(
    diagrams: Diagram | Mapping[str, Diagram],
    *,
    amplitude: float,
    frequency: np.ndarray | Sequence[float],
    output: str = "R_M",
    input: str = "R_D",
    computer: Sampling | Literal["continuous"] = SAMPLED,
    give: float = BRISTLE_SHARE,
) -> FrequencyResponse:
    """First harmonic of `output` over that of `input`, from a simulation with a sinusoid.

    amplitude: of `input`, in its unit; the response of a nonlinear system depends on it
    If all effects have a linear form, `bode` gives the same. Other arguments are those of
    `measured_impedance`.
    """
    cases = cases_of(diagrams)
    f = np.asarray(frequency, dtype=float)
    rows = np.empty((len(cases), len(f)), dtype=complex)
    for i, diagram in enumerate(cases.values()):
        for j, one in enumerate(f):
            drive = Sinusoid(input, amplitude, float(one), computer=computer, give=give)
            harmonics = steady_harmonics(diagram, drive, signals=(output, input))
            rows[i, j] = harmonics[output].phasor / harmonics[input].phasor
    unit = ratio_unit(next(iter(cases.values())), output, input)
    return _points(rows, list(cases), f, output, input, unit)


def _points(
    values: np.ndarray, cases: list[str], f: np.ndarray, output: str, source: str, unit: str
) -> FrequencyResponse:
    size, phase = np.abs(values), phase_of(values, f)
    return FrequencyResponse(
        tuple(cases), f, size, phase, unit, output, source, left_out={}, measured=True
    )
