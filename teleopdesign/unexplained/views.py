"""Graphs of the residual against each signal, and its pattern: correlation and frequencies.

Sensor noise below the comparison's low-pass is correlated only as long as this filter responds. The
residual of a missing force is slower: it is correlated over some tenths of a second.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from ..base.finding import Graph, Series
from ..base.sentences import readable_unit
from ..base.units import unit_of
from ..diagnose.solve import BLOCK
from ..measurement.filtering import FORGOTTEN, Array
from .curve import BAND, BINS, Curve
from .rows import Rows
from .shapes import Shape

#: lags that are looked at
LAGS = 12


@dataclass(frozen=True)
class Whiteness:
    """Autocorrelation of the residual.

    lag: s, (l,);  correlation: (l,);  noise: (l,) standard deviation of the correlation by chance
    probability: that chance alone gives the largest correlation, over all lags
    spectrum: rows frequency (Hz), rms of the residual and of the measured force per band (3, f)
    """

    lag: Array
    correlation: Array
    noise: Array
    probability: float
    spectrum: Array

    @property
    def band(self) -> tuple[float, float]:
        """The frequencies (Hz) with a quarter of the residual's squares below, and above."""
        frequency, height, _ = self.spectrum
        squares = np.cumsum(height**2)
        share = squares / max(float(squares[-1]), 1e-300)
        # what is at a frequency lies to either side of it, up to the middle of two
        middles = 0.5 * (frequency[1:] + frequency[:-1])
        ends = np.concatenate([frequency[:1], middles, frequency[-1:]])
        low, high = np.interp([0.25, 0.75], np.concatenate([[0.0], share]), ends)
        return float(low), float(high)


def whiteness_of(rows: Rows) -> Whiteness:
    """Autocorrelation of the residual on all rows, tested by blocks of a quarter of a second."""
    lags = np.geomspace(FORGOTTEN / rows.bandwidth, 2 * BLOCK, LAGS)
    left = rows.residual
    whole = float(left @ left)
    correlation, noise = np.zeros(LAGS), np.zeros(LAGS)
    parts = [np.flatnonzero(rows.number == i) for i in np.unique(rows.number)]
    steps = [a.stretch.motion.sample_time * a.stretch.weight for a in rows.alongs]
    for i, lag in enumerate(lags):
        sums = np.zeros(int(rows.blocks.max()) + 1)
        for part, step in zip(parts, steps, strict=True):
            k = max(1, round(lag / step))
            if k < len(part):
                np.add.at(sums, rows.blocks[part[:-k]], left[part[k:]] * left[part[:-k]])
        correlation[i] = sums.sum() / max(whole, 1e-300)
        # neighbouring blocks share samples: their products are taken in
        spread = float(sums @ sums + 2 * (sums[1:] @ sums[:-1]))
        noise[i] = np.sqrt(max(spread, float(sums @ sums))) / max(whole, 1e-300)
    largest = float(np.max(np.abs(correlation) / np.maximum(noise, 1e-300)))
    chance = min(1.0, 2 * LAGS * float(ndtr(-largest)))
    return Whiteness(lags, correlation, noise, chance, _spectrum(rows, parts, steps))


def _spectrum(rows: Rows, parts: list[NDArray[np.intp]], steps: list[float]) -> Array:
    """Band frequency, rms of the residual and of the measured force per band (3, f).

    The bands are logarithmic from 1 Hz to the bandwidth, with one band below 1 Hz.
    """
    edges = np.concatenate([[0.0], np.geomspace(1.0, rows.bandwidth, 25)])
    squares = np.zeros((2, len(edges) - 1))
    for part, step in zip(parts, steps, strict=True):
        frequency = np.fft.rfftfreq(len(part), step)
        band = np.clip(np.searchsorted(edges, frequency, side="right") - 1, 0, len(edges) - 2)
        for j, signal in enumerate((rows.residual, rows.measured)):
            power = 2 * np.abs(np.fft.rfft(signal[part])) ** 2 / len(part)
            np.add.at(squares[j], band, power)
    middle = np.sqrt(np.maximum(edges[1:] * edges[:-1], 0.25 * edges[1:] ** 2))
    return np.vstack([middle, np.sqrt(squares / len(rows.residual))])


#: view -> (signal, quantity, its words on the axis)
VIEWS = {
    "time": ("time", "time", "time"),
    "velocity": ("velocity", "velocity", "velocity"),
    "position": ("position", "position", "position"),
    "acceleration": ("acceleration", "acceleration", "acceleration"),
    "force": ("actuator_force", "force", "actuator force"),
    "direction": ("direction", "", "direction"),
    "time since reversal": ("since_reversal", "time", "time since reversal"),
}
#: most points of a cloud
CLOUD = 3000
#: words of a variable and of a carrier on an axis
WORDS = {
    "speed": "speed",
    "actuator_force": "actuator force",
    "load": "size of the actuator force",
    "interaction_force": "interaction force",
    "since_reversal": "time since reversal",
    "travel": "travel since reversal",
}
LACKS = {
    "force": "missing force",
    "friction": "missing friction",
    "damping": "missing damping",
    "mass": "missing moving mass",
    "lost command": "part of command lost",
    "lateness": "lateness of command",
}


