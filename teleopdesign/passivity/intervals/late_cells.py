"""Show that a quasi-polynomial with dead times has no zero on the axis, for all values of a box.

The box is divided into parts. Within a part with middle m and half widths r, a monomial changes by
at most (abs(m) + r)^a - abs(m)^a, and e^(-j w tau) changes by at most the change of w tau. So f(jw)
is not zero in a part where abs(f) in the middle is larger than the sum of these changes. A part for
which this is not so is halved along the variable that changes f most.

Parts are stored by their ends, so no gap remains between two halves. Each part is first tested in
plain floats. A part that passes is tested again in floats that are rounded outward (`outward`),
including coefficients and ends of intervals. So all rounding is covered, and no sine or exponential
of a library is trusted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .late_terms import LateTerms
from .outward import Outward, cosine_and_sine, least_size, most_size, next_above, stack, sum_above

#: most parts that are tested: some ten seconds on one core
_MOST_PARTS = 400_000
#: parts of the range of w at the start
_FIRST = 64
#: most numbers in one array of parts and terms, 8 MiB: more parts are tested in several arrays
_MOST_NUMBERS = 1_000_000


@dataclass(frozen=True)
class _Group:
    """Terms that share one late factor e^(-s sum b T).

    late: b;  powers: of s (of 1/w where `outside`) and of the values, (terms, 1 + values)
    real, imaginary: indices of the terms in the real and in the imaginary part of f(jw)
    turned: coefficients with the sign of j^k, without the factor j
    """

    late: np.ndarray
    powers: np.ndarray
    real: np.ndarray
    imaginary: np.ndarray
    turned: Outward


def is_zero_free(terms: LateTerms, *, most: int = _MOST_PARTS) -> int | None:
    """Number of parts that show that f(jw) is nowhere zero, for all dead times from 0 on.

    most: largest number of parts
    returns: None where nothing is shown
    """
    if terms.groups()[0][0].any():
        return None  # every term is late: dead times may be taken off, which is not done here
    fastest = _find_fastest(terms)
    values, longest = Outward.about_pairs(terms.values), _longest(terms)
    total = 0
    # from `fastest` on, infinity included, over 1/w
    ranges = (float(next_above(np.array(1 / fastest))), fastest)
    for outside, end in zip((True, False), ranges, strict=True):
        times = np.zeros(0) if outside else longest
        low = np.concatenate([[0.0], values.low, 0 * times])
        high = np.concatenate([[end], values.high, times])
        # beyond the range of floats nothing is shown
        with np.errstate(all="ignore"):
            parts = _show(_groups(terms, outside), low, high, outside, most - total)
        if parts is None:
            return None
        total += parts
    return total


def _longest(terms: LateTerms) -> np.ndarray:
    return Outward.about([longest for _, longest in terms.times]).high


def _groups(terms: LateTerms, outside: bool) -> list[_Group]:
    largest = max(abs(c) for c in terms.coefficients)
    made = []
    for b, which in terms.groups():
        powers = terms.powers[which, : 1 + len(terms.values)].copy()
        k = powers[:, 0].copy()
        signs = np.where(k % 4 < 2, 1, -1).tolist()
        chosen = [terms.coefficients[i] for i in which]
        turned = Outward.about(c / largest * s for c, s in zip(chosen, signs, strict=True))
        if outside:
            powers[:, 0] = terms.degree - k
        made.append(
            _Group(b, powers, np.flatnonzero(k % 2 == 0), np.flatnonzero(k % 2 == 1), turned)
        )
    return made


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
        if total > most:
            return None
        left = ~_hold(groups, lows, highs, outside)
        lows, highs = lows[left], highs[left]
        middle = lows + (highs - lows) / 2
        axis = np.argmax(_moves(groups, middle, highs - middle, outside), axis=1)
        rows = np.arange(len(lows))
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
    value, moved = _in_floats(groups, middle, high - middle, outside)
    if outside:
        shown = np.abs(value[0]) > np.abs(value[1:]).sum(axis=0) + moved.sum(axis=0)
    else:
        shown = np.abs(value.sum(axis=0)) > moved.sum(axis=0)
    candidates = np.flatnonzero(shown)
    share = max(_MOST_NUMBERS // max(len(g.powers) for g in groups), 1)
    for start in range(0, len(candidates), share):
        some = candidates[start : start + share]
        shown[some] = _is_shown(groups, low[some], high[some], outside)
    return np.asarray(shown)


def _is_shown(
    groups: Sequence[_Group], low: np.ndarray, high: np.ndarray, outside: bool
) -> np.ndarray:
    """As `_hold`, but with intervals that are rounded outward."""
    middle, half = Outward(low, high).middle()
    n = groups[0].powers.shape[1]
    values, moves = [], []
    for group in groups:
        (real, imaginary), move = _polynomial(group, middle[:, :n], half[:, :n])
        if not outside:
            angle, further = _angle(group.late, middle, half)
            cosine, sine = cosine_and_sine(-angle)
            size = most_size(real, imaginary)
            move = next_above(move + next_above(size * np.minimum(further, 2.0)))
            real, imaginary = (
                real * cosine - imaginary * sine,
                real * sine + imaginary * cosine,
            )
        values.append((real, imaginary))
        moves.append(move)
    if outside:
        moves += [most_size(*value) for value in values[1:]]
        least = least_size(*values[0])
    else:
        least = least_size(*(stack(side).total() for side in zip(*values, strict=True)))
    return np.asarray(least > sum_above(np.stack(moves, axis=-1)))


def _polynomial(
    group: _Group, middle: np.ndarray, half: np.ndarray
) -> tuple[tuple[Outward, Outward], np.ndarray]:
    """Real and imaginary part of a group in the middle of parts, and a bound of their change."""
    exact = Outward.exactly(np.ones((len(middle), len(group.powers))))
    most = exact.high
    for i in range(middle.shape[1]):
        powers, degree = group.powers[:, i], int(group.powers[:, i].max())
        table = [Outward.exactly(np.ones(len(middle)))]
        size, sizes = next_above(np.abs(middle[:, i]) + half[:, i]), [np.ones(len(middle))]
        for _ in range(degree):
            table.append(table[-1] * Outward.exactly(middle[:, i]))
            sizes.append(next_above(sizes[-1] * size))
        if degree:
            exact = exact * stack(table)[:, powers]
            most = next_above(most * np.stack(sizes, axis=-1)[:, powers])
    terms = exact * group.turned
    parts = terms[:, group.real].total(), terms[:, group.imaginary].total()
    upper = sum_above(next_above(most * group.turned.largest()))
    lower = -sum_above(-terms.smallest())
    return parts, np.maximum(next_above(upper - lower), 0.0)


def _angle(late: np.ndarray, middle: np.ndarray, half: np.ndarray) -> tuple[Outward, np.ndarray]:
    """w tau in the middle of parts, rad, and a bound of its increase within the part."""
    first = middle.shape[1] - len(late)
    factors = Outward.exactly(late.astype(float))
    longest = next_above(middle[:, first:] + half[:, first:])
    time = (Outward.exactly(middle[:, first:]) * factors).total()
    angle = Outward.exactly(middle[:, 0]) * time
    most = next_above(next_above(middle[:, 0] + half[:, 0]) * sum_above(next_above(longest * late)))
    return angle, next_above(most - angle.low)


def _moves(
    groups: Sequence[_Group], middle: np.ndarray, half: np.ndarray, outside: bool
) -> np.ndarray:
    """Bound of the change of f by each variable alone in each part, (parts, variables)."""
    alone = [np.where(np.arange(half.shape[1]) == i, half, 0.0) for i in range(half.shape[1])]
    return np.stack(
        [_in_floats(groups, middle, one, outside)[1].sum(axis=0) for one in alone], axis=1
    )


def _in_floats(
    groups: Sequence[_Group], middle: np.ndarray, half: np.ndarray, outside: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Value in the middle and bound of the change of each group, (groups, parts); in plain floats.

    outside: of f/w^n over 1/w, without the late factors
    """
    n = groups[0].powers.shape[1]
    values, moves = [], []
    for group in groups:
        c = group.turned.high
        here = _monomials(middle[:, :n], group.powers)
        sizes = np.abs(c)
        most = _monomials(np.abs(middle[:, :n]) + half[:, :n], group.powers) @ sizes
        move = most - np.abs(here) @ sizes
        parts = [here[:, which] @ c[which] for which in (group.real, group.imaginary)]
        value = parts[0] + 1j * parts[1]
        if not outside:
            angle = middle[:, 0] * (middle[:, n:] @ group.late)
            further = (middle[:, 0] + half[:, 0]) * ((middle + half)[:, n:] @ group.late) - angle
            value = value * np.exp(-1j * angle)
            move = move + np.abs(value) * np.minimum(further, 2.0)
        values.append(value)
        moves.append(move)
    return np.array(values), np.array(moves)


