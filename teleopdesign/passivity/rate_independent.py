"""Friction that depends on the path, not on the speed, integrated exactly along turning points.

Each element resists motion: `leg` takes the force of the element and a travel of one sign, and
returns the force at the end and the work that the travel puts in. There is no time step, and
rounding is the only error.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from ..arguments import check_types
from ..errors import ModelError

#: share of the energy of a round below which springs that are not yet steady do not matter
_FED = 1e-3


class Element(Protocol):
    """A rate-independent force against the motion, within `level` (N)."""

    @property
    def level(self) -> float:
        """Largest force, N."""
        ...

    def leg(self, force: float, travel: float) -> tuple[float, float]:
        """(force at the end, work put in) of a travel without turning."""
        ...


def _check(element: Element) -> None:
    """ModelError for a number of an element that is no size of a force or stiffness."""
    for name, number in vars(element).items():
        if not 0 < number < math.inf and not (number == 0 and isinstance(element, Coulomb)):
            raise ModelError(f"{type(element).__name__}: {name} = {number:g}, expected above 0")


@check_types
@dataclass(frozen=True)
class Coulomb:
    """Coulomb friction: force = level * sign(velocity);  level: N or N m."""

    level: float

    def __post_init__(self) -> None:
        _check(self)

    def leg(self, force: float, travel: float) -> tuple[float, float]:
        """Force jumps to the level against the travel; all work is lost."""
        return math.copysign(self.level, travel) if travel else force, self.level * abs(travel)


@check_types
@dataclass(frozen=True)
class Dahl:
    """df/dx = stiffness (1 - f/level sgn v): exact over any travel."""

    level: float
    stiffness: float

    def __post_init__(self) -> None:
        _check(self)

    def leg(self, force: float, travel: float) -> tuple[float, float]:
        """f' = s level + (f - s level) e^(-abs(travel)/length), and its integral."""
        if not travel:
            return force, 0.0
        length, s = self.level / self.stiffness, math.copysign(1.0, travel)
        y = abs(travel) / length
        gone = -math.expm1(-y)
        work = self.level * length * _quadratic_remainder(y) + s * force * length * gone
        return force * (1 - gone) + s * self.level * gone, work


@check_types
@dataclass(frozen=True)
class Spring:
    """A spring that slides at its level: a body stuck by Coulomb friction behind a compliance."""

    level: float
    stiffness: float

    def __post_init__(self) -> None:
        _check(self)

    def leg(self, force: float, travel: float) -> tuple[float, float]:
        """Linear up to the level, constant beyond it."""
        if not travel:
            return force, 0.0
        s = math.copysign(1.0, travel)
        stretch = min(abs(travel), (self.level - s * force) / self.stiffness)
        end = force + s * self.stiffness * stretch
        return end, s * (force + end) / 2 * stretch + self.level * (abs(travel) - stretch)


@check_types
@dataclass(frozen=True)
class DahlBehindSpring:
    """A contact of Dahl friction (level, stiffness) that is pulled through a spring.

    With y = 1 - s f/level and r = stiffness/spring a travel x of sign s leads to
    ln y' + r y' = ln y + r y - stiffness abs(x)/level.
    """

    level: float
    stiffness: float
    spring: float

    def __post_init__(self) -> None:
        _check(self)

    def leg(self, force: float, travel: float) -> tuple[float, float]:
        """Exact over any travel, by Wright's omega function."""
        from scipy.special import wrightomega

        if not travel:
            return force, 0.0
        s = math.copysign(1.0, travel)
        y, r = max(1 - s * force / self.level, 1e-300), self.stiffness / self.spring
        x = self.stiffness * abs(travel) / self.level
        after = float(wrightomega(math.log(y) + r * y - x + math.log(r))) / r
        end = s * self.level * (1 - after)
        slipped = x - r * (y - after)  # ln(y/y')
        lost = self.level**2 / self.stiffness * (slipped - (y - after))
        return end, (end**2 - force**2) / (2 * self.spring) + lost


