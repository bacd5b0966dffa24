"""Terms of a sparse formula: powers, decays, bells, ramps, sinusoids.

Each is a function of one variable, and nonlinear in at most one number.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..measurement.filtering import Array
from .shapes import ACCELERATION, COMMAND, INTERACTION, POSITION, TIME, Variable

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
    if low >= 0.0 or variable is TIME:
        first = max(float(knots[1]), 1e-3 * high)
        for n in np.geomspace(first, high, STARTS).tolist():
            terms += [FormulaTerm("bell", n), FormulaTerm("decay", n)]
    if variable in (COMMAND, INTERACTION, ACCELERATION):
        top = max(abs(low), abs(high))
        terms += [FormulaTerm("beyond", n) for n in (top * np.arange(1, STARTS) / STARTS).tolist()]
    if variable is POSITION:
        for n in np.linspace(low, high, STARTS + 2)[1:-1].tolist():
            terms += [FormulaTerm("above", n), FormulaTerm("below", n)]
    if wave > 0.0:
        terms.append(FormulaTerm("wave", wave))
    return terms
