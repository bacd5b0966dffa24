"""A loop gain as sums of polynomials in s, each delayed: poles of the loop, crossings of 1.

    1 + L(s) = 0  where  f(s) = sum_k p_k(s) e^(-s T_k) = 0,   T_0 = 0

Where p_0 is of the highest degree alone (or its leading coefficient outweighs the others there),
f(j w)/(j w + a)^n has no other turns than those that zeros of f with Re s > 0 make: minus half a
turn each, from w = 0 up (Mikhailov). Further out than `_find_lead` p_0 leads the phase.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..controllers import make_exact
from ..derive.all_states import all_states
from ..derive.polynomials import is_free_of_growth
from ..diagrams import Diagram
from ..realise.lti import S

Terms = Mapping[float, np.ndarray]

#: frequencies on the first grid, before steps of the phase are halved
_POINTS = 4001
#: rad: longest step of the phase; a longer one is halved. Far from a zero of f, a quarter turn
#: would be sufficient
_STEP = 0.5
#: real part of a root, over its size, that is rounding
_ROUNDING = 1e-13
#: most samples of the phase: with more, the dead times are too long for the bandwidth of the loop
_MOST = 2_000_000


@dataclass(frozen=True)
class LateRatio:
    """above/below; each a mapping from dead time (s) to coefficients in s, highest power first."""

    above: Terms
    below: Terms

    @property
    def closed(self) -> Terms:
        """above + below, which is zero at the poles of the closed loop."""
        times = sorted({*self.above, *self.below})
        none = np.zeros(1)
        sums = {t: np.polyadd(self.above.get(t, none), self.below.get(t, none)) for t in times}
        return {t: p for t, p in ((t, np.trim_zeros(p, "f")) for t, p in sums.items()) if len(p)}

    def fades(self) -> bool:
        """Whether the magnitude is below 1 at all high frequencies, for any dead times."""
        degree = _degree(self.below)
        if _degree(self.above) > degree:
            return False
        first, *others = (abs(_coefficient(p, degree)) for p in self.below.values())
        return sum(abs(_coefficient(p, degree)) for p in self.above.values()) < first - sum(others)

    def passes(self) -> bool:
        """Whether the magnitude does not go to 0 at high frequency."""
        return _degree(self.above) >= _degree(self.below)

    def corners(self) -> np.ndarray:
        """Magnitudes of the roots of all polynomials, and points across resonances, rad/s."""
        polynomials = (p for terms in (self.above, self.below, self.closed) for p in terms.values())
        roots = np.concatenate([np.zeros(0), *(_roots(p) for p in polynomials)])
        roots = roots[np.abs(roots) > 0]
        size = np.abs(roots)[:, None]
        # a root on the axis itself has no width: 1e-9 of its size is what rounding leaves
        width = np.maximum(np.abs(roots.real)[:, None], 1e-9 * size)
        across = np.abs(roots.imag)[:, None] + width * np.linspace(-3, 3, 25)
        points = np.concatenate([size.ravel(), across.ravel()])
        return np.asarray(np.unique(points[points > 0]))


def terms_of(
    polynomial: Any, times: Mapping[sp.Symbol, sp.Expr], unit: Fraction | None = None
) -> Terms:
    """A polynomial in s and symbols of dead times as delayed terms.

    polynomial: an element of a ring whose first generator is s
    times: symbol of e^(-s T) -> T, s;  unit: divides all numbers; default: the largest of them
    """
    unit = unit or _largest(polynomial)
    delays = [times.get(x, sp.S(0)) for x in polynomial.ring.symbols]
    made: dict[Fraction, dict[int, Fraction]] = {}
    for powers, c in polynomial.items():
        late = sum((k * t for k, t in zip(powers[1:], delays[1:], strict=True)), sp.S(0))
        of_this = made.setdefault(Fraction(int(late.p), int(late.q)), {})
        of_this[powers[0]] = of_this.get(powers[0], 0) + Fraction(c.numerator, c.denominator)
    floats = {t: {k: float(c / unit) for k, c in p.items() if c} for t, p in sorted(made.items())}
    return {float(t): _array(p) for t, p in floats.items() if p}


def _largest(*polynomials: Any) -> Fraction:
    return max((abs(Fraction(c.numerator, c.denominator)) for p in polynomials for c in p.values()),
               default=Fraction(1))  # fmt: skip


@dataclass(frozen=True)
class CountedLoop:
    """The gain of a loop, from the equations of all states.

    ratio: the gain;  fault: why the loop has no margins, whatever its gain; "" for none
    """

    ratio: LateRatio
    fault: str = ""


def count_loop(diagram: Diagram, controller: str, *, speed: float) -> CountedLoop:
    """The loop of a controller of a linear diagram, with the modes that the loop does not see.

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
    return _counted(above, below, states.times)


