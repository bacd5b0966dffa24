"""Hidden states along a measured motion: loops over the samples, generated from the effects' rates.

A state whose rate is affine in it, dz/dt = A z + B, advances exactly over a sample in which its
signals are held: z(t + h) = e^x z + h phi_1(x) B with x = A h; the average over the sample is
phi_1(x) z + h phi_2(x) B. Tangents follow by differentiating the same expressions.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp

from ..effects import SIGNALS, Effect
from ..errors import ModelError
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from .compiled import compiled
from .exponentials import PHI, head
from .laws import Names, assignments, indented
from .traced import Along, Traced

_HEAD = head("Generated from an effect's law; do not edit.") + PHI
#: private name of the effect's one state
_STATE = "z_0"


def _affine(effect: Effect) -> tuple[sp.Symbol, sp.Expr, sp.Expr]:
    """The effect's one state z with its rate as A z + B."""
    if len(effect.states) != 1:
        raise ModelError(f"{effect.name}: {len(effect.states)} states in one scan; one is possible")
    (name,) = effect.states
    z, rate = effect.state_symbols()[name], effect.rates()[name]
    slope = sp.diff(rate, z)
    if slope.has(z):
        raise ModelError(f"{effect.name}: the rate of {name} must be affine in {name}")
    return z, slope, rate.subs(z, 0)


def _names(effect: Effect) -> dict[sp.Symbol, str]:
    """Signals, parameters and the state under private names."""
    signals = {s: f"u_{n}" for n, s in SIGNALS.items()}
    parameters = {s: f"p_{i}" for i, s in enumerate(effect.symbols().values())}
    return signals | parameters | dict.fromkeys(effect.state_symbols().values(), _STATE)


def _lines(what: str, expression: sp.Expr, by: dict[str, sp.Symbol], names: Names) -> list[str]:
    """Slopes of an expression by signals and parameters, as what_key."""
    return assignments({f"{what}_{k}": sp.diff(expression, s) for k, s in by.items()}, names)


def _used(effect: Effect) -> list[str]:
    laws = (effect.expression(), *effect.rates().values())
    return [n for n, s in SIGNALS.items() if any(law.has(s) for law in laws)]


def _slopes_by(effect: Effect, signal: str) -> dict[str, sp.Symbol]:
    """What slopes are taken by: a signal, and the parameters by their number."""
    parameters = {str(i): s for i, s in enumerate(effect.symbols().values())}
    return {signal: SIGNALS[signal], **parameters}


def _by_parameter(effect: Effect, what: str) -> str:
    """Slope by the parameter that column j stands for."""
    terms = (f"{what}_{i} * (columns[{i}] == j)" for i in range(len(effect.parameters)))
    return " + ".join(terms) or "0.0"


@lru_cache(maxsize=64)
def _stage_source(effect: Effect) -> str:
    _, a, b = _affine(effect)
    used, names = _used(effect), _names(effect)
    by = _slopes_by(effect, "command")
    parameters = [names[s] for s in effect.symbols().values()]
    step = [
        *assignments({"a": a}, names),
        *_lines("a", a, by, names),
        "e, p1, p2, p3 = phi(a * h)",
        "s1 = p1 - p2",
        "s2 = p2 - 2.0 * p3",
    ]
    # a lag that no signal changes moves on alike in each sample: an exponential for all of them
    each = any(a.has(SIGNALS[n]) for n in used)
    return f"""{_HEAD}

@jitted
def stage(h, columns, {", ".join([*parameters, *(f"{n}_" for n in used)])}, dcommand,
          end, dend, mean, dmean):
    p, n = dcommand.shape
    dz = np.zeros(p)
    {_STATE} = 0.0
{indented([] if each else step, 4)}
    for k in range(n):
{indented([f"u_{n} = {n}_[k]" for n in used], 8)}
{indented(step if each else [], 8)}
{indented(assignments({"b": b}, names), 8)}
        starting = k == 0 and a != 0.0
        if starting:
            {_STATE} = -b / a  # steady
{indented(_lines("b", b, by, names), 8)}
        z = {_STATE}
        mean[k] = z * p1 + b * h * p2
        end[k] = z
        for j in range(p):
            da = a_command * dcommand[j, k] + {_by_parameter(effect, "a")}
            db = b_command * dcommand[j, k] + {_by_parameter(effect, "b")}
            if starting:
                dz[j] = (b * da / a - db) / a
            dmean[j, k] = dz[j] * p1 + z * s1 * h * da + h * p2 * db + b * h * s2 * h * da
            dend[j, k] = dz[j]
            dz[j] = dz[j] * e + z * e * h * da + h * p1 * db + b * h * s1 * h * da
        {_STATE} = z * e + b * h * p1
"""


