"""A loop gain as a ratio of sums of polynomials in s, each delayed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..controllers import make_exact
from ..derive.all_states import all_states
from ..derive.polynomials import RING, cross, roots_of
from ..diagrams import Diagram
from ..realise.lti import S
from .late_zeros import Terms, coefficient, corners_of, degree_of, describe_growth, terms_of


@dataclass(frozen=True)
class LateRatio:
    """above/below; each a mapping from dead time (s) to coefficients in s, highest power first.

    fault: why a loop of this gain has no margins, whatever its gain; "" for none
    """

    above: Terms
    below: Terms
    fault: str = ""

    @property
    def closed(self) -> Terms:
        """above + below, which is zero at the poles of the closed loop."""
        times = sorted({*self.above, *self.below})
        none = np.zeros(1)
        sums = {t: np.polyadd(self.above.get(t, none), self.below.get(t, none)) for t in times}
        return {t: p for t, p in ((t, np.trim_zeros(p, "f")) for t, p in sums.items()) if len(p)}

    def fades(self) -> bool:
        """Whether the magnitude is below 1 at all high frequencies, for any dead times."""
        degree = degree_of(self.below)
        if degree_of(self.above) > degree:
            return False
        first, *others = (abs(coefficient(p, degree)) for p in self.below.values())
        return sum(abs(coefficient(p, degree)) for p in self.above.values()) < first - sum(others)

    def corners(self) -> np.ndarray:
        """Magnitudes of the roots of all polynomials, and points across resonances, rad/s."""
        return corners_of(self.above, self.below, self.closed)


def count_loop(diagram: Diagram, controller: str, *, speed: float) -> LateRatio:
    """The gain of a linear diagram's loop, with the modes that the loop does not see.

    With a factor g at the output of the controller, the determinant of all equations is d + g n.
    The loop gain is n/d, and common factors of n and d are modes that the loop does not change.

    raises ModelError: the wiring does not determine the loop
    """
    factor = sp.Symbol("factor")
    states = all_states(diagram, gains={controller: factor}, speed=speed)
    whole = states.determinant()
    place = states.ring.symbols.index(factor)
    sides = [states.ring({k: c for k, c in whole.items() if k[place] == power}) for power in (0, 1)]
    below, above = sides[0], sides[1].exquo(states.ring.gens[place]) if sides[1] else sides[1]
    if not below:
        raise ModelError(f"{diagram.name}: the wiring does not determine the loop of {controller}")
    return _count_modes(above, below, states.times)


def loop_as_written(gain: sp.Expr) -> LateRatio:
    """A loop by its gain alone, in `S` and e^(-s T), without states that the gain does not show.

    raises ModelError: it is no ratio of polynomials in s and dead times
    """
    powers = {x: sp.Dummy(f"late_{k}") for k, x in enumerate(sorted(gain.atoms(sp.exp), key=str))}
    sides = sp.fraction(sp.cancel(sp.together(gain.xreplace(powers))))
    times = {mark: -power.args[0].coeff(S) for power, mark in powers.items()}
    ring, *_ = sp.ring((S, *times), sp.QQ)
    is_ratio = all(t.is_Rational for t in times.values())
    if not is_ratio or not all(p.is_polynomial(S, *times) for p in sides):
        raise ModelError("loop: expected a ratio of polynomials in s and dead times")
    above, below = (ring.from_expr(make_exact(sp.expand(p))) for p in sides)
    return _count_modes(above, below, times)


def _count_modes(above: Any, below: Any, times: Mapping[sp.Symbol, sp.Expr]) -> LateRatio:
    unseen, above, below = above.cofactors(below)
    closed, order = above + below, max(_order(above), _order(below))
    fault = ""
    if modes := describe_growth(unseen, times):
        fault = f"a mode that it does not see grows: {modes}"
    elif _order(closed) < order:
        fault = "its gain is -1 at high frequency: the least change makes a mode grow at once"
    largest = max(abs(c) for side in (above, below) for c in side.values())
    unit = Fraction(int(largest.numerator), int(largest.denominator))
    sides = [terms_of(side, times, unit=unit) for side in (above, below)]
    first = min(t for terms in sides for t in terms)
    made = ({t - first: p for t, p in terms.items()} for terms in sides)
    over, under = made
    return LateRatio(over, under, fault)


def _order(p: Any) -> int:
    """The highest power of s; -1 if all are zero."""
    return max((powers[0] for powers in p), default=-1)


def crossings(above: np.ndarray, below: np.ndarray) -> np.ndarray:
    """Frequencies at which abs(above/below) = 1, rad/s: roots of a polynomial, none missed.

    above, below: coefficients in s, highest first. A gain within 1e-12 of 1 counts as 1
    """
    sides = [[Fraction(float(c)) for c in side[::-1]] for side in (above, below)]
    rings = [
        RING({(k,): sp.QQ(c.numerator, c.denominator) for k, c in enumerate(side) if c})
        for side in sides
    ]
    first, second = (cross(side, side)[0] for side in rings)
    at = roots_of(first - second)
    near = (at.real > 0) & (np.abs(at.imag) <= 1e-6 * np.abs(at))
    return np.asarray(np.sqrt(at.real[near]))
