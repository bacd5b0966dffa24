"""Modes of a late system by collocation of its history (Breda, Maset, Vermiglio 2005).

    x'(t) = A_0 x(t) + sum_k A_k x(t - T_k)

The history of x is kept at Chebyshev points, and the eigenvalues of the whole are taken.
"""

import numpy as np

#: of the largest size of a pole: real parts within this are undecided, as both grids must agree
NEAR = 1e-7
#: points of the history: more where two do not agree, as a fast mode turns often in a long history
GRIDS = (30, 60, 90, 135, 200)
#: share within which two grids agree
AGREEMENT = 1e-3


def rightmost_of_two(now, late):
    """Largest real part of the modes by two grids that agree, or the finest; late: as below."""
    before = rightmost(now, late, GRIDS[0])
    size = np.abs(np.linalg.eigvals(now)).max()
    for points in GRIDS[1:]:
        after = rightmost(now, late, points)
        pair = np.array([before, after])
        if abs(after - before) <= AGREEMENT * abs(after) + NEAR * size:
            break
        before = after
    return pair


def rightmost(now, late, points):
    """Largest real part of the modes; late: pairs (matrix, dead time)."""
    n, now = len(now), now + sum((a for a, t in late if not t), np.zeros_like(now))
    late = [(a, t) for a, t in late if t]
    if not late:
        return np.linalg.eigvals(now).real.max()
    longest = max(t for _, t in late)
    x = np.cos(np.pi * np.arange(points + 1) / points)
    ends = np.r_[2, np.ones(points - 1), 2] * (-1.0) ** np.arange(points + 1)
    rates = np.outer(ends, 1 / ends) / (x[:, None] - x + np.eye(points + 1))
    rates -= np.diag(rates.sum(axis=1))
    past = longest * (x - 1) / 2
    whole = np.kron(rates * 2 / longest, np.eye(n))
    whole[:n] = np.kron(np.eye(1, points + 1), now)
    for a, t in late:
        beside = -t - past
        exact = np.abs(beside) < 1e-14 * longest
        share = exact.astype(float) if exact.any() else 1 / (ends * np.where(exact, 1, beside))
        whole[:n] += np.kron(share / share.sum(), a)
    return np.linalg.eigvals(whole).real.max()
