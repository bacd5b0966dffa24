"""Friction along a measured motion: its level, its bounds, and the balance between them.

friction = shape(level, motion); where the position shows no certain motion, friction balances
forces
"""

from __future__ import annotations

import numpy as np
import sympy as sp

from ..blocks import Body
from ..effects import SIGNALS, sort_by_action
from ..measurement.motion import Motion
from .balance import balance_within_bounds
from .scan import driven_scan
from .shape_scan import shape_bounds
from .traced import Along, Traced, constant, joined_rows

_DIRECTION, _ACTING = SIGNALS["direction"], SIGNALS["acting_force"]


def level_along(body: Body, along: Along) -> tuple[sp.Expr, Along]:
    """The friction level on symbols, and the signals with the hidden speeds that it depends on."""
    level = body.level()
    for effect in sort_by_action(body.effects, "friction_speed"):
        if effect.is_absent(along.values):
            level = level.subs(effect.expression(), sp.Abs(SIGNALS["velocity"]))
        else:
            along = along.with_signals(driven_scan(effect, along))
    return level, along


def bound_friction(
    body: Body, level: sp.Expr, motion: Motion, along: Along, needed: Traced
) -> tuple[Traced, Traced]:
    """Least and largest friction at each row; they coincide where the motion is certain.

    needed: force that friction balances; it tells where hidden states start
    """
    n = len(motion.time)
    if level == 0:
        none = along.constant(np.zeros(n))
        return none, none

    def towards(way: float) -> Traced:
        this_way = along.with_signals({_DIRECTION: along.constant(np.full(n, way))})
        size = this_way.evaluate(level)
        if not size.is_constant and (size.value < 0).any():
            size.tangent[:, size.value < 0] = 0.0
        return Traced(np.maximum(size.value, 0.0), size.tangent, size.moving)

    forward = towards(1.0)
    backward = towards(-1.0) if level.has(_DIRECTION) else forward
    shapes = along.present(body.effects, "friction_shape")
    if shapes:
        return shape_bounds(
            shapes[0], motion, along, forward=forward, backward=backward, needed=needed
        )
    return _bound_sliding(motion, forward, backward)


def _bound_sliding(motion: Motion, forward: Traced, backward: Traced) -> tuple[Traced, Traced]:
    """sgn v times the level where the direction is known; elsewhere any force up to the level."""
    ahead, back = motion.direction > 0, motion.direction < 0
    if forward is backward:
        return forward.times(np.where(ahead, 1.0, -1.0)), forward.times(np.where(back, -1.0, 1.0))
    moving = joined_rows(forward, backward)
    low = Traced(
        np.where(ahead, forward.value, -backward.value),
        np.where(ahead, forward.tangent, -backward.tangent),
        moving,
    )
    high = Traced(
        np.where(back, -backward.value, forward.value),
        np.where(back, -backward.tangent, forward.tangent),
        moving,
    )
    return low, high


def balance_friction(motion: Motion, needed: Traced, low: Traced, high: Traced) -> Traced:
    """Friction within its bounds that balances the needed force."""
    if low is high:
        return low
    bandwidth, sample_time = motion.bandwidth, motion.sample_time
    return balance_within_bounds(needed, low, high, bandwidth=bandwidth, sample_time=sample_time)


def friction_of_acting_force(level: sp.Expr, friction: Traced, along: Along) -> Traced:
    """The part of the friction that the acting force itself causes."""
    if not level.has(_ACTING):
        return constant(np.zeros_like(friction.value), len(friction.tangent))
    # by values: numpy refuses one law in which a piecewise level is part of a condition
    whole, rest = along.evaluate(level), along.evaluate(level.subs(_ACTING, 0))
    is_there = whole.value > 0
    size = np.where(is_there, whole.value, 1.0)
    share = np.where(is_there, 1.0 - rest.value / size, 0.0)
    caused = friction.times(share)
    moving = joined_rows(whole, rest)
    tangent = np.array(caused.tangent)
    for j in range(len(tangent)) if moving is None else moving:
        slope = (rest.value / size * whole.tangent[j] - rest.tangent[j]) / size
        tangent[j] += friction.value * np.where(is_there, slope, 0.0)
    return Traced(caused.value, tangent, joined_rows(caused, whole, rest))
