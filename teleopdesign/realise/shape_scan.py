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
from ..measurement.motion import Motion
from ._scan_source import BACKWARD, FORWARD, ROW_VELOCITY, UNCERTAIN
from .scan import exact_scan
from .traced import Along, Traced, choose, constant, joined_rows

#: periods of the bandwidth whose mean tells the force at the start: half a period is the shortest
#: change that the band shows. Longer: states start where they are later
AT_START = 0.5
_VELOCITY, _LEVEL = SIGNALS["velocity"], SIGNALS["level"]


@lru_cache(maxsize=64)
def _laws_of_bounds(effect: Effect, way: sp.Symbol, back: sp.Symbol) -> tuple[sp.Expr, sp.Expr]:
    """Least and largest friction.

    way, back: symbols of the friction level forward and backward
    """
    law = effect.expression()
    rates = [sp.diff(rate, _VELOCITY) for rate, _ in effect.stops().values()] or [sp.S(1)]
    pairs = zip(effect.state_symbols().values(), rates, strict=True)
    stiffness = sp.Add(*(sp.diff(law, z) * rate for z, rate in pairs))
    law, stiffness = (x.xreplace({_VELOCITY: ROW_VELOCITY}) for x in (law, stiffness))
    open_by = UNCERTAIN * sp.Abs(stiffness)
    return tuple(
        sp.Piecewise((end, (UNCERTAIN > 0) & (sign * force > sign * end)), (force, True))
        for sign, end, force in ((-1, -back, law - open_by), (1, way, law + open_by))
    )


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
    # where the reading shows no motion, the position is uncertain by half a step
    known = {UNCERTAIN: along.constant(np.where(motion.direction == 0, 0.5 * motion.step, 0.0))}
    known |= {ROW_VELOCITY: along.signals[_VELOCITY], _VELOCITY: along.constant(travel)}
    known |= {_LEVEL: level, FORWARD: forward, BACKWARD: backward}
    ends = (_LEVEL, _LEVEL) if forward is backward else (FORWARD, BACKWARD)
    laws, along = _laws_of_bounds(effect, *ends), along.with_signals(known)
    low, high = exact_scan(effect, along, *laws, part=part, at_start=at_start)
    return low, high


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
