"""Show that a sum with dead times has no zero on the axis, for all values of a box.

The box is divided into parts. Within a part with middle m and half widths r, a monomial changes by
at most (abs(m) + r)^a - abs(m)^a, and e^(-j w tau) changes by at most the change of w tau. So f(jw)
is not zero in a part where abs(f) in the middle is larger than the sum of these changes. A part for
which this is not so is halved along the variable that changes f most. Parts are stored by their
ends, so no gap remains between two halves.

The sums are in floats. Each has at most some hundred operations, each of which is wrong by at most
2^-53 of its result, and so has each end of an interval and each coefficient. All of this, and the
error of a library's sine and cosine, is far below `_ROUNDING` of the sum of all sizes, by which
abs(f) has to be larger. An angle is wrong by at most `_ANGLE` of its size.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import sympy as sp

from ...derive.effort import spend
from .box import ValueBox

#: most parts that are tested: some ten seconds on one core
_MOST_PARTS = 400_000
#: parts of the range of w at the start
_FIRST = 64
#: of the sum of all sizes, and of an angle: more than all rounding, 2^-53 in each operation
_ROUNDING, _ANGLE = 1e-9, 1e-12


@dataclass(frozen=True)
class _Group:
    """Terms that share one late factor e^(-s sum b T).

    late: b;  powers: of s (of 1/w where `outside`) and of the values, (terms, 1 + values)
    turned: coefficients of the terms times j^k, complex
    """

    late: np.ndarray
    powers: np.ndarray
    turned: np.ndarray


def is_zero_free(p: Any, times: Mapping[sp.Symbol, sp.Expr], box: ValueBox) -> int | None:
    """Number of parts that show that f(jw) is nowhere zero, for all dead times from 0 on.

    p: f, a polynomial in s, the values of a box and symbols of e^(-s T);  times: of these T
    returns: None where nothing is shown
    """
    groups, values, longest = _sum_over_box(p, times, box)
    if groups[0].late.any():
        return None  # every term is late: dead times may be taken off, which is not done here
    degree = max(k[0] for k in p)
    fastest, total = _find_fastest(groups, degree, values), 0
    # from `fastest` on, infinity included, f/w^n over 1/w
    first = np.arange(1 + len(values)) == 0
    beyond = [replace(g, powers=np.where(first, degree - g.powers, g.powers)) for g in groups]
    for outside, sums, end in ((True, beyond, 1 / fastest), (False, groups, fastest)):
        most = np.zeros(0) if outside else longest
        low = np.concatenate([[0.0], values[:, 0], 0 * most])
        high = np.concatenate([[end * (1 + 1e-12)], values[:, 1], most])
        # beyond the range of floats nothing is shown
        with np.errstate(all="ignore"):
            parts = _show(sums, low, high, outside, _MOST_PARTS - total)
        if parts is None:
            return None
        total += parts
    return total


def _sum_over_box(
    p: Any, times: Mapping[sp.Symbol, sp.Expr], box: ValueBox
) -> tuple[list[_Group], np.ndarray, np.ndarray]:
    """Groups of terms, the one without dead time first; intervals of the values; dead times, s.

    returns: groups;  intervals, (values, 2), of the values that f depends on;  the longest times
    """
    symbols, n = p.ring.symbols, len(box.names)
    marks = [symbols.index(x) for x in times]
    ends = dict(zip(symbols[1 : 1 + n], box.high, strict=True))
    longest = [
        float(sp.sympify(t).xreplace({x: sp.Float(v, 17) for x, v in ends.items()}))
        for t in times.values()
    ]
    used = [k for k in range(1, 1 + n) if any(powers[k] for powers in p)]
    largest = max(map(abs, p.values()))
    made: dict[tuple[int, ...], list[tuple[list[int], complex]]] = {}
    for powers, c in p.items():
        share = c / largest
        size = int(share.numerator) / int(share.denominator) * 1j ** (powers[0] % 4)
        late = tuple(powers[k] for k in marks)
        made.setdefault(late, []).append(([powers[0], *(powers[k] for k in used)], size))
    groups = [
        _Group(np.array(late), np.array([k for k, _ in terms]), np.array([c for _, c in terms]))
        for late, terms in sorted(made.items(), key=lambda item: sum(item[0]))
    ]
    values = np.array([[box.low[k - 1], box.high[k - 1]] for k in used]).reshape(-1, 2)
    return groups, values, np.array(longest)


def _show(
    groups: Sequence[_Group], low: np.ndarray, high: np.ndarray, outside: bool, most: int
) -> int | None:
    """Number of parts that show that f(jw) is not zero between `low` and `high`; None: not shown.

    outside: whether the first variable is 1/w instead of w
    """
    edges = np.linspace(low[0], high[0], _FIRST + 1)
    lows, highs = np.tile(low, (_FIRST, 1)), np.tile(high, (_FIRST, 1))
    lows[:, 0], highs[:, 0] = edges[:-1], edges[1:]
    total = 0
    while len(lows):
        total += len(lows)
        spend(len(lows) * sum(len(g.powers) for g in groups) // 64 + 1)
        if total > most:
            return None
        left = ~_hold(groups, lows, highs, outside)
        lows, highs = lows[left], highs[left]
        middle = lows + (highs - lows) / 2
        half = highs - middle
        alone = (np.where(np.arange(half.shape[1]) == i, half, 0.0) for i in range(half.shape[1]))
        moves = [_values(groups, middle, one, outside)[1].sum(axis=0) for one in alone]
        axis, rows = np.argmax(moves, axis=0), np.arange(len(lows))
        cut = middle[rows, axis]
        if ((cut <= lows[rows, axis]) | (cut >= highs[rows, axis])).any():
            return None  # a part between two neighbouring floats
        lower, upper = highs.copy(), lows.copy()
        lower[rows, axis] = upper[rows, axis] = cut
        lows, highs = np.concatenate([lows, upper]), np.concatenate([lower, highs])
    return total


def _hold(groups: Sequence[_Group], low: np.ndarray, high: np.ndarray, outside: bool) -> np.ndarray:
    """Whether f is shown to have no zero in each part, (parts,)."""
    middle = low + (high - low) / 2
    half = np.maximum(high - middle, middle - low)
    value, moved, size = _values(groups, middle, half, outside)
    slack = moved.sum(axis=0) + _ROUNDING * size.sum(axis=0)
    if outside:
        return np.asarray(np.abs(value[0]) > np.abs(value[1:]).sum(axis=0) + slack)
    return np.asarray(np.abs(value.sum(axis=0)) > slack)


def _values(
    groups: Sequence[_Group], middle: np.ndarray, half: np.ndarray, outside: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Value in the middle, bound of the change, and size of each group, (groups, parts).

    outside: of f/w^n over 1/w, without the late factors
    """
    n = groups[0].powers.shape[1]
    made: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    for group in groups:
        sizes = np.abs(group.turned)
        here = _monomials(middle[:, :n], group.powers)
        size = _monomials(np.abs(middle[:, :n]) + half[:, :n], group.powers) @ sizes
        value, move = here @ group.turned, size - np.abs(here) @ sizes
        if not outside:
            angle = middle[:, 0] * (middle[:, n:] @ group.late)
            most = (middle[:, 0] + half[:, 0]) * ((middle + half)[:, n:] @ group.late)
            value = value * np.exp(-1j * angle)
            move = move + np.abs(value) * np.minimum(most - angle + _ANGLE * most, 2.0)
        made.append((value, move, size))
    value, move, size = (np.array(part) for part in zip(*made, strict=True))
    return value, move, size


