"""A sum of late polynomials over a box: shown to be nowhere zero on the axis, part by part.

About the middle m of a part, with half widths r, a monomial moves by at most (abs(m) + r)^a -
abs(m)^a, and e^(-j w tau) by at most the change of w tau. So f(jw) is not zero in a part where
abs(f) in its middle is more than the sum of these. Parts that do not show it are halved, along the
variable that moves f most.

Computed in floating point: one value is a sum of some hundred products, each wrong by less than
1e-14 of its size, sine and cosine by less than 1e-15. `_ROUNDING` of the sum of all sizes is more.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: of the sum of the sizes of all terms
_ROUNDING = 1e-11
#: parts that are looked at in all: some seconds on one core
_MOST_PARTS = 400_000
#: halves of the range of w that are made before any part is looked at
_FIRST = 64


@dataclass(frozen=True)
class LateTerms:
    """f(s) = sum of coefficient * s^k * values^a * e^(-s sum b T).

    coefficients: (m,);  powers: (m, 1 + values + times), k, a and b
    values: (values, 2), intervals;  times: (times, 2), of which the second is the largest, s
    places, late: where in a point of the box each value and time stands; -1: it is fixed
    """

    coefficients: np.ndarray
    powers: np.ndarray
    values: np.ndarray
    times: np.ndarray
    places: tuple[int, ...]
    late: tuple[int, ...]

    def at(self, point: np.ndarray) -> dict[float, np.ndarray]:
        """Dead time -> coefficients in s, highest first, at a point of the box."""
        values = np.array([point[i] for i in self.places])
        times = np.array(
            [point[i] if i >= 0 else t for i, (_, t) in zip(self.late, self.times, strict=True)]
        )
        n, degree = len(values), int(self.powers[:, 0].max())
        sizes = self.coefficients * np.prod(values ** self.powers[:, 1 : 1 + n], axis=1)
        by_time: dict[float, np.ndarray] = {}
        for k, late, size in zip(
            self.powers[:, 0], self.powers[:, 1 + n :] @ times, sizes, strict=True
        ):
            by_time.setdefault(float(late), np.zeros(degree + 1))[degree - k] += size
        trimmed = {t: np.trim_zeros(p, "f") for t, p in sorted(by_time.items())}
        return {t: p for t, p in trimmed.items() if len(p)}

    def groups(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """(b, which terms) for each late factor; that without dead time first."""
        late = self.powers[:, 1 + len(self.values) :]
        kinds = np.unique(late, axis=0)
        kinds = kinds[np.argsort(kinds.sum(axis=1), kind="stable")]
        return [(b, np.flatnonzero((late == b).all(axis=1))) for b in kinds]


def is_zero_free(terms: LateTerms, *, most: int = _MOST_PARTS) -> int | None:
    """How many parts show that f(jw) is nowhere zero, T from 0 on; None: it is not shown.

    most: parts that are looked at
    """
    groups = terms.groups()
    if groups[0][0].any():
        return None  # every term is late: dead times may be taken off, which is not done here
    fastest = _find_fastest(terms)
    late = np.array([[0.0, high] for _, high in terms.times])
    total = 0
    ranges = (np.array([0.0, 1 / fastest]), np.array([0.0, fastest]))
    for outside, frequency in zip((True, False), ranges, strict=True):
        ends = np.vstack([frequency, terms.values, late[: 0 if outside else None]])
        parts = _show(terms, ends, outside, most - total)
        if parts is None:
            return None
        total += parts
    return total


def _show(terms: LateTerms, ends: np.ndarray, outside: bool, most: int) -> int | None:
    """Parts that it takes; outside: the first variable is 1/w."""
    edges = np.linspace(ends[0, 0], ends[0, 1], _FIRST + 1)
    middle = np.tile(ends.mean(axis=1), (_FIRST, 1))
    # 1e-12: ends and halves are rounded
    half = np.tile(np.diff(ends)[:, 0] / 2, (_FIRST, 1)) * (1 + 1e-12) + 1e-15 * np.abs(middle)
    middle[:, 0], half[:, 0] = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2 * (1 + 1e-9)
    total = 0
    while len(middle):
        total += len(middle)
        if total > most:
            return None
        left = ~_holds(terms, middle, half, outside)
        middle, half = middle[left], half[left]
        if not len(middle):
            break
        axis = np.argmax(_moves(terms, middle, half, outside), axis=1)
        rows = np.arange(len(middle))
        step = np.zeros_like(middle)
        step[rows, axis] = half[rows, axis] / 2
        half[rows, axis] *= 0.5 * (1 + 1e-12)
        middle = np.concatenate([middle - step, middle + step])
        half = np.concatenate([half, half])
    return total


def _moves(terms: LateTerms, middle: np.ndarray, half: np.ndarray, outside: bool) -> np.ndarray:
    """How much each variable alone moves f in each part, (parts, variables)."""
    alone = [np.where(np.arange(half.shape[1]) == i, half, 0.0) for i in range(half.shape[1])]
    return np.stack([_sizes(terms, middle, one, outside)[1].sum(axis=0) for one in alone], axis=1)


def _holds(terms: LateTerms, middle: np.ndarray, half: np.ndarray, outside: bool) -> np.ndarray:
    value, moved, sizes = _sizes(terms, middle, half, outside)
    slack = _ROUNDING * sizes
    if not outside:
        return np.asarray(np.abs(value.sum(axis=0)) > moved.sum(axis=0) * (1 + 1e-9) + slack)
    others = np.abs(value[1:]).sum(axis=0)
    return np.asarray(np.abs(value[0]) > others + moved.sum(axis=0) * (1 + 1e-9) + slack)


def _sizes(
    terms: LateTerms, middle: np.ndarray, half: np.ndarray, outside: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Value and largest move of each late factor's share, (groups, parts), and size of all terms.

    outside: of f/w^n over 1/w, without the late factors
    """
    n, degree = len(terms.values), int(terms.powers[:, 0].max())
    w, times = middle[:, 0], middle[:, 1 + n :]
    values, moves, total, turned = [], [], np.zeros(len(middle)), np.zeros(len(middle))
    for b, which in terms.groups():
        powers = terms.powers[which, : 1 + n].copy()
        turn = 1j ** (powers[:, 0] % 4)
        if outside:
            powers[:, 0] = degree - powers[:, 0]
        c = terms.coefficients[which]
        here = _monomials(middle[:, : 1 + n], powers)
        size = np.abs(here) @ np.abs(c)
        most = _monomials(np.abs(middle[:, : 1 + n]) + half[:, : 1 + n], powers) @ np.abs(c)
        value, move = here @ (c * turn), most - size
        if not outside:
            angle = w * (times @ b)
            value = value * np.exp(-1j * angle)
            most_angle = (w + half[:, 0]) * ((times + half[:, 1 + n :]) @ b)
            further, turned = most_angle - angle, np.maximum(turned, most_angle)
            move = move + np.abs(value) * np.minimum(further, 2.0)
        values.append(value)
        moves.append(move)
        total += most
    # an angle is wrong by less than 1e-15 of itself
    return np.array(values), np.array(moves), total * (1 + 1e-4 * turned)


