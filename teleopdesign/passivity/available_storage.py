"""Available storage of path-dependent friction: the most energy that any motion can release.

Willems: a system is passive from rest if its available storage is finite, and then the available
storage is a storage function. If friction depends on the path alone, every motion is a sequence of
small travels forward or back. So the available storage V, a function of the forces x, solves

    V(x) = max(0, max over both directions of (released over the travel + V(x after it)))

V is iterated on a grid of the forces, with linear interpolation. Where the iteration converges, a
storage function is known numerically. Where V grows without end, energy comes out or the grid is
too coarse, because interpolation lies above a convex V. Where V is concave, interpolation lies
below it and may hide the energy of short trips. So round trips of every length are checked without
a grid. Either result is evidence.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ModelError
from ..base.frozen import ByValue
from .claims.claim import Evidence
from .rate_independent import AbstractElement, Coulomb, Dahl, compliance

Array = NDArray[np.float64]
#: growth of the storage per travel, as a share of the compensator's level, that counts as none
_BLUR = 1e-3
#: growth over the second half of the moves, as a share of the storage, that counts as none: about
#: the error of interpolation on a grid of 25 points. A smaller share needs more moves near a limit
_STILL_GROWING = 2e-3
#: most moves, and most nodes times moves: at 50 us a move and 50 ns a node they take some 20 s
_MOST_MOVES, _MOST_WORK = 400_000, 500_000_000


@dataclass(frozen=True, eq=False)
class AvailableStorage(ByValue):
    """Available storage of friction with a compensator, on a grid of their forces; numerical.

    storage: most energy that a motion can release, J; an axis for each force with a state, the
        compensator first, from -level to level
    gain: growth of the storage per travel over the second half of the moves, N
    travel: of one move, m;  moves: number of moves
    tolerance: gain that counts as zero, N
    growth: largest increase of the storage over the second half of the moves, J
    coarse: largest storage on a grid of half the points, J. Its difference from the largest
        storage is about the error of the grid, to either side; more points lower this error
    round_trip: most energy per travel that a round trip between two points releases forever, N
    stroke: of that round trip, m
    """

    storage: Array
    gain: float
    travel: float
    moves: int
    tolerance: float
    growth: float
    coarse: float
    round_trip: float = 0.0
    stroke: float = 0.0

    @property
    def is_finite(self) -> bool:
        """Whether the storage has stopped growing, within the tolerance of the grid.

        The growth over the second half of the moves is a small share of the storage, and no round
        trip releases energy forever.
        """
        still = _STILL_GROWING * float(self.storage.max()) + self.tolerance * self.travel
        return self.gain <= self.tolerance and self.growth <= still and not self.round_trip

    def evidence(self) -> Evidence:
        """The result as the verdict of a claim; margin in N."""
        axes = " x ".join(map(str, self.storage.shape))
        searched = (
            f"available storage iterated over {self.moves} moves on a grid of {axes} forces, to "
            f"{self.storage.max():.3g} J ({self.coarse:.3g} J on half the points)"
        )
        if self.round_trip:
            searched += (
                f"; strokes of {self.stroke:.3g} m forth and back release {self.round_trip:.3g} N "
                "times their travel"
            )
        elif self.gain <= self.tolerance and not self.is_finite:
            searched += f" and still growing, by {self.growth:.2g} J over the second half of them"
        margin = -self.round_trip if self.round_trip else self.tolerance - self.gain
        return Evidence(self.is_finite, searched, margin, "N")


def available_storage(
    compensator: Dahl,
    friction: Sequence[AbstractElement],
    *,
    points: int = 61,
    moves: int | None = None,
    load_coefficient: float = 0.0,
) -> AvailableStorage:
    """Available storage of friction with a Dahl compensator, by iteration on a grid of forces.

    friction: elements that resist; each has a state, except Coulomb friction
    points: of the grid along each force
    moves: number of moves; default: six strokes of the softest element, both ways
    load_coefficient: the first element of friction grows by this factor times the size of the force
        of the last element (capstan: the tension of a cable presses a contact)
    raises ModelError: more than three forces with a state, lengths too far apart for one grid,
        fewer than 3 points or 1 move, or a negative load
    """
    stateful: list[AbstractElement] = [
        compensator,
        *(e for e in friction if not isinstance(e, Coulomb)),
    ]
    if points < 3 or (moves is not None and moves < 1) or load_coefficient < 0:
        raise ModelError(
            f"available_storage: expected 3 points, 1 move and a load of 0 at least, found "
            f"{points}, {moves} and {load_coefficient:g}"
        )
    if len(stateful) > 3:
        raise ModelError(f"available_storage: at most 3 forces with a state, found {len(stateful)}")
    # travel over which the force of an element changes by about its level, m
    lengths = [e.level * compliance(e) for e in stateful]
    # two cells of the stiffest force's grid: shorter moves would only be blurred by interpolation
    travel = 4 * min(lengths) / (points - 1)
    moves = moves or int(24 * max(lengths) / travel) + 10 * points
    nodes = points ** len(stateful)
    if moves > _MOST_MOVES or moves * nodes > _MOST_WORK:
        raise ModelError(
            f"available_storage: {moves} moves on {nodes} nodes would take minutes: the longest of "
            f"the forces' lengths is {max(lengths) / min(lengths):.3g} times the shortest; use "
            "fewer points, or leave out what gives a thousand times less than the rest"
        )
    fine, growth = _iterate(stateful, friction, points, travel, moves, load_coefficient)
    half = points // 2 + 1
    longer = travel * (points - 1) / (half - 1)
    coarse, _ = _iterate(stateful, friction, half, longer, -(-moves // 2), load_coefficient)
    gain = growth / (travel * (moves - moves // 2))
    tolerance = _BLUR * compensator.level
    round_trip, stroke = most_released(compensator, friction, load_coefficient)
    return AvailableStorage(
        fine, gain, travel, moves, tolerance, growth, float(coarse.max()), round_trip, stroke
    )


def _iterate(
    stateful: Sequence[AbstractElement],
    friction: Sequence[AbstractElement],
    points: int,
    travel: float,
    moves: int,
    load: float,
) -> tuple[Array, float]:
    """Storage after so many moves, J, and its largest gain over the second half of them, J."""
    step = [_move(stateful, friction, s * travel, points=points, load=load) for s in (1, -1)]
    # iterated is V less what springs hold, which interpolation would blur most
    held = _stored_energy(stateful, points)
    v = half = -held
    for n in range(moves):
        if n == moves // 2:
            half = v
        v = np.maximum(-held, np.maximum(step[0](v), step[1](v)))
    return v + held, float((v - half).max())


def _stored_energy(stateful: Sequence[AbstractElement], points: int) -> Array:
    """Energy in the springs of friction less that in the compensator's, at each node, J."""
    halves = [compliance(e) / 2 * np.linspace(-e.level, e.level, points) ** 2 for e in stateful]
    helped, *held = np.meshgrid(*halves, indexing="ij", sparse=True)
    return np.asarray(sum(held, -helped))