def compliance(element: Element) -> float:
    """Travel per force near rest, m/N."""
    parts = (getattr(element, n, math.inf) for n in ("stiffness", "spring"))
    return float(sum(1 / x for x in parts))


def _quadratic_remainder(y: float) -> float:
    """y - (1 - e^-y), without cancellation where y is small."""
    if y > 0.1:
        return y + math.expm1(-y)
    term, total = y * y / 2, 0.0
    for k in range(3, 16):
        total, term = total + term, -term * y / k
    return total


@dataclass(frozen=True)
class Cycle:
    """A closed path through turning points that releases energy each time, as often as one likes.

    compensator: whose force helps the motion;  friction: what resists
    turning_points: positions, m, of one round, starting at the last of them; from rest and without
    preloads, `rounds` are travelled, and the last one is counted; where that may still be fed by
    what springs held, no more than all rounds together released
    """

    compensator: Dahl
    friction: tuple[Element, ...]
    turning_points: tuple[float, ...]
    rounds: int = 200

    @property
    def energy(self) -> float:
        """Energy released in the last round, J."""
        return self.replay()

    def replay(self) -> float:
        """Energy released in the last round, J, integrated anew."""
        elements: tuple[Element, ...] = (self.compensator, *self.friction)
        forces, here, out = [0.0] * len(elements), self.turning_points[-1], 0.0
        before, total = list(forces), 0.0
        for _ in range(self.rounds):
            before, out = list(forces), 0.0
            for point in self.turning_points:
                for k, element in enumerate(elements):
                    forces[k], work = element.leg(forces[k], point - here)
                    out += work if k == 0 else -work
                here = point
            total += out
            if forces == before:
                break
        fed = sum(
            abs(f - b) * e.level * compliance(e)
            for f, b, e in zip(forces, before, elements, strict=True)
        )
        return out if out <= 0 or fed <= _FED * out else min(out, total)

    def as_dict(self) -> dict[str, object]:
        """Plain data, to be written as JSON."""
        return {
            "kind": "cycle",
            "compensator": _list_entries(self.compensator),
            "friction": [_list_entries(e) for e in self.friction],
            "turning_points": list(self.turning_points),
            "rounds": self.rounds,
            "energy": self.energy,
        }


def _list_entries(element: Element) -> list[object]:
    return [type(element).__name__.lower(), *vars(element).values()]


def symmetric_cycle(compensator: Dahl, friction: Sequence[Element], amplitude: float) -> Cycle:
    """The periodic motion between -amplitude and amplitude (m), once its forces repeat.

    compensator: pushes along the motion;  friction: elements that act against it
    amplitude: m or rad;  returns: the cycle, with its energy per round in J (> 0: released)
    """
    # a cycle of u bristle lengths forgets its start as e^(-4 u): 40 of those are beyond rounding;
    # behind a spring the bristle takes part of the way, and its slip part of the force
    softest = min(
        amplitude / (e.level * e.stiffness * compliance(e) ** 2)
        for e in (compensator, *friction)
        if hasattr(e, "stiffness")
    )
    rounds = int(min(max(12, 10 / softest), 20000))
    return Cycle(compensator, tuple(friction), (amplitude, -amplitude), rounds)


def lost_share(u: float) -> float:
    """1 - tanh(u)/u: part of the level that a cycle of u bristle lengths either way takes."""
    return u * u / 3 * (1 - 0.4 * u * u) if u < 1e-3 else 1 - math.tanh(u) / u


def dahl_loss(level: float, stiffness: float, amplitude: float) -> float:
    """Energy that Dahl friction takes per cycle, J: 4 f A (1 - tanh(u)/u), u = A sigma/f.

    N, N/m;  amplitude: A of a symmetric cycle, m
    """
    return 4 * level * amplitude * lost_share(amplitude * stiffness / level)
