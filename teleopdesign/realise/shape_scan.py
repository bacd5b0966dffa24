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

from ..base.errors import ModelError
from ..effects import SIGNALS, Effect
from ..measurement.motion import Motion
from .compiled import compile_source
from .laws import Names, assignments, indent
from .scan import (
    HEAD,
    STATE,
    affine_rate,
    columns_of,
    contiguous,
    names_in_source,
    signals_in,
    slope_lines,
    slope_of_column,
    slopes_by,
)
from .traced import Along, Traced, in_rows, joined_rows

#: periods of the bandwidth whose mean tells the force at the start: half a period is the shortest
#: change that the band shows. Longer: states start where they are later
AT_START = 0.5


def _signals_of_shape(effect: Effect) -> list[str]:
    """Signals of a shape's laws, except those that every scan has."""
    return [n for n in signals_in(effect) if n not in ("velocity", "level")]


def _shape_module(
    effect: Effect,
    names: Names,
    *,
    start: tuple[list[str], list[str]],
    advance: list[str],
    slope: sp.Expr,
    weights: list[str],
    tangents: list[str],
    moved: str,
) -> str:
    """Source of the bounds of a shape's friction, and of their tangents, at each sample.

    start: code of the states when the body slides, and of column j of their tangents
    advance: code of their step over a sample
    slope: derivative of the force by position
    weights: code of the derivatives of the force by the states, once for all columns
    tangents: code of the step of column j of the states' tangents
    moved: code of the resulting change of the force
    """
    law, used = effect.expression(), _signals_of_shape(effect)
    by = slopes_by(effect, "level")
    arguments = [*(names[s] for s in effect.symbols().values()), *(f"{n}_" for n in used)]
    # states follow the travel of readings, the force the smoothed velocity, so that no travel of
    # a bristle is lost. 1e-12: a rate may divide by the level, which is far larger or zero
    return f"""{HEAD}

@jitted
def shape(h, half_step, columns, position, velocity, direction, {", ".join(arguments)},
          part, dpart, forward, dforward, backward, dbackward, low, dlow, high, dhigh):
    p, n = dforward.shape
{indent(_start_lines(used, *start), 4)}
    for k in range(n):
        u_velocity = (position[k] - position[max(k - 1, 0)]) / h
        ahead = u_velocity >= 0.0
        u_level = max(forward[k] if ahead else backward[k], 1e-12)
{indent([f"u_{n} = {n}_[k]" for n in used], 8)}
{indent(advance, 8)}
        u_velocity = velocity[k]
{indent(assignments({"force": law, "slope": slope}, names), 8)}
{indent(weights, 8)}
{indent(slope_lines("f", law, by, names) + slope_lines("g", slope, by, names), 8)}
        # where the reading shows no motion, the position is uncertain by half a step
        free = half_step if direction[k] == 0 else 0.0
        below = force - free * abs(slope)
        above = force + free * abs(slope)
        low[k] = below if direction[k] != 0 else max(below, -backward[k])
        high[k] = above if direction[k] != 0 else min(above, forward[k])
        for j in range(p):
            dlevel = dforward[j, k] if ahead else dbackward[j, k]
{indent(tangents, 12)}
            df = {moved} + f_level * dlevel + {slope_of_column(effect, "f")}
            dg = free * copysign(1.0, slope) * (g_level * dlevel + {slope_of_column(effect, "g")})
            dlow[j, k] = df - dg if low[k] == below else -dbackward[j, k]
            dhigh[j, k] = df + dg if high[k] == above else dforward[j, k]
"""


def _start_lines(used: list[str], states: list[str], tangents: list[str]) -> list[str]:
    """Code that starts the states, and column j of their tangents, at a part of sliding."""
    return [
        "u_velocity = 1.0",
        "u_level = max(forward[0] if part >= 0.0 else backward[0], 1e-12)",
        *(f"u_{n} = {n}_[0]" for n in used),
        *states,
        "for j in range(p):",
        "    dlevel = dforward[j, 0] if part >= 0.0 else dbackward[j, 0]",
        *(f"    {line}" for line in tangents),
    ]


@lru_cache(maxsize=64)
def _shape_source(effect: Effect) -> str:
    """Source for a shape with one state and an affine rate: exact over each sample."""
    state, a, b = affine_rate(effect)
    names, by = names_in_source(effect), slopes_by(effect, "level")
    return _shape_module(
        effect,
        names,
        start=(
            [
                *assignments({"a": a, "b": b}, names),
                *slope_lines("a", a, by, names),
                *slope_lines("b", b, by, names),
                # a state that nothing limits starts at zero
                "sliding = -b / a if a != 0.0 else 0.0",
                "z = part * sliding",
                "dz = np.zeros(p)",
            ],
            [
                f"da = a_level * dlevel + {slope_of_column(effect, 'a')}",
                f"db = b_level * dlevel + {slope_of_column(effect, 'b')}",
                "dz[j] = dpart[j] * sliding",
                "dz[j] -= part * (db + sliding * da) / a if a != 0.0 else 0.0",
            ],
        ),
        advance=[
            *assignments({"a": a, "b": b}, names),
            *slope_lines("a", a, by, names),
            *slope_lines("b", b, by, names),
            "e, p1, p2, p3 = phi(a * h)",
            "s1 = p1 - p2",  # d phi_1/dz
            "before = z",
            "z = before * e + b * h * p1",
            f"{STATE} = z",
        ],
        slope=sp.diff(effect.expression(), state),
        weights=[],
        tangents=[
            f"da = a_level * dlevel + {slope_of_column(effect, 'a')}",
            f"db = b_level * dlevel + {slope_of_column(effect, 'b')}",
            "dz[j] = dz[j] * e + before * e * h * da + h * p1 * db + b * h * s1 * h * da",
        ],
        moved="slope * dz[j]",
    )


