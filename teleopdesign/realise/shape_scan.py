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
from .compiled import compile_source
from .scan import SampleLoop, Scan, columns_of, contiguous, signals_in, write_tangent
from .traced import Along, Traced, in_rows, joined_rows

#: periods of the bandwidth whose mean tells the force at the start: half a period is the shortest
#: change that the band shows. Longer: states start where they are later
AT_START = 0.5


def _slope_by_position(effect: Effect) -> sp.Expr:
    """Derivative of the force by the position, from the states that follow the motion."""
    law, velocity = effect.expression(), SIGNALS["velocity"]
    rates = [sp.diff(rate, velocity) for rate, _ in effect.stops().values()] or [sp.S(1)]
    pairs = zip(effect.state_symbols().values(), rates, strict=True)
    return sp.Add(*(sp.diff(law, z) * rate for z, rate in pairs))


@lru_cache(maxsize=64)
def _source_of_shape(effect: Effect) -> tuple[str, tuple[str, ...]]:
    """Source of the bounds of a shape's friction, and names of signals that are its arguments."""
    further = tuple(n for n in signals_in(effect) if n not in ("velocity", "level"))
    scan, law = Scan(effect, "level", further), effect.expression()
    slope = _slope_by_position(effect)
    by_state = {z: f"dz[{i}, j]" for i, z in enumerate(effect.state_symbols().values())}
    (slopes_f, df), (slopes_g, dg) = (
        write_tangent(what, one, by, scan.names)
        for what, one, by in (("f", law, by_state | scan.by), ("g", slope, scan.by))
    )
    # states follow the travel of readings, the force the smoothed velocity, so that no travel of
    # a bristle is lost. 1e-12: a rate may divide by the level, which is far larger or zero
    loop = SampleLoop(
        arguments=(
            *("half_step", "position", "velocity", "direction"),
            *("forward", "dforward", "backward", "dbackward", "low", "dlow", "high", "dhigh"),
        ),
        start=[
            "u_velocity = 1.0",
            "u_level = max(forward[0] if part >= 0.0 else backward[0], 1e-12)",
            *scan.read("0"),
        ],
        row=[
            "u_velocity = (position[k] - position[max(k - 1, 0)]) / h",
            "ahead = u_velocity >= 0.0",
            "u_level = max(forward[k] if ahead else backward[k], 1e-12)",
            *scan.read("k"),
        ],
        at_start="dforward[j, 0] if part >= 0.0 else dbackward[j, 0]",
        at_row="dforward[j, k] if ahead else dbackward[j, k]",
        each=[
            "u_velocity = velocity[k]",
            *scan.values({"force": law, "slope": slope}),
            *slopes_f,
            *slopes_g,
            # where the reading shows no motion, the position is uncertain by half a step
            "free = half_step if direction[k] == 0 else 0.0",
            "below = force - free * abs(slope)",
            "above = force + free * abs(slope)",
            "low[k] = below if direction[k] != 0 else max(below, -backward[k])",
            "high[k] = above if direction[k] != 0 else min(above, forward[k])",
        ],
        column=[
            f"df = {df}",
            f"dg = free * copysign(1.0, slope) * ({dg})",
            "dlow[j, k] = df - dg if low[k] == below else -dbackward[j, k]",
            "dhigh[j, k] = df + dg if high[k] == above else dforward[j, k]",
        ],
    )
    return scan.source(loop), further


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
    source, used = _source_of_shape(effect)
    scan = compile_source(source, "scan")
    places, parameters = columns_of(effect, along.columns), len(along.columns)
    part = _part_at_start(needed, forward, backward, motion)
    moving = joined_rows(forward, backward, part, more=places[places >= 0].tolist())
    rows = list(range(parameters) if moving is None else moving)
    low, high = np.empty_like(forward.value), np.empty_like(forward.value)
    dlow, dhigh = np.empty((len(rows), len(low))), np.empty((len(rows), len(low)))
    scan(
        along.step,
        np.where(places >= 0, np.searchsorted(rows, places), -1),
        float(part.value[0]),
        part.tangent[rows, 0].copy(),
        *[along.values[s] for s in effect.symbols().values()],
        *[along.signals[SIGNALS[n]].value for n in used],
        0.5 * motion.step,
        motion.position,
        motion.velocity,
        motion.direction,
        forward.value,
        contiguous(forward.tangent[rows]),
        backward.value,
        contiguous(backward.tangent[rows]),
        low,
        dlow,
        high,
        dhigh,
    )
    return in_rows(low, dlow, rows, parameters), in_rows(high, dhigh, rows, parameters)


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