def loop_as_written(gain: sp.Expr) -> CountedLoop:
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
    return _counted(above, below, times)


def _counted(above: Any, below: Any, times: Mapping[sp.Symbol, sp.Expr]) -> CountedLoop:
    unseen, above, below = above.cofactors(below)
    closed, order = above + below, _order(above, below)
    fault = ""
    if modes := describe_growth(unseen, times):
        fault = f"a mode that it does not see grows: {modes}"
    elif _order(closed) < order:
        fault = "its gain is -1 at high frequency: the least change makes a mode grow at once"
    unit = _largest(above, below)
    sides = [terms_of(side, times, unit) for side in (above, below)]
    first = min(t for terms in sides for t in terms)
    made = ({t - first: p for t, p in terms.items()} for terms in sides)
    return CountedLoop(LateRatio(*made), fault)


def _order(*polynomials: Any) -> int:
    """The highest power of s in polynomials; -1 if all are zero."""
    return max((powers[0] for p in polynomials for powers in p), default=-1)


def describe_growth(polynomial: Any, times: Mapping[sp.Symbol, sp.Expr]) -> str:
    """Modes of a polynomial, in words, that grow, 1/s; "" where all decay or keep their size."""
    if any(any(powers[1:]) for powers in polynomial):
        least = min(powers[0] for powers in polynomial)  # a mode at s = 0 keeps its size
        rest = polynomial.exquo(polynomial.ring.gens[0] ** least)
        return "with dead times" if count_growing(terms_of(rest, times)) else ""
    p = sp.Poly(polynomial.as_expr(), S, domain="QQ")
    if p.degree() < 1 or is_free_of_growth(p):
        return ""
    roots = np.array([complex(r) for r in p.sqf_part().nroots(n=20, maxsteps=200)])
    growing = roots[(roots.real > 0) & (roots.imag >= 0)]
    return ", ".join(f"{r:.4g}" if r.imag else f"{r.real:.4g}" for r in growing) + " 1/s"


def count_growing(terms: Terms) -> int:
    """Number of zeros of f with a positive real part, or at least 1 if there are any.

    Zeros on the axis within rounding count as well. A delayed term that is as strong as the first
    one at high frequency counts too: at a very small change of dead times there are infinitely many
    zeros.

    raises ModelError: the dead times turn the phase more often than can be followed
    """
    if not terms:
        return 1
    start = min(terms)
    terms = {t - start: p for t, p in terms.items()}
    first, *others = terms.values()
    degree = len(first) - 1
    if not others:
        # a root on the axis comes out of rounding on either side
        roots = _roots(first)
        return int((roots.real >= -_ROUNDING * np.abs(roots)).sum())
    weight = sum(abs(_coefficient(p, degree)) for p in others)
    if _degree(terms) > degree or weight >= abs(first[0]):
        return 1
    ratio = LateRatio(terms, {0.0: first})
    corners = ratio.corners()
    corners = corners if len(corners) else np.ones(1)
    scale = float(np.exp(np.mean(np.log(corners))))
    last = _find_lead(first, others, corners.max())
    number = int(last * max(terms) / _STEP) + 2
    if number > _MOST:
        raise ModelError("dead times are too long against the fastest that the loop lets pass")
    slow = np.geomspace(corners.min() / 1e4, last, _POINTS)
    w = np.unique(np.concatenate([slow, corners, np.linspace(0.0, last, number)]))

    def at(points: np.ndarray) -> np.ndarray:
        s = 1j * points
        total = sum((np.polyval(p, s) * np.exp(-s * t) for t, p in terms.items()), 0 * s)
        return np.asarray(total / (s + scale) ** degree)

    turned = _turn(at, w)
    if turned is None:
        return 1
    # further out the phase stays within a quarter turn of that of p_0, whose roots are slower
    end = 1j * w[-1]
    turned -= float(np.angle(at(w[-1:])[0] * (end + scale) ** degree / np.polyval(first, end)))
    turned += float(degree * np.angle(1 + scale / end) - np.angle(1 - _roots(first) / end).sum())
    return max(round(-turned / np.pi), 0)