def _monomials(points: np.ndarray, powers: np.ndarray) -> np.ndarray:
    """Values of monomials at points, (parts, terms)."""
    out = np.ones((len(points), len(powers)))
    for i in range(points.shape[1]):
        table = points[:, i, None] ** np.arange(powers[:, i].max() + 1)
        out = out * table[:, powers[:, i]]
    return out


def _find_fastest(groups: Sequence[_Group], degree: int, values: np.ndarray) -> float:
    """A frequency, rad/s, above which the first polynomial is larger than the others together.

    The choice is by samples. `is_zero_free` then tests all frequencies above it.
    """
    w = np.geomspace(1e-6, 1e9, 1501)
    fastest, far = 1e-6, w > 1e8
    for point in (values[:, 0], values[:, 1], values.mean(axis=1)):
        here = np.column_stack([w, np.tile(point, (len(w), 1))])
        size = np.abs([_monomials(here, g.powers) @ g.turned for g in groups])
        ratio = size[1:].sum(axis=0) / np.maximum(size[0], 1e-300)
        limit = 0.5 + 0.5 * float(np.min(ratio[far]))
        # p_0 is to be in its asymptote, where 1/w tells little
        lead = np.maximum(size[0, -1] * (w / w[-1]) ** degree, 1e-300)
        for beyond in (ratio > limit, np.abs(size[0] / lead - 1) > 0.5):
            above = np.flatnonzero(beyond)
            fastest = max(fastest, float(w[above[-1]]) if len(above) else 0.0)
    return 1.2 * fastest
