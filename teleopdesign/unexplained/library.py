"""Terms of a sparse formula: powers, decays, bells, ramps, sinusoids.

Each is a function of one variable, and nonlinear in at most one number.

The wave number of a pattern along the travel or in time, by search on the residual.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import fft
from scipy.optimize import minimize_scalar

from ..measurement.filtering import Array
from .rows import Rows
from .shapes import ACCELERATION, COMMAND, INTERACTION, POSITION, TIME, Shape, Variable

#: values of a number that a search begins with
STARTS = 24


@dataclass(frozen=True)
class FormulaTerm:
    """One term of a formula: its kind and its number n.

    kind: "power" (u^n), "decay" (exp(-u/n)), "bell" (exp(-(u/n)^2)), "above" and "below" (distance
        of u beyond n), "beyond" (distance of u from the range -n .. n), "wave" (cosine and sine
        with n cycles per unit: two coefficients)
    """

    kind: str
    number: float

    def values(self, u: Array) -> Array:
        """The term's functions (1 or 2, n) of the variable."""
        n = self.number
        if self.kind == "power":
            return (u**n)[None]
        if self.kind == "decay":
            return np.exp(-u / n)[None]
        if self.kind == "bell":
            return np.exp(-((u / n) ** 2))[None]
        if self.kind == "above":
            return np.maximum(u - n, 0.0)[None]
        if self.kind == "below":
            return np.maximum(n - u, 0.0)[None]
        if self.kind == "beyond":
            return (u - np.clip(u, -n, n))[None]
        return np.vstack([np.cos(2 * np.pi * n * u), np.sin(2 * np.pi * n * u)])

    @property
    def functions(self) -> int:
        """Number of its functions, which is the number of coefficients."""
        return 2 if self.kind == "wave" else 1

    @property
    def is_searched(self) -> bool:
        """Whether its number is optimised."""
        return self.kind != "power"


def terms_of(variable: Variable, knots: Array, wave: float) -> list[FormulaTerm]:
    """The candidate terms over a variable whose f has these knots.

    wave: cycles per unit of a sinusoid; 0: no sinusoid
    """
    low, high = float(knots[0]), float(knots[-1])
    terms = [FormulaTerm("power", p) for p in (1.0, 2.0, 3.0)]
    if low >= 0.0 or variable == TIME:
        first = max(float(knots[1]), 1e-3 * high)
        for n in np.geomspace(first, high, STARTS).tolist():
            terms += [FormulaTerm("bell", n), FormulaTerm("decay", n)]
    if variable in (COMMAND, INTERACTION, ACCELERATION):
        top = max(abs(low), abs(high))
        terms += [FormulaTerm("beyond", n) for n in (top * np.arange(1, STARTS) / STARTS).tolist()]
    if variable == POSITION:
        for n in np.linspace(low, high, STARTS + 2)[1:-1].tolist():
            terms += [FormulaTerm("above", n), FormulaTerm("below", n)]
    if wave > 0.0:
        terms.append(FormulaTerm("wave", wave))
    return terms


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
    carrier = shape.carrier.along(rows.at) * rows.root
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