def _stop_lines(count: int) -> list[str]:
    """Code that advances each state by its rate, up to its stop."""
    lines: list[str] = []
    for i in range(count):
        lines += [
            f"stop_{i} = max(s{i}, 0.0)",
            f"z_{i} += h * r{i}",
            f"held_{i} = abs(z_{i}) > stop_{i}",
            # a sliding element stays at its stop: its force does not grow with travel
            f"z_{i} = copysign(stop_{i}, z_{i}) if held_{i} else z_{i}",
        ]
    return lines


def _stop_tangents(effect: Effect) -> list[str]:
    """Code of column j of each state's tangents; at a stop they are those of the stop."""
    lines: list[str] = []
    for i in range(len(effect.states)):
        by_stop = _slope_of_stop(effect, i)
        by_rate = f"r{i}_level * dlevel + {slope_of_column(effect, f'r{i}')}"
        lines += [
            f"if held_{i}:",
            f"    dz[{i}, j] = copysign(1.0, z_{i}) * ({by_stop})",
            "else:",
            f"    dz[{i}, j] += h * ({by_rate})",
        ]
    return lines


def _slope_of_stop(effect: Effect, i: int) -> str:
    """Code of column j of the tangent of a state's stop."""
    return f"s{i}_level * dlevel + {slope_of_column(effect, f's{i}')}"


@lru_cache(maxsize=64)
def _stopped_source(effect: Effect) -> str:
    """Source for a shape whose states follow the motion, each up to its stop: exact in each step.

    raises ModelError: some states have no stop, or a state depends on others
    """
    stops, states = effect.stops(), list(effect.state_symbols().values())
    if len(stops) < len(states) or any(r.has(*states) or s.has(*states) for r, s in stops.values()):
        raise ModelError(f"{effect.name}: states with a stop beside others, or that need others")
    law, m = effect.expression(), len(states)
    names = {**names_in_source(effect), **{z: f"z_{i}" for i, z in enumerate(states)}}
    by = slopes_by(effect, "level")
    laws = {f"r{i}": rate for i, (rate, _) in enumerate(stops.values())}
    laws |= {f"s{i}": stop for i, (_, stop) in enumerate(stops.values())}
    velocity = SIGNALS["velocity"]
    slopes = [line for name, one in laws.items() for line in slope_lines(name, one, by, names)]
    return _shape_module(
        effect,
        names,
        start=(
            [
                *assignments(laws, names),
                *slopes,
                *(f"z_{i} = part * max(s{i}, 0.0)" for i in range(m)),
                f"dz = np.zeros(({m}, p))",
            ],
            [
                f"dz[{i}, j] = dpart[j] * s{i} + part * ({_slope_of_stop(effect, i)})"
                for i in range(m)
            ],
        ),
        advance=[*assignments(laws, names), *slopes, *_stop_lines(m)],
        slope=sp.Add(
            *(sp.diff(law, z) * sp.diff(laws[f"r{i}"], velocity) for i, z in enumerate(states))
        ),
        weights=assignments({f"w{i}": sp.diff(law, z) for i, z in enumerate(states)}, names),
        tangents=_stop_tangents(effect),
        moved=" + ".join(f"w{i} * dz[{i}, j]" for i in range(m)),
    )


@lru_cache(maxsize=64)
def _shape_of(effect: Effect) -> tuple[str, tuple[str, ...]]:
    """Source of a shape's bounds, and the names of further signals that are its arguments."""
    source = _stopped_source(effect) if effect.stops() else _shape_source(effect)
    return source, tuple(_signals_of_shape(effect))


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
    source, used = _shape_of(effect)
    scan = compile_source(source, "shape")
    places, parameters = columns_of(effect, along.columns), len(along.columns)
    part = _part_at_start(needed, forward, backward, motion)
    moving = joined_rows(forward, backward, part, more=places[places >= 0].tolist())
    rows = list(range(parameters) if moving is None else moving)
    low, high = np.empty_like(forward.value), np.empty_like(forward.value)
    dlow, dhigh = np.empty((len(rows), len(low))), np.empty((len(rows), len(low)))
    scan(
        along.step,
        0.5 * motion.step,
        np.where(places >= 0, np.searchsorted(rows, places), -1),
        motion.position,
        motion.velocity,
        motion.direction,
        *[along.values[s] for s in effect.symbols().values()],
        *[along.signals[SIGNALS[n]].value for n in used],
        float(part.value[0]),
        part.tangent[rows, 0].copy(),
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
