"""Friction that depends on the path and not on the speed, integrated exactly along a path.

Each element resists motion. `leg` takes the force of the element and a travel without turning, and
returns the force at the end and the work that the travel puts in. There is no time step, and
rounding is the only error.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar, TypeVar

import numpy as np
import sympy as sp

from ..base.arguments import check_types
from ..base.errors import ModelError

#: energy that springs still lend to a round, as a share of the energy of this round, that is
#: neglected
_FED = 1e-3


@dataclass(frozen=True)
class AbstractElement(ABC):
    """A rate-independent force against the motion.

    level: largest force, N
    raises ModelError: a level or stiffness that is not > 0 and finite; Coulomb friction may be 0
    """

    level: float

    def __post_init__(self) -> None:
        for name, number in vars(self).items():
            if not 0 < number < math.inf and not (number == 0 and isinstance(self, Coulomb)):
                raise ModelError(f"{type(self).__name__}: {name} = {number:g}, expected above 0")

    @abstractmethod
    def leg(self, force: float, travel: float) -> tuple[float, float]:
        """(force at the end, N; work put in, J) of a travel (m, with sign) without turning.

        force: at the begin, N
        """


@check_types
@dataclass(frozen=True)
class Coulomb(AbstractElement):
    """Coulomb friction: force = level * sign(velocity); level: N or N m, >= 0."""

    def leg(self, force: float, travel: float) -> tuple[float, float]:
        """The force jumps to the level against the travel; all work is lost."""
        return math.copysign(self.level, travel) if travel else force, self.level * abs(travel)


@check_types
@dataclass(frozen=True)
class Dahl(AbstractElement):
    """Dahl friction: df/dx = stiffness (1 - f/level sgn v), exact over any travel; N, N/m."""

    stiffness: float

    def leg(self, force: float, travel: float) -> tuple[float, float]:
        """Exact: f' = s level + (f - s level) e^(-abs(travel)/length), and its integral.

        s: sign of the travel;  length: level/stiffness
        """
        if not travel:
            return force, 0.0
        length, s = self.level / self.stiffness, math.copysign(1.0, travel)
        y = abs(travel) / length
        gone = -math.expm1(-y)
        work = self.level * length * _quadratic_remainder(y) + s * force * length * gone
        return force * (1 - gone) + s * self.level * gone, work


@check_types
@dataclass(frozen=True)
class Spring(AbstractElement):
    """A spring that slides at its level: Coulomb friction behind a compliance, without mass.

    level: N;  stiffness: N/m
    """

    stiffness: float

    def leg(self, force: float, travel: float) -> tuple[float, float]:
        """Exact: the force is linear in the travel up to the level, then constant."""
        if not travel:
            return force, 0.0
        s = math.copysign(1.0, travel)
        stretch = min(abs(travel), (self.level - s * force) / self.stiffness)
        end = force + s * self.stiffness * stretch
        return end, s * (force + end) / 2 * stretch + self.level * (abs(travel) - stretch)


@check_types
@dataclass(frozen=True)
class DahlBehindSpring(AbstractElement):
    """Dahl friction (level, stiffness) that is pulled through a spring in series.

    With y = 1 - s f/level and r = stiffness/spring a travel x of sign s leads to
    ln y' + r y' = ln y + r y - stiffness abs(x)/level.

    level: N;  stiffness, spring: N/m
    """

    stiffness: float
    spring: float

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


def compliance(element: AbstractElement) -> float:
    """Compliance of an element near zero force, travel over force, m/N."""
    parts = (getattr(element, n, math.inf) for n in ("stiffness", "spring"))
    return float(sum(1 / x for x in parts))


def _quadratic_remainder(y: float) -> float:
    """y - (1 - e^-y), without a loss of digits where y is small."""
    if y > 0.1:
        return y + math.expm1(-y)
    term, total = y * y / 2, 0.0
    for k in range(3, 16):
        total, term = total + term, -term * y / k
    return total


class AbstractRecord(ABC):
    """A motion that releases energy; a frozen dataclass of plain values."""

    kind: ClassVar[str]

    @property
    @abstractmethod
    def energy(self) -> float:
        """Energy released, J."""

    @abstractmethod
    def replay(self) -> float:
        """Energy released, J, computed anew."""

    def as_dict(self) -> dict[str, object]:
        """Plain data, to be written as JSON: elements by name and values, exact numbers as text.

        Samples of the motion are left out: `replay` computes them anew.
        """
        values = {n: _plain(x) for n, x in vars(self).items() if not isinstance(x, np.ndarray)}
        return {"kind": self.kind, **values, "energy": self.energy}


class AbstractMotion(AbstractRecord):
    """A motion whose energy has a closed formula."""

    @property
    def energy(self) -> float:
        """Energy released, J."""
        return self.replay()


_Motion = TypeVar("_Motion", bound=AbstractMotion)


def strongest(motions: Iterable[_Motion]) -> _Motion | None:
    """The motion that releases most energy; None where none releases any."""
    best = max(motions, key=lambda motion: motion.energy, default=None)
    return best if best is not None and best.energy > 0 else None


def _plain(value: object) -> object:
    if isinstance(value, AbstractElement):
        return [type(value).__name__.lower(), *vars(value).values()]
    if isinstance(value, sp.MatrixBase):
        return [[str(e) for e in row] for row in value.tolist()]
    if isinstance(value, sp.Basic | Fraction):
        return str(value)
    if isinstance(value, complex):
        return [value.real, value.imag]
    if hasattr(value, "as_plain"):
        return value.as_plain
    return [_plain(x) for x in value] if isinstance(value, tuple) else value


@dataclass(frozen=True)
class Cycle(AbstractMotion):
    """A closed path through turning points that releases energy in each round, without end.

    The motion starts with zero forces at the last turning point. All rounds are travelled, and the
    energy of the last one counts. If springs may still lend energy to the last round, at most the
    energy of all rounds together counts.

    compensator: its force helps the motion;  friction: elements that resist
    turning_points: positions of one round, m;  rounds: number of rounds
    """

    compensator: Dahl
    friction: tuple[AbstractElement, ...]
    turning_points: tuple[float, ...]
    rounds: int = 200
    kind = "cycle"

    def replay(self) -> float:
        """Energy released in the last round, J, computed anew along the path."""
        elements: tuple[AbstractElement, ...] = (self.compensator, *self.friction)
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


def symmetric_cycle(
    compensator: Dahl, friction: Sequence[AbstractElement], amplitude: float
) -> Cycle:
    """The periodic motion between -amplitude and amplitude, with enough rounds that forces repeat.

    compensator: its force helps the motion;  friction: elements that resist
    amplitude: m or rad;  returns: the cycle; its energy is > 0 where a round releases energy
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
    """1 - tanh(u)/u: mean force of Dahl friction over its level, in a symmetric cycle.

    u: amplitude of the cycle in bristle lengths, level/stiffness
    """
    return u * u / 3 * (1 - 0.4 * u * u) if u < 1e-3 else 1 - math.tanh(u) / u


def dahl_loss(level: float, stiffness: float, amplitude: float) -> float:
    """Energy that Dahl friction takes per cycle, J: 4 f A (1 - tanh(u)/u), u = A sigma/f.

    level: f, N;  stiffness: sigma, N/m;  amplitude: A of a symmetric cycle, m
    """
    return 4 * level * amplitude * lost_share(amplitude * stiffness / level)