def _move(
    stateful: Sequence[AbstractElement],
    friction: Sequence[AbstractElement],
    travel: float,
    *,
    points: int,
    load: float,
) -> Callable[[Array], Array]:
    """One travel (m, with sign) as a map from the storage after it to the storage before it."""
    gain: Array = np.zeros((1,) * len(stateful))
    cells = []
    for axis, element in enumerate(stateful):
        forces = np.linspace(-element.level, element.level, points)
        legs = np.array([element.leg(float(f), travel) for f in forces])
        shape = [points if k == axis else 1 for k in range(len(stateful))]
        lost = legs[:, 1] - (legs[:, 0] ** 2 - forces**2) * compliance(element) / 2
        gain = gain + (lost if axis == 0 else -lost).reshape(shape)
        # the left neighbouring node, and the weight of the right one
        place = (legs[:, 0] - forces[0]) / (forces[1] - forces[0])
        place = np.clip(place, 0, points - 1)
        left = np.minimum(place.astype(np.intp), points - 2)
        cells.append((left, (place - left).reshape(shape)))
        if load and axis == len(stateful) - 1:
            pressed = load * np.abs(forces + legs[:, 0]) / 2 * abs(travel)
            gain = gain - pressed.reshape(shape)
    gain = gain - sum(e.leg(0.0, travel)[1] for e in friction if isinstance(e, Coulomb))

    def before(after: Array) -> Array:
        moved = after
        for axis, (left, right_share) in enumerate(cells):
            low, high = np.take(moved, left, axis), np.take(moved, left + 1, axis)
            moved = low + right_share * (high - low)
        return np.asarray(gain + moved)

    return before


#: range of the strokes: the shortest over the shortest length of a force, the longest over the
#: longest length. Below this range all forces are springs, above it all forces slide
_SHORTER, _LONGER = 1e-3, 1e2
#: strokes that are evaluated in each decade, before the best are refined
_PER_DECADE = 24
#: number of strokes that are refined: those that release most
_REFINED = 3
#: released energy, as a share of the energy that the compensator supplies, that may be rounding
_ROUNDING = 1e-9


def repeated_force(element: AbstractElement, stroke: float) -> float:
    """Force f (N) at the ends of a stroke (m) back and forth that repeats: from -f to f."""
    from scipy.optimize import brentq

    def beyond(force: float) -> float:
        return element.leg(-force, stroke)[0] - force

    if beyond(element.level) >= 0:  # it slides
        return element.level
    return float(brentq(beyond, 0.0, element.level, xtol=1e-15 * element.level, rtol=1e-14))


def loss_per_stroke(element: AbstractElement, stroke: float) -> float:
    """Energy (J) that an element takes in each stroke (m) back and forth, after the transient."""
    return element.leg(-repeated_force(element, stroke), stroke)[1]


def most_released(
    compensator: Dahl, friction: Sequence[AbstractElement], load_coefficient: float = 0.0
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


def _integral_of_size(element: AbstractElement, stroke: float) -> float:
    """Integral (N m) of the size of a force over one stroke (m) of a round trip that repeats."""
    from scipy.optimize import brentq

    force = repeated_force(element, stroke)
    if type(element) is Coulomb or force <= 0:
        return force * stroke
    turn = brentq(lambda x: element.leg(-force, x)[0], 0.0, stroke, rtol=1e-14)
    back = element.leg(-force, turn)[1]
    return element.leg(-force, stroke)[1] - 2 * back
