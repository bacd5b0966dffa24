"""Modes of a late system, in two ways.

By collocation of the history of x'(t) = A_0 x(t) + sum_k A_k x(t - T_k) at Chebyshev points (Breda,
Maset, Vermiglio 2005): eigenvalues of the whole, where no mode turns often within the history.

By the turns of f(s) = sum_k p_k(s) e^(-s T_k) round all of the right half plane where it can be 0:
a count of what grows, however fast a mode and however long a dead time. Each step is so short that
no turn is missed: f does not reach 0 along it, as the largest slope of its terms says.
"""

import numpy as np

#: of the largest size of a pole: real parts within this are undecided, as both grids must agree
NEAR = 1e-7
#: points of the history: more where two do not agree, as a fast mode turns often in a long history
GRIDS = (30, 60, 90, 135, 200)
#: share within which two grids agree
AGREEMENT = 1e-3
#: of f over the sizes of its terms: nearer to zero on the contour a zero lies on it, or none does
ZERO = 1e-9


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


def count_growing(terms):
    """Zeros of f with Re s > 0; None where one lies too near to the axis.

    terms: pairs (polynomial, dead time), the first without one and of the highest degree
    """
    together = {}
    for p, time in terms:
        together[time] = np.polyadd(together.get(time, [0.0]), p)
    terms = [(p, time) for time, p in together.items()]
    halves = [_turns(terms)]  # above the real axis; f of complex numbers turns otherwise below it
    if any(np.iscomplexobj(p) for p, _ in terms):
        halves.append(_turns([(np.conj(p), t) for p, t in terms]))
    return None if None in halves else round(sum(halves) / len(halves), 6)


def _turns(terms):
    degree = max(len(p) for p, _ in terms) - 1
    full = [np.pad(p, (degree + 1 - len(p), 0)) for p, _ in terms]
    lead = abs(full[0][0]) - sum(abs(p[0]) for p in full[1:])
    if lead <= 1e-6 * abs(full[0][0]):
        return np.inf  # a chain of zeros along the axis
    others = sum(np.abs(p[1:]) for p in full)
    radius = 1.0
    while lead * radius**degree < 2 * np.polyval(others, radius):
        radius *= 2
    # up the axis from 0, then along the arc to the real axis
    arc = 1.5 * radius * np.exp(1j * np.linspace(np.pi / 2, 0, 100))
    path = np.concatenate([[0], 1.5j * radius * np.geomspace(1e-5, 1, 200), arc[1:]])

    def values(s):
        """f, the sizes of its terms, and the largest slope nearer to 0 than s."""
        late = [np.exp(-s * t) for _, t in terms]
        sizes = [np.polyval(np.abs(p), np.abs(s)) for p, _ in terms]
        slopes = (np.polyval(np.polyder(np.abs(p)), np.abs(s)) for p, _ in terms)
        slope = sum(x + t * size for x, size, (_, t) in zip(slopes, sizes, terms, strict=True))
        size = sum(x * np.abs(e) for x, e in zip(sizes, late, strict=True))
        return sum(np.polyval(p, s) * e for (p, _), e in zip(terms, late, strict=True)), size, slope

    f, size, slope = values(path)
    for _ in range(40):
        if (np.abs(f) <= ZERO * size).any():
            return None
        steepest = np.maximum(slope[1:], slope[:-1])
        wide = np.flatnonzero(steepest * np.abs(np.diff(path)) > np.abs(f[1:]) + np.abs(f[:-1]))
        if not len(wide):
            return -np.angle(f[1:] / f[:-1]).sum() / np.pi
        between = (path[wide] + path[wide + 1]) / 2
        new = values(between)
        path = np.insert(path, wide + 1, between)
        f, size, slope = (
            np.insert(old, wide + 1, x) for old, x in zip((f, size, slope), new, strict=True)
        )
    return None