def columns_of(effect: Effect, columns: Sequence[Any]) -> Array:
    """Row of the tangents that belongs to each parameter of the effect; -1 where none does."""
    symbols = effect.symbols()
    return np.array(
        [columns.index(symbols[n]) if symbols[n] in columns else -1 for n in effect.parameters],
        dtype=int,
    )


def stage_scan(effect: Effect, along: Along) -> dict[sp.Symbol, Traced]:
    """State of an actuation stage, as its average over the hold of each row, with tangents."""
    _, mean = _advanced(effect, along, along.signals[SIGNALS["command"]])
    (symbol,) = effect.state_symbols().values()
    return {symbol: mean}


def driven_scan(effect: Effect, along: Along) -> dict[sp.Symbol, Traced]:
    """State that the measured motion drives, at the rows, with tangents.

    The motion at a row stands for the sample before it: without a lag the state is in step with it.
    """
    end, _ = _advanced(effect, along, along.signals[SIGNALS["velocity"]])
    (symbol,) = effect.state_symbols().values()
    later = np.minimum(np.arange(1, len(end.value) + 1), len(end.value) - 1)
    return {symbol: Traced(end.value[later], end.tangent[:, later])}


def _advanced(effect: Effect, along: Along, command: Traced) -> tuple[Traced, Traced]:
    """The effect's state at the rows and its average over the hold of each."""
    scan = compiled(_stage_source(effect), "stage")
    tangent = np.ascontiguousarray(command.tangent)
    end, dend = np.empty_like(command.value), np.empty_like(tangent)
    mean, dmean = np.empty_like(command.value), np.empty_like(tangent)
    scan(
        along.step,
        columns_of(effect, along.columns),
        *[along.values[s] for s in effect.symbols().values()],
        *[along.signals[SIGNALS[n]].value for n in _used(effect)],
        tangent,
        end,
        dend,
        mean,
        dmean,
    )
    return Traced(end, dend), Traced(mean, dmean)


def _used_by_shape(effect: Effect) -> list[str]:
    """Signals of a shape's laws besides those that its scan has in any case."""
    return [n for n in _used(effect) if n not in ("velocity", "level")]


def _shape_module(
    effect: Effect,
    names: Names,
    *,
    start: list[str],
    advance: list[str],
    slope: sp.Expr,
    weights: list[str],
    tangents: list[str],
    moved: str,
) -> str:
    """Source of the bounds of a shape's friction, and of their tangents, at each sample.

    start: its states at rest;  advance: how a sample moves them on;  slope: force by position
    weights: slopes of the force by the states, once for all columns
    tangents: how column j of the states' tangents moves on;  moved: what they change of the force
    """
    law, used = effect.expression(), _used_by_shape(effect)
    by = _slopes_by(effect, "level")
    arguments = [*(names[s] for s in effect.symbols().values()), *(f"{n}_" for n in used)]
    return f"""{_HEAD}

@jitted
def shape(h, half_step, columns, position, velocity, direction, {", ".join(arguments)},
          forward, dforward, backward, dbackward, low, dlow, high, dhigh):
    p, n = dforward.shape
{indented(start, 4)}
    for k in range(n):
        u_velocity = (position[k] - position[max(k - 1, 0)]) / h
        ahead = u_velocity >= 0.0
        u_level = max(forward[k] if ahead else backward[k], 1e-12)
{indented([f"u_{n} = {n}_[k]" for n in used], 8)}
{indented(advance, 8)}
        u_velocity = velocity[k]
{indented(assignments({"force": law, "slope": slope}, names), 8)}
{indented(weights, 8)}
{indented(_lines("f", law, by, names) + _lines("g", slope, by, names), 8)}
        # where the reading cannot tell a motion, the position is open by half a step
        free = half_step if direction[k] == 0 else 0.0
        below = force - free * abs(slope)
        above = force + free * abs(slope)
        low[k] = below if direction[k] != 0 else max(below, -backward[k])
        high[k] = above if direction[k] != 0 else min(above, forward[k])
        for j in range(p):
            dlevel = dforward[j, k] if ahead else dbackward[j, k]
{indented(tangents, 12)}
            df = {moved} + f_level * dlevel + {_by_parameter(effect, "f")}
            dg = free * copysign(1.0, slope) * (g_level * dlevel + {_by_parameter(effect, "g")})
            dlow[j, k] = df - dg if low[k] == below else -dbackward[j, k]
            dhigh[j, k] = df + dg if high[k] == above else dforward[j, k]
"""