def _turn(at: Callable[[np.ndarray], np.ndarray], w: np.ndarray) -> float | None:
    """Change of phase along these frequencies, rad; None: a zero on the axis makes it jump."""
    values = at(w)
    while (values != 0).all():
        steps = np.angle(values[1:] / values[:-1])
        wide = np.flatnonzero(np.abs(steps) > _STEP)
        if not len(wide):
            return float(steps.sum())
        middle = (w[wide] + w[wide + 1]) / 2
        if len(w) > _MOST or (middle == w[wide]).any() or (middle == w[wide + 1]).any():
            return None
        w, values = np.insert(w, wide + 1, middle), np.insert(values, wide + 1, at(middle))
    return None


def _find_lead(first: np.ndarray, others: Sequence[np.ndarray], start: float) -> float:
    """A frequency of at least `start` above which the first term exceeds all others, rad/s."""
    degree, w = len(first) - 1, start
    far = sum(abs(_coefficient(p, degree)) for p in others) / abs(first[0])
    for _ in range(200):
        beyond = w * np.geomspace(1.0, 1e6, 400)
        size = sum((np.abs(np.polyval(p, 1j * beyond)) for p in others), 0 * beyond)
        if (size < (0.7 + 0.3 * far) * np.abs(np.polyval(first, 1j * beyond))).all():
            return w
        w *= 2
    raise ModelError("a late term is about as strong as the others at high frequency")


def crossings(above: np.ndarray, below: np.ndarray) -> np.ndarray:
    """Frequencies at which abs(above/below) = 1, rad/s: roots of a polynomial, none missed.

    above, below: coefficients in s, highest first. A gain within 1e-12 of 1 counts as 1
    """
    (a, b), (c, d) = _halves(above), _halves(below)
    x = [Fraction(0), Fraction(1)]
    first = _add(_multiply(a, a), _multiply(x, _multiply(b, b)))
    second = _add(_multiply(c, c), _multiply(x, _multiply(d, d)))
    size = _add(first, [-e for e in second])
    while size and not size[-1]:
        size.pop()
    if len(size) < 2:
        return np.zeros(0)
    most = max(abs(e) for e in size)
    roots = _roots(np.array([float(e / most) for e in reversed(size)]))
    near = (roots.real > 0) & (np.abs(roots.imag) <= 1e-6 * np.abs(roots))
    return np.asarray(np.sqrt(roots.real[near]))


def _halves(p: np.ndarray) -> tuple[list[Fraction], list[Fraction]]:
    """(a, b), polynomials in w^2, lowest power first, with p(j w) = a + j w b."""
    exact = [Fraction(float(c)) for c in p[::-1]]
    turned = [c * (-1) ** (k // 2) for k, c in enumerate(exact)]
    return turned[::2], turned[1::2]


def _multiply(p: list[Fraction], q: list[Fraction]) -> list[Fraction]:
    out = [Fraction(0)] * max(len(p) + len(q) - 1, 0)
    for i, a in enumerate(p):
        for k, b in enumerate(q):
            out[i + k] += a * b
    return out


def _add(p: list[Fraction], q: list[Fraction]) -> list[Fraction]:
    longer, shorter = (p, q) if len(p) >= len(q) else (q, p)
    return [c + (shorter[k] if k < len(shorter) else 0) for k, c in enumerate(longer)]


def _roots(p: np.ndarray) -> np.ndarray:
    """Roots of a polynomial with coefficients of very different size, computed near size 1."""
    p = np.trim_zeros(np.asarray(p, dtype=float), "f")
    kept = np.trim_zeros(p, "b")
    zeros = np.zeros(len(p) - len(kept), dtype=complex)
    if len(kept) < 2:
        return zeros
    scale = abs(kept[-1] / kept[0]) ** (1 / (len(kept) - 1))
    powers = scale ** -np.arange(len(kept), dtype=float)
    return np.concatenate([np.roots(kept * powers / kept[0]) * scale, zeros])


def _array(coefficients: Mapping[int, float]) -> np.ndarray:
    out = np.zeros(max(coefficients) + 1)
    for degree, c in coefficients.items():
        out[-1 - degree] = c
    return out


def _coefficient(p: np.ndarray, degree: int) -> float:
    return float(p[-1 - degree]) if len(p) > degree else 0.0


def _degree(terms: Terms) -> int:
    return max((len(p) for p in terms.values()), default=0) - 1
