"""Confidence bands of responses, from the covariance of fitted parameters (delta method).

    d ln H / dp = (d|H|/dp) / |H| + j d(phase)/dp

So the real parts of these derivatives give the variance of the log-magnitude, the imaginary parts
that of the phase. A band holds at each frequency alone, and while the response is nearly linear in
the parameters over their standard errors.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ModelError
from ..base.frozen import ByValue
from ..blocks import NINETY_FIVE
from ..diagrams import Diagram
from ..diagrams.units import bounds_of_value

Array = NDArray[np.float64]
#: difference of a parameter for its derivative, in standard errors: far below the width of the
#: band, and far above the rounding of describing functions
STEP = 0.1


@dataclass(frozen=True, eq=False)
class ParameterCovariance(ByValue):
    """Covariance of fitted parameters of a diagram.

    names: as in `Diagram.values`, "Z_M.coulomb.level";  matrix: (p, p), SI
    undetermined: names without a standard error: bands take them as known
    """

    names: tuple[str, ...]
    matrix: Array
    undetermined: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        shape = np.shape(self.matrix)
        if shape != (len(self.names), len(self.names)):
            raise ModelError(
                f"ParameterCovariance: found a matrix of shape {shape} for {len(self.names)} names"
            )


@dataclass(frozen=True, eq=False)
class ResponseBand(ByValue):
    """Standard errors of a response over cases and frequencies.

    log_magnitude: of ln |H|, dimensionless, (cases, n);  phase: degrees, (cases, n)
    undetermined: parameters of the diagram that count as known, because they have no standard error
    """

    log_magnitude: Array
    phase: Array
    undetermined: tuple[str, ...] = ()

    @property
    def decibel(self) -> Array:
        """Half width of the 95 % interval of the magnitude, in dB."""
        return np.asarray(NINETY_FIVE * 20 / np.log(10) * self.log_magnitude)

    @property
    def degrees(self) -> Array:
        """Half width of the 95 % interval of the phase, in degrees."""
        return np.asarray(NINETY_FIVE * self.phase)


def confidence_band(
    values_of: Callable[[Diagram], NDArray[np.complex128]],
    diagrams: Iterable[Diagram],
    covariance: ParameterCovariance,
) -> ResponseBand:
    """The band of a response of each diagram; parameters that a diagram lacks count for nothing.

    values_of: response (..., n) of a diagram with any values of the parameters
    raises ModelError: no diagram has any of the parameters
    """
    diagrams = tuple(diagrams)
    here = {name for one in diagrams for name in one.values}
    if not here.intersection(covariance.names):
        raise ModelError(
            f"covariance: found {', '.join(covariance.names) or 'no parameter'}, expected "
            f"parameters of the diagram, such as {', '.join(sorted(here)[:3])}"
        )
    rows = [_variances(values_of, one, covariance) for one in diagrams]
    size, phase = (np.sqrt(np.maximum(part, 0.0)) for part in zip(*rows, strict=True))
    undetermined = tuple(n for n in covariance.undetermined if n in here)
    return ResponseBand(size, np.degrees(phase), undetermined)


def _variances(
    values_of: Callable[[Diagram], NDArray[np.complex128]],
    diagram: Diagram,
    covariance: ParameterCovariance,
) -> list[Array]:
    """Variances of ln |H| and of the phase (rad), (..., n)."""
    spread = np.sqrt(np.diag(covariance.matrix))
    chosen = [k for k, n in enumerate(covariance.names) if n in diagram.values and spread[k] > 0]
    matrix = covariance.matrix[np.ix_(chosen, chosen)]
    slopes = np.zeros((len(chosen), *np.shape(values_of(diagram))), dtype=complex)
    for row, k in enumerate(chosen):
        value, step = diagram.values[covariance.names[k]], STEP * spread[k]
        lower, upper = bounds_of_value(diagram, covariance.names[k])
        low, high = max(value - step, lower), min(value + step, upper)
        before, after = (
            values_of(diagram.with_values({covariance.names[k]: x})) for x in (low, high)
        )
        with np.errstate(divide="ignore", invalid="ignore"):  # a response may be zero
            slopes[row] = np.log(after / before) / (high - low)
    return [
        np.einsum("p...,pq,q...->...", part, matrix, part) for part in (slopes.real, slopes.imag)
    ]
