"""Bounds of the friction of a shape along a measured motion: its hidden states, row by row.

A record may begin while friction holds the body, or in the middle of a motion. So the states start
where friction balances the force that the first rows need: all of them at the same part of what
they have when the body slides.

A shape has one state with an affine rate, or several states that each follow the motion up to a
stop. Where the motion is not certain, friction lies between two bounds. Both have tangents.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import sympy as sp

from ..effects import SIGNALS, Effect
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from ._scan_source import ROW_VELOCITY
from .scan import exact_scan
from .traced import Along, Traced, choose, constant, joined_rows

#: periods of the bandwidth whose mean tells the force at the start: half a period is the shortest
#: change that the band shows. Longer: states start where they are later
AT_START = 0.5
_VELOCITY, _LEVEL = SIGNALS["velocity"], SIGNALS["level"]


@lru_cache(maxsize=64)
def _force_and_stiffness(effect: Effect) -> tuple[sp.Expr, sp.Expr]:
    """The force, and its derivative by the position, from the states that follow the motion."""
    law = effect.expression()
    rates = [sp.diff(rate, _VELOCITY) for rate, _ in effect.stops().values()] or [sp.S(1)]
    pairs = zip(effect.state_symbols().values(), rates, strict=True)
    stiffness = sp.Add(*(sp.diff(law, z) * rate for z, rate in pairs))
    return law.xreplace({_VELOCITY: ROW_VELOCITY}), stiffness.xreplace({_VELOCITY: ROW_VELOCITY})


def shape_bounds(
    effect: Effect,
    motion: Motion,
    along: Along,
    *,
    forward: Traced,
    backward: Traced,
    needed: Traced,
) -> tuple[Traced, Traced]:
    """Bounds of the friction of a shape, driven by the measured motion.

    It has one hidden state, or several that each follow the motion up to a separate stop.
    forward, backward: friction level in that direction
    needed: force that friction balances
    The bounds coincide where the motion is certain. Elsewhere they lie to either side by the force
    that half a step of the position causes in the bristle, and never exceed the level.
    """
    part = _part_at_start(needed, forward, backward, motion)
    # states follow the travel of readings, the force the smoothed velocity, so that no travel of
    # a bristle is lost
    travel = np.diff(motion.position, prepend=motion.position[0]) / along.step
    level = _positive(choose(travel >= 0.0, forward, backward))
    at_start = {
        _VELOCITY: constant(np.ones(1), len(along.columns)),
        _LEVEL: _positive(forward if part.value[0] >= 0.0 else backward),
    }
    followed = {ROW_VELOCITY: along.signals[_VELOCITY], _VELOCITY: along.constant(travel)}
    force, stiffness = exact_scan(
        effect,
        along.with_signals({**followed, _LEVEL: level}),
        *_force_and_stiffness(effect),
        part=part,
        at_start=at_start,
    )
    still = np.flatnonzero(motion.direction == 0)
    if not len(still):
        return force, force
    # where the reading shows no motion, the position is uncertain by half a step
    here, slope = force.rows(still), stiffness.rows(still)
    open_by = 0.5 * motion.step * np.sign(slope[0]) * slope
    least, most = -backward.rows(still), forward.rows(still)
    low, high = here - open_by, here + open_by
    low = np.where(low[0] < least[0], least, low)
    high = np.where(high[0] > most[0], most, high)
    moving = joined_rows(force, forward, backward)

    def bound(there: Array) -> Traced:
        value, tangent = force.value.copy(), np.array(force.tangent)
        value[still], tangent[:, still] = there[0], there[1:]
        return Traced(value, tangent, moving)

    return bound(low), bound(high)


def _positive(level: Traced) -> Traced:
    """The level, above 0: a rate may divide by the level, which is far larger or zero."""
    return Traced(np.maximum(level.value, 1e-12), level.tangent, level.moving)


def _part_at_start(needed: Traced, forward: Traced, backward: Traced, motion: Motion) -> Traced:
    """Friction that the first rows need, over its level in that direction: (1,), -1 to 1.

    It is a mean over the time that the bandwidth resolves, against noise.
    """
    count = max(1, min(len(motion.time), round(AT_START / (motion.bandwidth * motion.sample_time))))
    force, slopes = needed.value[:count].mean(), needed.tangent[:, :count].mean(axis=1)
    there = forward if force >= 0.0 else backward
    level = there.value[0]
    if not abs(force) < level:  # it slides, or there is no friction
        return Traced(np.array([np.sign(force)]), np.zeros((len(slopes), 1)), ())
    part = force / level
    tangent = (slopes - part * there.tangent[:, 0]) / level
    return Traced(np.array([part]), tangent[:, None], joined_rows(needed, there))
