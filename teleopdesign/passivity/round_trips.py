"""Periodic motions between two points: the energy that each round trip releases, exactly.

If friction dissipates less in a round trip than a compensator supplies, energy comes out in each
round, forever. A grid of forces, as of `available_storage`, cannot resolve trips that are short
compared with its cells.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .rate_independent import Coulomb, Dahl, Element, compliance

#: range of the strokes: the shortest over the shortest length of a force, the longest over the
#: longest length. Below this range all forces are springs, above it all forces slide
_SHORTER, _LONGER = 1e-3, 1e2
#: strokes that are evaluated in each decade, before the best are refined
_PER_DECADE = 24
#: number of strokes that are refined: those that release most
_REFINED = 3
#: released energy, as a share of the energy that the compensator supplies, that may be rounding
_ROUNDING = 1e-9


def repeated_force(element: Element, stroke: float) -> float:
    """Force f (N) at the ends of a stroke (m) back and forth that repeats: from -f to f."""
    from scipy.optimize import brentq

    def beyond(force: float) -> float:
        return element.leg(-force, stroke)[0] - force

    if beyond(element.level) >= 0:  # it slides
        return element.level
    return float(brentq(beyond, 0.0, element.level, xtol=1e-15 * element.level, rtol=1e-14))


def loss_per_stroke(element: Element, stroke: float) -> float:
    """Energy (J) that an element takes in each stroke (m) back and forth, after the transient."""
    return element.leg(-repeated_force(element, stroke), stroke)[1]


def most_released(
    compensator: Dahl, friction: Sequence[Element], load_coefficient: float = 0.0
) -> tuple[float, float]:
    """Most energy per travel that a round trip releases forever, and its stroke.

    compensator: its force helps the motion;  friction: elements that resist
    load_coefficient: the first element of friction grows by this factor times the size of the force
        of the last element
    returns: energy per travel, N, and stroke, m; 0 N where friction takes at least as much as the
        compensator supplies, at every stroke
    """
    from scipy.optimize import minimize_scalar

    def given_out(logarithm: float) -> float:
        stroke = float(np.exp(logarithm))
        takes = sum(loss_per_stroke(e, stroke) for e in friction)
        if load_coefficient:
            takes += load_coefficient * _integral_of_size(friction[-1], stroke)
        return (loss_per_stroke(compensator, stroke) - takes) / stroke

    forces = [e for e in (compensator, *friction) if not isinstance(e, Coulomb)]
    lengths = [e.level * compliance(e) for e in forces]
    first, last = np.log(_SHORTER * min(lengths)), np.log(_LONGER * max(lengths))
    count = int((last - first) / np.log(10) * _PER_DECADE)
    # springs begin to slide at twice their length, where what they take has a kink
    kinks = np.log(2 * np.array(lengths))
    strokes = np.sort(np.concatenate([np.linspace(first, last, count), kinks]))
    values = np.array([given_out(x) for x in strokes])
    inner = 1 + np.flatnonzero((values[1:-1] >= values[:-2]) & (values[1:-1] >= values[2:]))
    best = max(zip(values, strokes, strict=True))
    for k in inner[np.argsort(values[inner])[-_REFINED:]]:
        bounds = (strokes[k - 1], strokes[k + 1])
        peak = minimize_scalar(lambda x: -given_out(x), bounds=bounds, method="bounded")
        best = max(best, (-float(peak.fun), float(peak.x)))
    released, stroke = float(best[0]), float(np.exp(best[1]))
    gives = loss_per_stroke(compensator, stroke) / stroke
    return (released if released > _ROUNDING * gives else 0.0), stroke


def _integral_of_size(element: Element, stroke: float) -> float:
    """Integral (N m) of the size of a force over one stroke (m) of a round trip that repeats."""
    from scipy.optimize import brentq

    force = repeated_force(element, stroke)
    if type(element) is Coulomb or force <= 0:
        return force * stroke
    turn = brentq(lambda x: element.leg(-force, x)[0], 0.0, stroke, rtol=1e-14)
    back = element.leg(-force, turn)[1]
    return element.leg(-force, stroke)[1] - 2 * back
