"""The wave number of a pattern along the travel or in time, by search on the residual."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import fft
from scipy.optimize import minimize_scalar

from ..measurement.filtering import Array
from .rows import Rows
from .shapes import Shape

#: most periods within the travel: more would be below two knots in a period of the finest cogging
#: of the catalogue
MOST_PERIODS = 60.0
#: grid points for each resolved wave number (the inverse of the range)
FINENESS = 4


def wave_number(rows: Rows, left: Array, shape: Shape) -> float:
    """Cycles per unit of the variable of the sinusoid that removes most of the residual.

    left: weighted residual (n,)
    returns: 0 where the rows have no range of the variable
    """
    assert shape.variable is not None
    values = rows.at(shape.variable.name)
    carrier = shape.carrier.at(rows) * rows.root
    used = rows.learnt & np.isfinite(values)
    if not used.any() or np.ptp(values[used]) == 0.0 or not carrier[used].any():
        return 0.0
    values, carrier, left = values[used], carrier[used], left[used]
    reach = float(np.ptp(values))
    step = 1.0 / (FINENESS * reach)
    if shape.variable.name == "time":
        coarse = _frequency(rows, used, carrier * left, step)
    else:
        coarse = _best_wave_number(values, carrier, left, step)

    def lost(k: float) -> float:
        return -_gain(np.exp(2j * np.pi * k * values), carrier, left)

    bounds = (max(coarse - step, 0.5 * step), coarse + step)
    return float(minimize_scalar(lost, bounds=bounds, method="bounded").x)


def _gain(wave: NDArray[np.complex128], carrier: Array, left: Array) -> float:
    """Squares that carrier times a sinusoid removes: two columns, by their normal equations."""
    p, q = carrier * wave.real, carrier * wave.imag
    pp, qq, pq, pl, ql = (float(np.dot(*d)) for d in ((p, p), (q, q), (p, q), (p, left), (q, left)))
    free = max(pp * qq - pq * pq, 1e-9 * (pp + qq) ** 2, 1e-300)
    return (qq * pl * pl - 2 * pq * pl * ql + pp * ql * ql) / free


def _best_wave_number(values: Array, carrier: Array, left: Array, step: float) -> float:
    """Best wave number on a grid, from half a period over the range upwards."""
    turn = np.exp(2j * np.pi * step * values)
    wave, gains = turn.copy(), []
    numbers = step * np.arange(1, round(MOST_PERIODS * FINENESS) + 1)
    for _ in numbers:
        gains.append(_gain(wave, carrier, left))
        wave *= turn
    gains[0] = 0.0  # a quarter of a period is a slope
    return float(numbers[int(np.argmax(gains))])


def _frequency(rows: Rows, used: NDArray[np.bool_], product: Array, step: float) -> float:
    """Best frequency by Fourier transform of each stretch, in its record's time."""
    time, number = rows.at("time")[used], rows.number[used]
    interval = max(np.diff(time[number == i]).min() for i in np.unique(number))
    length = fft.next_fast_len(int(1.0 / (step * interval)) + 1, real=True)
    frequency = fft.rfftfreq(length, interval)
    total = np.zeros(len(frequency), dtype=complex)
    for i in np.unique(number):
        in_stretch = number == i
        place = np.round((time[in_stretch] - time[in_stretch][0]) / interval).astype(int) % length
        line = np.bincount(place, product[in_stretch], minlength=length)[:length]
        total += fft.rfft(line) * np.exp(-2j * np.pi * frequency * time[in_stretch][0])
    total[frequency < 2 * step] = 0.0
    return float(frequency[int(np.argmax(np.abs(total)))])