def _monomials(points: np.ndarray, powers: np.ndarray) -> np.ndarray:
    """(parts, terms)."""
    out = np.ones((len(points), len(powers)))
    for i in range(points.shape[1]):
        table = points[:, i, None] ** np.arange(powers[:, i].max() + 1)
        out = out * table[:, powers[:, i]]
    return out


def _find_fastest(terms: LateTerms) -> float:
    """A frequency beyond which the first polynomial outweighs the others, rad/s; by samples."""
    low, high = terms.values.T if len(terms.values) else (np.zeros(0), np.zeros(0))
    points = np.array([low, high, (low + high) / 2])
    w = np.geomspace(1e-6, 1e9, 1501)
    fastest = 1e-6
    n, degree = len(terms.values), int(terms.powers[:, 0].max())
    far = w > 1e8
    for point in points:
        here = np.column_stack([w, np.tile(point, (len(w), 1))])
        size = np.array(
            [
                np.abs(
                    _monomials(here, terms.powers[which, : 1 + n])
                    @ (terms.coefficients[which] * 1j ** (terms.powers[which, 0] % 4))
                )
                for _, which in terms.groups()
            ]
        )
        ratio = size[1:].sum(axis=0) / np.maximum(size[0], 1e-300)
        limit = 0.5 + 0.5 * float(np.min(ratio[far]))
        above = np.flatnonzero(ratio > limit)
        fastest = max(fastest, float(w[above[-1]]) if len(above) else 0.0)
        # p_0 is to be in its asymptote, where 1/w tells little
        steep = np.abs(size[0] / np.maximum(size[0, -1] * (w / w[-1]) ** degree, 1e-300) - 1) > 0.5
        fastest = max(fastest, float(w[np.flatnonzero(steep)[-1]]) if steep.any() else 0.0)
    return 1.2 * fastest