def _monomials(points: np.ndarray, powers: np.ndarray) -> np.ndarray:
    """Values of monomials at points, (parts, terms)."""
    out = np.ones((len(points), len(powers)))
    for i in range(points.shape[1]):
        table = points[:, i, None] ** np.arange(powers[:, i].max() + 1)
        out = out * table[:, powers[:, i]]
    return out


def _find_fastest(terms: LateTerms) -> float:
    """A frequency, rad/s, above which the first polynomial is larger than the others together.

    The choice is by samples. `is_zero_free` then tests all frequencies above it.
    """
    ends = np.array([[float(a), float(b)] for a, b in terms.values]).reshape(-1, 2)
    w = np.geomspace(1e-6, 1e9, 1501)
    fastest, far = 1e-6, w > 1e8
    groups = _groups(terms, False)
    for point in (ends[:, 0], ends[:, 1], ends.mean(axis=1)):
        here = np.column_stack([w, np.tile(point, (len(w), 1))])
        size = np.abs([_on_axis(group, here) for group in groups])
        ratio = size[1:].sum(axis=0) / np.maximum(size[0], 1e-300)
        limit = 0.5 + 0.5 * float(np.min(ratio[far]))
        above_limit = np.flatnonzero(ratio > limit)
        fastest = max(fastest, float(w[above_limit[-1]]) if len(above_limit) else 0.0)
        # p_0 is to be in its asymptote, where 1/w tells little
        lead = np.maximum(size[0, -1] * (w / w[-1]) ** terms.degree, 1e-300)
        steep = np.flatnonzero(np.abs(size[0] / lead - 1) > 0.5)
        fastest = max(fastest, float(w[steep[-1]]) if len(steep) else 0.0)
    return 1.2 * fastest


def _on_axis(group: _Group, points: np.ndarray) -> np.ndarray:
    """Values of a group on the axis without its late factor, in floats; points: w and values."""
    here = _monomials(points, group.powers) * group.turned.high
    return np.asarray(here[:, group.real].sum(axis=1) + 1j * here[:, group.imaginary].sum(axis=1))
