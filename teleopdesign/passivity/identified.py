"""What passivity needs of an identified device: levels and stiffness with 95 % intervals."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import sympy as sp

from ..blocks import NINETY_FIVE, Body, Value
from ..effects import SIGNALS
from ..errors import ModelError
from ..quantity import unit_of
from ..realise.law_along import law_along

_DRAWS = 4000  # of speed, position, time ..., over which the level is looked at


@dataclass(frozen=True)
class Interval:
    """An estimate with its 95 % interval, SI; both ends are the estimate where it is exact."""

    estimate: float
    low: float
    high: float

    def __str__(self) -> str:
        if self.low == self.high:
            return f"{self.estimate:.4g}"
        return f"{self.estimate:.4g} ({self.low:.4g} to {self.high:.4g})"


@dataclass(frozen=True)
class IdentifiedDevice:
    """Friction of a device as far as passivity asks for it.

    lowest, highest: friction level that can occur, over all speeds, positions and times, N or N m
    least_resistance: the least that level and viscous damping together come to at any speed
    presliding: stiffness before it slides, N/m; None where friction was identified as ideal
    damping: viscous, N s/m, 0 where the model has none
    set_aside: effects that the claims do not speak of;  unknown: parameters without standard error
    """

    body: Body
    lowest: Interval
    highest: Interval
    least_resistance: Interval
    presliding: Interval | None
    damping: Interval
    set_aside: tuple[str, ...]
    unknown: tuple[str, ...]

    @property
    def force_unit(self) -> str:
        """Unit of levels on the device's axis."""
        return unit_of("force", self.body.axis)

    @property
    def stiffness_unit(self) -> str:
        """Unit of stiffnesses on the device's axis."""
        return unit_of("stiffness", self.body.axis)


#: effects that a claim about friction already speaks of, or that only take energy or store it
_COVERED = {"friction_level", "friction_factor", "friction_speed", "friction_shape"}
_HARMLESS = {"viscous", "spring", "hardening_spring", "quadratic_drag", "cogging", "bias"}
_HARMLESS |= {"added_inertia", "viscous_asymmetry", "transmission_compliance"}


def identified(body: Body) -> IdentifiedDevice:
    """Read levels, presliding and damping off a body, with the errors of its parameters.

    The level is the body's own law over 4000 draws of the speed, position, time and other signals
    it depends on, up to 10 SI units (time: a day); its error at each is bounded whatever the
    correlation of the parameters. Damping is the `viscous` effect's.
    raises ModelError: a body without friction, or one whose interval reaches down to no friction
    """
    level = body.level()
    if level == 0:
        raise ModelError("passivity: the device has no friction to compensate")
    lowest, highest = _range(body, level)
    if lowest.low <= 0:
        raise ModelError(
            f"passivity: the friction level may be as low as {lowest.low:.3g} within its 95 % "
            "interval: nothing can be compensated for certain"
        )
    stiff = body.parameters.get("presliding.stiffness")
    return IdentifiedDevice(
        body,
        lowest,
        highest,
        _range(body, _resistance(body, level))[0],
        _interval(stiff) if stiff is not None else None,
        _interval(body.parameters.get("viscous.damping", Value(0.0, fixed=True))),
        tuple(e.name for e in body.effects if e.role not in _COVERED and e.name not in _HARMLESS),
        tuple(
            n
            for n, v in body.parameters.items()
            if not v.fixed
            and math.isnan(v.stderr)
            and not (v.value == 0 and body.parameter(n).optional)  # one that is not there
        ),
    )


def _stderr(value: Value) -> float:
    return 0.0 if math.isnan(value.stderr) else value.stderr


def _interval(value: Value) -> Interval:
    half = NINETY_FIVE * _stderr(value)
    return Interval(value.value, max(value.value - half, 0.0), value.value + half)


def _resistance(body: Body, level: sp.Expr) -> sp.Expr:
    """Level and viscous friction against a motion of that velocity."""
    if not body.has("viscous"):
        return level
    return level + sp.sign(SIGNALS["velocity"]) * body.effect("viscous").expression()


def _range(body: Body, level: sp.Expr) -> tuple[Interval, Interval]:
    """Lowest and highest level over what it depends on."""
    signals = sorted(level.free_symbols - set(body.numbers()), key=str)
    rng = np.random.default_rng(0)
    # every size up to 10 SI units, and zero: laws of speed and position settle or repeat beyond
    sizes = 10 ** rng.uniform(-6, 1, (_DRAWS, max(len(signals), 1)))
    draws = sizes * rng.choice((-1.0, 1.0), sizes.shape)
    draws[0] = 0.0
    for k, s in enumerate(signals):
        if s.name == "direction":
            draws[:, k] = np.where(draws[:, k] < 0, -1.0, 1.0)
        elif s.name == "time" or s.name.startswith("friction_memory"):
            draws[:, k] = np.abs(draws[:, k]) * (1e4 if s.name == "time" else 1.0)

    given = {s: draws[:, k] for k, s in enumerate(signals)}
    estimate, error = law_along(body, level, given)
    half = NINETY_FIVE * error
    every = estimate, estimate - half, estimate + half
    return (
        Interval(*(float(x.min()) for x in every)),
        Interval(*(float(x.max()) for x in every)),
    )
