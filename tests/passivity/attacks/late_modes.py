"""Modes of a late system that grow, counted.

By the turns of f(s) = sum_k p_k(s) e^(-s T_k) round all of the right half plane where it can be 0:
however fast a mode and however long a dead time. Each step is so short that no turn is missed: f
does not reach 0 along it, as the largest slope of its terms says.
"""

import numpy as np

#: of f over the sizes of its terms: nearer to zero on the contour a zero lies on it, or none does
ZERO = 1e-9
#: points of a contour: beyond, the turns are too many to be followed
MOST = 200_000


def count_growing(terms):
    """Zeros of f with Re s > 0; None where one lies too near to the axis, or turns are too many.

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
        if (np.abs(f) <= ZERO * size).any() or len(path) > MOST:
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
