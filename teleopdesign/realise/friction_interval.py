"""Bounds of the friction of a body: the lowest and the highest level.

They hold over the reach of a motion, and for each parameter within some standard errors of its
estimate and within its declared bounds. This is a box of parameters, so a bound holds for any
correlation, and a sinusoid of unknown phase never exceeds its amplitude. The bounds come from
interval arithmetic on the body's law (`extremes`), not from samples or a grid.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from ..base.errors import ModelError
from ..base.sentences import round_down, round_near, round_up
from ..base.units import unit_after_number, unit_of
from ..blocks import Body, Value
from ..effects import SIGNALS, Effect, sort_by_action
from .extremes import Least, Ranges, least_value
from .reach import (
    ANY_MOTION,
    Reach,
    largest_speed,
    signal_ranges,
    unit_of_signal,
    words_of,
)
from .simulated import without_absent

#: symbol of the speed of sliding in either direction; > 0, so that its sign is known
SPEED = sp.Symbol("speed", positive=True)
DIRECTION = SIGNALS["direction"]


@dataclass(frozen=True)
class Interval:
    """An estimate and its interval, SI; both ends equal the estimate where it is exact."""

    estimate: float
    low: float
    high: float

    def round_outward(self, *, digits: int) -> Interval:
        """The interval with `digits` digits and both ends rounded outward; an exact one is kept.

        So a statement about the interval is true for the printed numbers.
        """
        if self.low == self.high:
            return self
        return Interval(
            round_near(self.estimate, digits=digits),
            round_down(self.low, digits=digits),
            round_up(self.high, digits=digits),
        )

    def __str__(self) -> str:
        if self.low == self.high:
            return f"{self.estimate:.4g}"
        return f"{self.estimate:.4g} ({self.low:.4g} to {self.high:.4g})"


@dataclass(frozen=True)
class FrictionInterval:
    """Levels of friction while sliding, N or N m, and the stiffness before it slides.

    lowest, highest: level over the reach, with the identified parameters (`estimate`: a bound that
        is reached within `extremes.TIGHTNESS`), and with any parameters in their intervals
    where_lowest: signals at the lowest level, in words;  over: the reach, in words
    presliding: stiffness before it slides, N/m; None where friction is ideal
    unknown: parameters of the level without a standard error, taken as exact
    """

    lowest: Interval
    highest: Interval
    where_lowest: str
    over: str
    presliding: Interval | None = None
    unknown: tuple[str, ...] = ()

    def bristle_lengths(self, travel: float) -> float:
        """Half of a travel (m or rad) over the bristle length; inf without presliding."""
        if self.presliding is None:
            return math.inf
        return travel / 2 * self.presliding.estimate / self.highest.estimate

    def slides_within(self, travel: float) -> bool:
        """Whether friction comes near its level within a travel; otherwise the level is open."""
        return self.bristle_lengths(travel) > 1.0


def friction_interval(
    body: Body, reach: Reach | None = None, *, errors: float
) -> FrictionInterval | None:
    """The levels that a body's friction can have; None where it has no friction level.

    reach: of the motions; None: every motion, as far as the law is bounded there
    errors: range of the parameters to either side, in standard errors
    raises ModelError: no bound is known; the message says for which function, or which range is
        needed
    """
    present = without_absent(body, surely=True)
    level = present.level()
    if level == 0:
        return None
    lowest, point = lowest_of(present, level, reach, errors=errors)
    negative, _ = lowest_of(present, -level, reach, errors=errors)
    highest = Interval(-negative.estimate, -negative.high, -negative.low)
    if not math.isfinite(lowest.low):
        raise ModelError(_explain_unbounded(level, reach))
    follows = level.has(SIGNALS["velocity"], *_list_lagging_speeds(present))
    stiffness = present.parameters.get("presliding.stiffness")
    return FrictionInterval(
        lowest,
        highest,
        _where(point, present),
        words_of(reach, level, speed=follows, axis=body.axis),
        None if stiffness is None else value_interval(stiffness, errors=errors),
        without_error(present, level),
    )


def value_interval(value: Value, *, errors: float) -> Interval:
    """A parameter that is not negative, within `errors` standard errors."""
    half = errors * value.stderr if _uncertain(value) else 0.0
    return Interval(value.value, max(value.value - half, 0.0), value.value + half)


def without_error(body: Body, law: sp.Expr) -> tuple[str, ...]:
    """Parameters of a law that are not fixed and have no standard error."""
    return tuple(
        n
        for n, s in body.symbols().items()
        if law.has(s) and not body.parameters[n].fixed and math.isnan(body.parameters[n].stderr)
    )


def lowest_of(
    body: Body,
    law: sp.Expr,
    reach: Reach | None,
    *,
    errors: float,
    ranges: Ranges | None = None,
) -> tuple[Interval, Mapping[sp.Symbol, float]]:
    """The least value of a law over the reach, as an interval over all parameters, and its point.

    law: on symbols of `effects.SIGNALS`, of the body's parameters, of lagging speeds, and `SPEED`
    ranges: of further symbols, or in place of those of the reach
    """
    signals = _signals(body, reach, errors) | dict(ranges or {})
    exact = {s: (x, x) for s, x in body.numbers().items()}
    estimate, point = _least_either_way(law, signals | exact)
    within = {s: r for s, r in parameter_box(body, errors=errors).items() if law.has(s)}
    if all(low == high for low, high in within.values()):
        return Interval(estimate.bound, estimate.bound, estimate.bound), point
    low, worst = _least_either_way(law, signals | exact | within)
    # upper bound of the least level, for any parameters: the level at the point that is least with
    # the estimates
    there = {s: (x, x) for s, x in point.items() if s in signals}
    turned = -_fix_direction(law, point.get(DIRECTION, 1.0))
    high = -least_value(turned, signals | exact | within | there).bound
    if math.isinf(estimate.bound):
        high = estimate.bound
    return (
        Interval(estimate.bound, min(low.bound, estimate.bound), max(high, estimate.bound)),
        worst,
    )


def parameter_box(body: Body, *, errors: float) -> dict[sp.Symbol, tuple[float, float]]:
    """Symbol -> range within `errors` standard errors of the estimate and its declared bounds."""
    return {s: _box(body, n, errors) for n, s in body.symbols().items()}


def stays_within(effect: Effect, state: sp.Symbol, ranges: Ranges) -> bool:
    """Whether a hidden state stays in its range: at each end its rate leads inward, or is zero.

    ranges: of all symbols in the rate
    """
    names = {v: n for n, v in effect.state_symbols().items()}
    rate = effect.rates()[names[state]]
    for end, inward in zip(ranges[state], (1, -1), strict=True):
        if math.isinf(end):
            continue
        here = {**ranges, state: (end, end)}
        slowest = _least_either_way(inward * rate, here)[0].bound
        fastest = -_least_either_way(-inward * rate, here)[0].bound
        rounding = 1e-13 * abs(fastest) if math.isfinite(fastest) else 0.0
        if not slowest >= -rounding:
            return False
    return True


def _signals(
    body: Body, reach: Reach | None, errors: float
) -> dict[sp.Symbol, tuple[float, float]]:
    """Ranges of signals and of lagging speeds, which must stay within the speeds of the motion.

    raises ModelError: a lagging speed can leave them
    """
    speeds = 0.0, largest_speed(reach)
    known = signal_ranges(reach) | {SPEED: speeds}
    lagging = _list_lagging_speeds(body)
    every = known | dict.fromkeys(lagging, speeds) | parameter_box(body, errors=errors)
    for state, effect in lagging.items():
        if not stays_within(effect, state, every):
            raise ModelError(
                f"friction level: {effect.name}: its speed can leave those of the motion, 0 to "
                f"{speeds[1]:.4g} {unit_of('velocity', body.axis)}: no guaranteed bound"
            )
    return known | dict.fromkeys(lagging, speeds)


def _least_either_way(law: sp.Expr, ranges: Ranges) -> tuple[Least, Mapping[sp.Symbol, float]]:
    """The least value over both directions of motion, and its point."""
    if not law.has(SIGNALS["velocity"], DIRECTION):
        least = least_value(law, ranges)
        return least, least.point
    laws = {way: _fix_direction(law, way) for way in (-1.0, 1.0)}
    if laws[-1.0] == laws[1.0]:
        least = least_value(laws[1.0], ranges)
        return least, least.point
    by_way = {way: least_value(one, ranges) for way, one in laws.items()}
    way = min(by_way, key=lambda w: by_way[w].bound)
    return by_way[way], {DIRECTION: way, **by_way[way].point}


def _fix_direction(law: sp.Expr, way: float) -> sp.Expr:
    sign = sp.Integer(int(way))
    return law.subs({SIGNALS["velocity"]: sign * SPEED, DIRECTION: sign})


def _box(body: Body, name: str, errors: float) -> tuple[float, float]:
    """A parameter's range within `errors` standard errors and its declared bounds."""
    value, declared = body.parameters[name], body.parameter(name)
    if not _uncertain(value):
        return value.value, value.value
    half = errors * value.stderr
    return max(value.value - half, declared.lower), min(value.value + half, declared.upper)