def label(words: str, quantity: str, axis: str, largest: float = np.inf) -> tuple[float, str]:
    """Factor from SI, and the axis label with its unit; prefixed units for small values."""
    if not quantity:
        return 1.0, words
    if quantity == "acceleration" or not np.isfinite(largest):
        unit = unit_of(quantity, axis).replace("*", " ").replace("^2", "²")
        return 1.0, f"{words} ({unit})"
    factor, unit = readable_unit(quantity, axis, largest)
    return factor, f"{words} ({unit})"


def views_of(rows: Rows, whiteness: Whiteness | None) -> dict[str, Graph]:
    """Graphs of the residual against each view, forward and backward separately, with means."""
    if whiteness is None:
        return {"velocity": _view(rows, *VIEWS["velocity"])}
    return {
        **{name: _view(rows, *VIEWS[name]) for name in VIEWS},
        "frequency": _frequency(rows, whiteness),
    }


def _view(rows: Rows, signal: str, quantity: str, words: str) -> Graph:
    value, direction = rows.at(signal), rows.at("direction")
    known = np.isfinite(value)
    most = float(np.max(np.abs(value[known]), initial=0.0))
    fx, x_label = label(words, quantity, rows.axis, most)
    fy, y_label = label("residual", "force", rows.axis, float(np.max(np.abs(rows.residual))))
    x, y = fx * value, fy * rows.residual
    series = []
    for name, in_direction in (("forward", direction > 0), ("backward", direction < 0)):
        chosen = np.flatnonzero(in_direction & known)
        chosen = chosen[:: max(1, len(chosen) // CLOUD)]
        series.append(Series(name, x[chosen], y[chosen], "rest"))
    if signal == "time":  # records lie over each other
        return Graph(x_label, y_label, tuple(series))
    for name, in_direction in (("mean forward", direction > 0), ("mean backward", direction < 0)):
        used = in_direction & known
        mean = _bin_means(x[used], y[used], rows.blocks[used])
        series.append(Series(name, mean[0], mean[1], "trend", mean[2], mean[3]))
    return Graph(x_label, y_label, tuple(series))


def _bin_means(x: Array, y: Array, blocks: NDArray[np.intp]) -> Array:
    """Means in bins of equally many rows, with bands by blocks: rows x, mean, low, high (4, b)."""
    if not len(x):
        return np.zeros((4, 0))
    edges = np.unique(np.quantile(x, np.linspace(0, 1, BINS + 1)))
    place = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, max(len(edges) - 2, 0))
    bins = []
    for k in np.unique(place):
        in_bin = place == k
        mean = float(y[in_bin].mean())
        sums = np.bincount(blocks[in_bin], y[in_bin] - mean)
        half = BAND * float(np.sqrt(np.sum(sums**2))) / int(in_bin.sum())
        bins.append((float(x[in_bin].mean()), mean, mean - half, mean + half))
    return np.array(bins).T


def _frequency(rows: Rows, whiteness: Whiteness) -> Graph:
    frequency, left, measured = whiteness.spectrum
    used = left > 0
    largest = float(np.max(measured))
    factor, y_label = label("rms per band", "force", rows.axis, largest)
    return Graph(
        "frequency (Hz)",
        y_label,
        (
            Series("measured force", frequency[used], factor * measured[used], "course"),
            Series("residual", frequency[used], factor * left[used], "trend"),
        ),
        logarithmic=True,
    )


def curve_graph(shape: Shape, curve: Curve, axis: str) -> Graph:
    """The dependence as a curve with its band, and means over the checked rows."""
    quantity = shape.carrier.quantity
    largest = float(np.max(np.abs([curve.low, curve.high])))
    fy, y_label = label(LACKS[shape.carrier.name], quantity, axis, largest)
    if shape.variable is None:
        name = "all rows"
        band = (fy * curve.low, fy * curve.high)
        return Graph(name, y_label, (Series(name, curve.x, fy * curve.y, "trend", *band),))
    variable = shape.variable
    words = WORDS.get(variable.name, variable.name)
    fx, x_label = label(words, variable.quantity, axis, float(np.max(np.abs(curve.x))))
    x, y, low, high = curve.means
    return Graph(
        x_label,
        y_label,
        (
            Series("check, means", fx * x, fy * y, "measured", fy * low, fy * high),
            Series("smooth", fx * curve.x, fy * curve.y, "trend", fy * curve.low, fy * curve.high),
        ),
    )