@lru_cache(maxsize=64)
def _shape_source(effect: Effect) -> str:
    """Of a shape with one state, whose rate is affine in it: exact over each sample."""
    state, a, b = _affine(effect)
    names, by = _names(effect), _slopes_by(effect, "level")
    return _shape_module(
        effect,
        names,
        start=["dz = np.zeros(p)", "z = 0.0"],
        advance=[
            *assignments({"a": a, "b": b}, names),
            *_lines("a", a, by, names),
            *_lines("b", b, by, names),
            "e, p1, p2, p3 = phi(a * h)",
            "s1 = p1 - p2",
            "before = z",
            "z = before * e + b * h * p1",
            f"{_STATE} = z",
        ],
        slope=sp.diff(effect.expression(), state),
        weights=[],
        tangents=[
            f"da = a_level * dlevel + {_by_parameter(effect, 'a')}",
            f"db = b_level * dlevel + {_by_parameter(effect, 'b')}",
            "dz[j] = dz[j] * e + before * e * h * da + h * p1 * db + b * h * s1 * h * da",
        ],
        moved="slope * dz[j]",
    )


def _stop_lines(count: int) -> list[str]:
    """Code that moves each state on by its rate, up to its stop."""
    lines: list[str] = []
    for i in range(count):
        lines += [
            f"stop_{i} = max(s{i}, 0.0)",
            f"z_{i} += h * r{i}",
            f"held_{i} = abs(z_{i}) > stop_{i}",
            f"z_{i} = copysign(stop_{i}, z_{i}) if held_{i} else z_{i}",
        ]
    return lines


def _stop_tangents(effect: Effect) -> list[str]:
    """Code of column j of each state's tangents: those of its stop where it is held there."""
    lines: list[str] = []
    for i in range(len(effect.states)):
        by_stop = f"s{i}_level * dlevel + {_by_parameter(effect, f's{i}')}"
        by_rate = f"r{i}_level * dlevel + {_by_parameter(effect, f'r{i}')}"
        lines += [
            f"if held_{i}:",
            f"    dz[{i}, j] = copysign(1.0, z_{i}) * ({by_stop})",
            "else:",
            f"    dz[{i}, j] += h * ({by_rate})",
        ]
    return lines


@lru_cache(maxsize=64)
def _stopped_source(effect: Effect) -> str:
    """Of a shape whose states follow the motion alone, each up to its stop: exact in each step."""
    stops, states = effect.stops(), list(effect.state_symbols().values())
    if len(stops) < len(states) or any(r.has(*states) or s.has(*states) for r, s in stops.values()):
        raise ModelError(f"{effect.name}: states with a stop beside others, or that need others")
    law, m = effect.expression(), len(states)
    names = {**_names(effect), **{z: f"z_{i}" for i, z in enumerate(states)}}
    by = _slopes_by(effect, "level")
    laws = {f"r{i}": rate for i, (rate, _) in enumerate(stops.values())}
    laws |= {f"s{i}": stop for i, (_, stop) in enumerate(stops.values())}
    velocity = SIGNALS["velocity"]
    slopes = [line for name, one in laws.items() for line in _lines(name, one, by, names)]
    return _shape_module(
        effect,
        names,
        start=[f"dz = np.zeros(({m}, p))", *(f"z_{i} = 0.0" for i in range(m))],
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
    """Source of a shape's bounds, and the signals besides that it is called with."""
    source = _stopped_source(effect) if effect.stops() else _shape_source(effect)
    return source, tuple(_used_by_shape(effect))


def shape_bounds(
    effect: Effect, motion: Motion, along: Along, *, forward: Traced, backward: Traced
) -> tuple[Traced, Traced]:
    """Bounds of the friction of a shape, driven by the measured motion.

    It has one hidden state, or several that each follow the motion up to a separate stop.

    forward, backward: friction level that way
    They coincide where the motion is sure; where it is not, they lie apart by what half a step of
    the position means to the bristle, and no further than the level.
    """
    source, used = _shape_of(effect)
    scan = compiled(source, "shape")
    low, high = np.empty_like(forward.value), np.empty_like(forward.value)
    dlow, dhigh = np.empty(forward.tangent.shape), np.empty(forward.tangent.shape)
    scan(
        along.step,
        0.5 * motion.step,
        columns_of(effect, along.columns),
        motion.position,
        motion.velocity,
        motion.direction,
        *[along.values[s] for s in effect.symbols().values()],
        *[along.signals[SIGNALS[n]].value for n in used],
        forward.value,
        np.ascontiguousarray(forward.tangent),
        backward.value,
        np.ascontiguousarray(backward.tangent),
        low,
        dlow,
        high,
        dhigh,
    )
    return Traced(low, dlow), Traced(high, dhigh)