def _uncertain(value: Value) -> bool:
    return not value.fixed and math.isfinite(value.stderr)


def _list_lagging_speeds(body: Body) -> dict[sp.Symbol, Effect]:
    """Hidden speeds that the level depends on -> their effect."""
    speeds = sort_by_action(body.effects, "friction_speed")
    return {s: e for e in speeds for s in e.state_symbols().values()}


def _where(point: Mapping[sp.Symbol, float], body: Body) -> str:
    """The signals of a point, in words with units, without parameters."""
    names = {SPEED: "speed"} | dict.fromkeys(_list_lagging_speeds(body), "speed")
    names |= {s: n for n, s in SIGNALS.items()}
    return (
        ", ".join(
            f"{names[s]} {x:.3g}{_unit_of(names[s], body)}" for s, x in point.items() if s in names
        )
        or ANY_MOTION
    )


def _unit_of(signal: str, body: Body) -> str:
    """The unit of a signal after its number; "" where it has none, such as a direction."""
    return unit_after_number(unit_of_signal(signal, body.axis))


def _explain_unbounded(level: sp.Expr, reach: Reach | None) -> str:
    """A message on the missing lower bound of a level, and what the user can state."""
    names = sorted(
        n for n, s in SIGNALS.items() if level.has(s) and n not in ("direction", "position")
    )
    names += ["position"] if level.has(SIGNALS["position"]) else []
    if reach is None:
        needed = "give the experiment whose records say how far they reach"
    else:
        needed = "no bound is known within what the records reach"
    return f"friction level: no lower bound over any {', '.join(names)}: {needed}"
