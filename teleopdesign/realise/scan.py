"""Hidden states along a measured motion: loops over the samples, generated from the effects' rates.

A state whose rate is affine in it, dz/dt = A z + B, advances exactly over a sample in which its
signals are held: z(t + h) = e^x z + h phi_1(x) B with x = A h; the average over the sample is
phi_1(x) z + h phi_2(x) B. Tangents follow by differentiating the same expressions.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..effects import SIGNALS, Effect
from ..measurement.filtering import Array
from .compiled import PHI, compile_source, head
from .laws import Names, assignments, indent
from .tangent_columns import TangentColumns
from .traced import Along, Traced, joined_rows

HEAD = head("Generated from an effect's law; do not edit.") + PHI
#: private name of the effect's one state
STATE = "z_0"


def affine_rate(effect: Effect) -> tuple[sp.Symbol, sp.Expr, sp.Expr]:
    """The effect's only state z, with A and B of its rate A z + B.

    raises ModelError: another number of states, or a rate that is not affine
    """
    if len(effect.states) != 1:
        raise ModelError(f"{effect.name}: {len(effect.states)} states in one scan; one is possible")
    (name,) = effect.states
    z, rate = effect.state_symbols()[name], effect.rates()[name]
    slope = sp.diff(rate, z)
    if slope.has(z):
        raise ModelError(f"{effect.name}: the rate of {name} must be affine in {name}")
    return z, slope, rate.subs(z, 0)


def names_in_source(effect: Effect) -> dict[sp.Symbol, str]:
    """Symbols of signals, parameters and the state -> private names."""
    signals = {s: f"u_{n}" for n, s in SIGNALS.items()}
    parameters = {s: f"p_{i}" for i, s in enumerate(effect.symbols().values())}
    return signals | parameters | dict.fromkeys(effect.state_symbols().values(), STATE)


def slope_lines(
    what: str, expression: sp.Expr, by: dict[str, sp.Symbol], names: Names
) -> list[str]:
    """Code of the derivatives of an expression by signals and parameters.

    what: name of the expression;  by: key -> symbol, for variables `what_key`
    """
    return assignments({f"{what}_{k}": sp.diff(expression, s) for k, s in by.items()}, names)


def signals_in(effect: Effect) -> list[str]:
    """Names of the signals in the effect's law and the rates of its states."""
    laws = (effect.expression(), *effect.rates().values())
    return [n for n, s in SIGNALS.items() if any(law.has(s) for law in laws)]


def slopes_by(effect: Effect, signal: str) -> dict[str, sp.Symbol]:
    """Key -> symbol of the derivatives: one signal, and the parameters by their number."""
    parameters = {str(i): s for i, s in enumerate(effect.symbols().values())}
    return {signal: SIGNALS[signal], **parameters}


def slope_of_column(effect: Effect, what: str) -> str:
    """Code of the derivative by the parameter that belongs to column j."""
    terms = (f"{what}_{i} * (columns[{i}] == j)" for i in range(len(effect.parameters)))
    return " + ".join(terms) or "0.0"


@lru_cache(maxsize=64)
def _stage_source(effect: Effect) -> str:
    _, a, b = affine_rate(effect)
    used, names = signals_in(effect), names_in_source(effect)
    by = slopes_by(effect, "command")
    parameters = [names[s] for s in effect.symbols().values()]
    step = [
        *assignments({"a": a}, names),
        *slope_lines("a", a, by, names),
        "e, p1, p2, p3 = phi(a * h)",
        "s1 = p1 - p2",
        "s2 = p2 - 2.0 * p3",
    ]
    # a lag with a constant rate: one exponential for all samples
    each = any(a.has(SIGNALS[n]) for n in used)
    return f"""{HEAD}

@jitted
def stage(h, columns, {", ".join([*parameters, *(f"{n}_" for n in used)])}, dcommand,
          end, dend, mean, dmean):
    p, n = dcommand.shape
    dz = np.zeros(p)
    {STATE} = 0.0
{indent([] if each else step, 4)}
    for k in range(n):
{indent([f"u_{n} = {n}_[k]" for n in used], 8)}
{indent(step if each else [], 8)}
{indent(assignments({"b": b}, names), 8)}
        starting = k == 0 and a != 0.0
        if starting:
            {STATE} = -b / a  # steady
{indent(slope_lines("b", b, by, names), 8)}
        z = {STATE}
        mean[k] = z * p1 + b * h * p2
        end[k] = z
        for j in range(p):
            da = a_command * dcommand[j, k] + {slope_of_column(effect, "a")}
            db = b_command * dcommand[j, k] + {slope_of_column(effect, "b")}
            if starting:
                dz[j] = (b * da / a - db) / a
            dmean[j, k] = dz[j] * p1 + z * s1 * h * da + h * p2 * db + b * h * s2 * h * da
            dend[j, k] = dz[j]
            dz[j] = dz[j] * e + z * e * h * da + h * p1 * db + b * h * s1 * h * da
        {STATE} = z * e + b * h * p1
"""


def columns_of(effect: Effect, columns: TangentColumns) -> Array:
    """Row of the tangents for each parameter of the effect; -1 where there is none."""
    return np.array([columns.places.get(s, -1) for s in effect.symbols().values()], dtype=int)


def contiguous(tangent: Array) -> Array:
    """Tangents (p, n) as contiguous, writable memory, as compiled kernels require."""
    return np.require(tangent, requirements=("C", "W"))


def stage_scan(effect: Effect, along: Along) -> dict[sp.Symbol, Traced]:
    """State of an actuation stage, as its average over the hold of each row, with tangents."""
    _, mean = _advance(effect, along, along.signals[SIGNALS["command"]])
    (symbol,) = effect.state_symbols().values()
    return {symbol: mean}


def driven_scan(effect: Effect, along: Along) -> dict[sp.Symbol, Traced]:
    """State that the measured motion drives, at the rows, with tangents.

    The motion at a row stands for the sample before it, so without a lag the state is not delayed.
    """
    end, _ = _advance(effect, along, along.signals[SIGNALS["velocity"]])
    (symbol,) = effect.state_symbols().values()
    later = np.minimum(np.arange(1, len(end.value) + 1), len(end.value) - 1)
    return {symbol: Traced(end.value[later], end.tangent[:, later], end.moving)}


def _advance(effect: Effect, along: Along, command: Traced) -> tuple[Traced, Traced]:
    """The effect's state at the rows, and its average over the hold of each row."""
    scan = compile_source(_stage_source(effect), "stage")
    tangent = contiguous(command.tangent)
    end, dend = np.empty_like(command.value), np.empty_like(tangent)
    mean, dmean = np.empty_like(command.value), np.empty_like(tangent)
    places = columns_of(effect, along.columns)
    scan(
        along.step,
        places,
        *[along.values[s] for s in effect.symbols().values()],
        *[along.signals[SIGNALS[n]].value for n in signals_in(effect)],
        tangent,
        end,
        dend,
        mean,
        dmean,
    )
    moving = joined_rows(command, more=places[places >= 0].tolist())
    return Traced(end, dend, moving), Traced(mean, dmean, moving)
