"""Points drawn in several parameters together: Latin hypercube, Sobol, random, for sensitivities.

A range is (low, high), uniform between both; (low, high, step), with equal probability of each low
+ n step, for delays in whole steps of a simulation; or a distribution of `scipy.stats`, such as
`scipy.stats.loguniform(1e-4, 1e-2)`. The same seed gives the same points on every machine.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ..base.errors import ModelError
from ..base.expectations import describe_value
from ..base.frozen import ByValue
from ..base.shown import Shown

Method = Literal["latin_hypercube", "sobol", "random", "sensitivity"]
#: most points of one sample: 8 bytes each and parameter, 0.8 GB for ten parameters
_MOST = 10_000_000
#: relative error of a range over a step that is rounding: 0.3 / 0.1 is a whole number
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Samples(Shown, ByValue):
    """Points in several parameters.

    names: parameters;  values: (points, parameters), SI;  ranges: of each parameter, in words
    method: of the draw;  base: of "sensitivity", number of points from which the others are made
    """

    names: tuple[str, ...]
    values: np.ndarray
    ranges: tuple[str, ...]
    method: Method
    seed: int
    base: int = 0

    def __len__(self) -> int:
        return len(self.values)


def latin_hypercube(ranges: Mapping[str, Any], samples: int, *, seed: int = 0) -> Samples:
    """Points that fill ranges evenly: one point in each of `samples` equal slices of every range.

    ranges: parameter -> (low, high), (low, high, step) or a distribution of `scipy.stats`
    samples: number of points;  seed: of the draw
    raises ModelError: no range, a range without width, no whole number of points above 0
    """
    from scipy.stats import qmc

    dimensions = _check("latin_hypercube", ranges, samples, seed)
    unit = qmc.LatinHypercube(dimensions, rng=np.random.default_rng(seed)).random(samples)
    return _scale_to_ranges(ranges, unit, "latin_hypercube", seed)


def sobol(ranges: Mapping[str, Any], samples: int, *, seed: int = 0) -> Samples:
    """Points of a scrambled Sobol sequence, which fills space evenly; see `latin_hypercube`.

    samples: a power of two: with another number the sequence loses its balance
    """
    dimensions = _check("sobol", ranges, samples, seed)
    return _scale_to_ranges(ranges, _sequence("sobol", dimensions, samples, seed), "sobol", seed)


def random_samples(ranges: Mapping[str, Any], samples: int, *, seed: int = 0) -> Samples:
    """Random points, independent of each other; arguments as in `latin_hypercube`.

    samples: number of points;  seed: the same seed gives the same points on every machine
    raises ModelError: no range, a range without width, no whole number of points above 0
    """
    dimensions = _check("random_samples", ranges, samples, seed)
    unit = np.random.default_rng(seed).random((samples, dimensions))
    return _scale_to_ranges(ranges, unit, "random", seed)


def sensitivity_samples(ranges: Mapping[str, Any], base: int, *, seed: int = 0) -> Samples:
    """Points for estimates of Sobol indices: base (k + 2) points in k parameters.

    Each of `base` pairs of points, from a Sobol sequence of 2 k dimensions, yields its two points
    and k points between them, in each of which one parameter has the value of the second point.
    Saltelli et al., Computer Physics Communications 181 (2010) 259, in the order that SALib
    expects.

    base: a power of two;  ranges: as in `latin_hypercube`
    """
    k = _check("sensitivity_samples", ranges, base, seed)
    pairs = _sequence("sensitivity_samples", 2 * k, base, seed)
    first, second = pairs[:, :k], pairs[:, k:]
    rows = np.repeat(first[:, None], k + 2, axis=1)
    rows[:, -1] = second
    for i in range(k):
        rows[:, i + 1, i] = second[:, i]
    return _scale_to_ranges(ranges, rows.reshape(-1, k), "sensitivity", seed, base)


def _sequence(where: str, dimensions: int, samples: int, seed: int) -> np.ndarray:
    from scipy.stats import qmc

    if samples & (samples - 1):
        near = 2 ** round(float(np.log2(samples)))
        raise ModelError(
            f"{where}: found {samples} points, expected a power of two; did you mean {near}?"
        )
    sequence = qmc.Sobol(dimensions, rng=np.random.default_rng(seed))
    return np.asarray(sequence.random(samples))


def _scale_to_ranges(
    ranges: Mapping[str, Any], unit: np.ndarray, method: Method, seed: int, base: int = 0
) -> Samples:
    """Scale points of the unit cube to the ranges."""
    columns, words = [], []
    for (name, extent), column in zip(ranges.items(), unit.T, strict=True):
        if hasattr(extent, "ppf"):
            columns.append(np.asarray(extent.ppf(column), dtype=float))
            words.append(distribution_text(extent))
        else:
            low, high, step = _ends(name, extent)
            if step:
                count = int((high - low) / step * (1 + _ROUNDING)) + 1
                columns.append(low + step * np.minimum(np.floor(count * column), count - 1))
            else:
                columns.append(low + (high - low) * column)
            words.append(f"{low:g} to {high:g}" + (f" in steps of {step:g}" if step else ""))
        if not np.isfinite(columns[-1]).all():
            raise ModelError(f"ranges: {name}: the distribution gives points that are not finite")
    return Samples(tuple(ranges), np.column_stack(columns), tuple(words), method, seed, base)


def distribution_text(extent: Any) -> str:
    """A frozen distribution of scipy as text: "lognorm(0.3, scale=2.0)"."""
    name = getattr(getattr(extent, "dist", None), "name", type(extent).__name__)
    parts = [f"{float(a):g}" for a in getattr(extent, "args", ())]
    parts += [f"{k}={float(v):g}" for k, v in getattr(extent, "kwds", {}).items()]
    return f"{name}({', '.join(parts)})"


def _ends(name: str, extent: Any) -> tuple[float, float, float]:
    """The low and high end and the step of a range; 0: no step."""
    try:
        low, high, *more = (float(x) for x in extent)
        (step,) = more or [0.0]
    except (TypeError, ValueError):
        raise ModelError(
            f"ranges: {name}: found {describe_value(extent)}, expected (low, high), (low, high, "
            "step) or a distribution of scipy.stats"
        ) from None
    if not (np.isfinite([low, high]).all() and low < high):
        raise ModelError(f"ranges: {name}: found {low:g} to {high:g}, expected low < high")
    if not 0 <= step <= high - low:
        raise ModelError(f"ranges: {name}: found a step of {step:g}, expected 0 to high - low")
    return low, high, step


def _check(where: str, ranges: Mapping[str, Any], samples: int, seed: int) -> int:
    """The number of parameters; raises ModelError for what no method can draw from."""
    if not ranges:
        raise ModelError("ranges: found no range, expected at least one, by parameter")
    if seed < 0:
        raise ModelError(f"{where}: seed: found {seed}, expected 0 or more")
    if not 0 < samples <= _MOST:
        raise ModelError(f"{where}: found {samples} points, expected 1 to {_MOST}")
    return len(ranges)
