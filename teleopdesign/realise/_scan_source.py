"""Source of the loop over the samples of a motion that steps an effect's hidden states.

It is written from the rates that the effect declares, with their derivatives by states, signals and
parameters: here exact steps, in `_coupled_source.py` Runge-Kutta steps of states that depend on
each other. `scan.py` describes the steps, and runs them.

In the code, u_i is a signal, p_i a parameter, z_i a state; du_i, unit[i, j], and d[i, j] or d_i are
their tangents in column j.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import sympy as sp

from ..base.errors import ModelError
from ..effects import SIGNALS, UNEXPLAINED, Effect
from .compiled import PHI, head
from .laws import assignments, indent
from .traced import TRACED

#: velocity at the rows, in laws on states that follow a velocity of another kind
ROW_VELOCITY = sp.Symbol("row_velocity", real=True)
_SIGNALS = (*SIGNALS.values(), ROW_VELOCITY)


@lru_cache(maxsize=256)
def list_drivers(effect: Effect, more: tuple[sp.Expr, ...] = ()) -> tuple[sp.Symbol, ...]:
    """Signals that drive the effect's states, and those in further laws on them."""
    laws = [*effect.rates().values(), *effect.dry_bounds().values(), *more]
    if corrections := effect.corrections():
        laws += [*corrections.values(), effect.expression()]
    return tuple(s for s in _SIGNALS if any(law.has(s) for law in laws))


def list_traced(drivers: tuple[sp.Symbol, ...]) -> list[int]:
    """Places of the driving signals that have tangents."""
    return [i for i, s in enumerate(drivers) if s in TRACED]


@lru_cache(maxsize=256)
def list_parameters(effect: Effect) -> tuple[sp.Symbol, ...]:
    """The effect's parameters, and other symbols of its rates, such as an inertia."""
    of_effect = effect.symbols().values()
    laws = (
        *effect.rates().values(),
        *effect.corrections().values(),
        *effect.dry_bounds().values(),
    )
    known = {*of_effect, *_SIGNALS, *effect.state_symbols().values(), UNEXPLAINED}
    others = set().union(*(law.free_symbols for law in laws)) - known
    return (*of_effect, *sorted(others, key=str))


#: private name of the force that is left unexplained
LEFT = "left"


@dataclass(frozen=True)
class ScanLaws:
    """Laws of an effect as lines of code.

    names: states, parameters and signals -> local variables;  by: symbol -> code of its tangent in
        column j
    """

    names: Mapping[sp.Symbol, str]
    by: Mapping[sp.Symbol, str]

    def with_tangent(self, what: str, law: sp.Expr) -> tuple[list[str], str]:
        """Lines that compute a law and its derivatives, and the code of its tangent."""
        results, terms = {what: law}, []
        for i, (symbol, tangent) in enumerate(self.by.items()):
            if (slope := sp.diff(law, symbol)) != 0:
                results[f"{what}_{i}"] = slope
                terms.append(f"{what}_{i} * {tangent}")
        return assignments(results, self.names), " + ".join(terms) or "0.0"


def laws_of(effect: Effect, drivers: tuple[sp.Symbol, ...], state: str) -> ScanLaws:
    """The laws on these signals;  state: code of the tangent of state {i}."""
    states, parameters = effect.state_symbols().values(), list_parameters(effect)
    names = {s: f"z_{i}" for i, s in enumerate(states)} | {UNEXPLAINED: LEFT}
    names |= {s: f"p_{i}" for i, s in enumerate(parameters)}
    names |= {s: f"u_{i}" for i, s in enumerate(drivers)}
    by = {s: state.format(i=i) for i, s in enumerate(states)}
    by |= {drivers[i]: f"du_{i}" for i in list_traced(drivers)}
    by |= {s: f"unit[{i}, j]" for i, s in enumerate(parameters)}
    return ScanLaws(names, by)


def read_parameters(effect: Effect) -> str:
    """Lines that read the parameters."""
    return indent([f"p_{i} = p[{i}]" for i in range(len(list_parameters(effect)))], 4)


@dataclass(frozen=True)
class _Step:
    """Code of exact steps: start of the states, once before all samples, and a step; in columns."""

    start: list[str] = field(default_factory=list)
    start_column: list[str] = field(default_factory=list)
    once: list[str] = field(default_factory=list)
    each: list[str] = field(default_factory=list)
    column: list[str] = field(default_factory=list)


@lru_cache(maxsize=64)
def write_exact(effect: Effect, wanted: tuple[sp.Expr, ...]) -> str:
    """Source of `scan`: laws on states with stops, or on one with an affine rate.

    They start at `part` of where they stay: at their stops, or where their rates are zero.
    wanted: laws at the end of each sample; (): the average of the only state over it
    u: signals (m, n), du: tangents (t, n, q) of the traced ones;  first, dfirst: the first sample
    unit: tangents (p, q) of the parameters;  out, dout: laws (o, n), tangents (o, q, n)
    """
    drivers = list_drivers(effect, wanted)
    laws, traced = laws_of(effect, drivers, "d[{i}, j]"), list_traced(drivers)
    step = _stopped_step(effect, laws) if effect.stops() else _affine_step(effect, laws)
    for i, law in enumerate(wanted):
        values, tangent = laws.with_tangent(f"law{i}", law)
        step.each.extend([*values, f"out[{i}, k] = law{i}"])
        step.column.append(f"dout[{i}, j, k] = {tangent}")
    if not wanted:
        tangent = "dbefore * p1 + before * s1 * h * da + h * p2 * db + b * h * s2 * h * da"
        step.each.extend(["out[0, k] = before * p1 + b * h * p2", "s2 = p2 - 2.0 * p3"])
        step.column.append(f"dout[0, j, k] = {tangent}")
    return f"""{head("Generated from an effect's rates; do not edit.")}{PHI}

@jitted
def scan(h, part, dpart, p, unit, first, dfirst, u, du, out, dout):
{read_parameters(effect)}
    q = dout.shape[1]
    d = np.zeros(({len(effect.states)}, q))
{indent([f"u_{i} = first[{i}]" for i in range(len(drivers))], 4)}
{indent(step.start, 4)}
    for j in range(q):
{indent([f"du_{i} = dfirst[{t}, j]" for t, i in enumerate(traced)], 8)}
{indent(step.start_column, 8)}
{indent(step.once, 4)}
    for k in range(out.shape[1]):
{indent([f"u_{i} = u[{i}, k]" for i in range(len(drivers))], 8)}
{indent(step.each, 8)}
        for j in range(q):
{indent([f"du_{i} = du[{t}, k, j]" for t, i in enumerate(traced)], 12)}
{indent(step.column, 12)}
"""


def affine_rate(effect: Effect) -> tuple[sp.Expr, sp.Expr]:
    """A and B of the rate A z + B of the effect's only state z.

    raises ModelError: another number of states, or a rate that is not affine
    """
    if len(effect.states) != 1:
        raise ModelError(f"{effect.name}: {len(effect.states)} states in one scan; one is possible")
    (name,) = effect.states
    z, rate = effect.state_symbols()[name], effect.rates()[name]
    slope = sp.diff(rate, z)
    if slope.has(z):
        raise ModelError(f"{effect.name}: the rate of {name} must be affine in {name}")
    return slope, rate.subs(z, 0)


def _affine_step(effect: Effect, laws: ScanLaws) -> _Step:
    """Exact step of one state with an affine rate."""
    a, b = affine_rate(effect)
    (rate_a, da), (rate_b, db) = laws.with_tangent("a", a), laws.with_tangent("b", b)
    tangents = [f"da = {da}", f"db = {db}"]
    factors = ["e, p1, p2, p3 = phi(a * h)", "s1 = p1 - p2"]  # d phi_1/dz
    # a lag with a constant rate: one exponential for all samples
    each = any(a.has(s) for s in SIGNALS.values())
    return _Step(
        # a state that nothing limits starts at zero
        [*rate_a, *rate_b, "steady = -b / a if a != 0.0 else 0.0", "z_0 = part * steady"],
        [
            *tangents,
            "d[0, j] = dpart[j] * steady",
            "d[0, j] -= part * (db + steady * da) / a if a != 0.0 else 0.0",
        ],
        [] if each else factors,
        [
            *([*rate_a, *factors] if each else []),
            *rate_b,
            "before = z_0",
            "z_0 = before * e + b * h * p1",
        ],
        [
            *tangents,
            "dbefore = d[0, j]",
            "d[0, j] = dbefore * e + before * e * h * da + h * p1 * db + b * h * s1 * h * da",
        ],
    )


def _stopped_step(effect: Effect, laws: ScanLaws) -> _Step:
    """Step of states that follow the motion, each up to its stop.

    raises ModelError: some states have no stop, or a state depends on others
    """
    stops = effect.stops()
    states = list(effect.state_symbols().values())
    if len(stops) < len(states) or any(r.has(*states) or s.has(*states) for r, s in stops.values()):
        raise ModelError(f"{effect.name}: states with a stop beside others, or that need others")
    step = _Step()
    for i, (rate, stop) in enumerate(stops.values()):
        (rates, dr), (ends, ds) = laws.with_tangent(f"r{i}", rate), laws.with_tangent(f"s{i}", stop)
        step.start.extend([*ends, f"z_{i} = part * max(s{i}, 0.0)"])
        step.start_column.append(f"d[{i}, j] = dpart[j] * s{i} + part * ({ds})")
        step.each.extend(
            [
                *rates,
                *ends,
                f"stop_{i} = max(s{i}, 0.0)",
                f"z_{i} += h * r{i}",
                f"held_{i} = abs(z_{i}) > stop_{i}",
                # a sliding element stays at its stop: its force does not grow with travel
                f"z_{i} = copysign(stop_{i}, z_{i}) if held_{i} else z_{i}",
            ]
        )
        step.column.extend(
            [
                f"if held_{i}:",
                f"    d[{i}, j] = copysign(1.0, z_{i}) * ({ds})",
                "else:",
                f"    d[{i}, j] += h * ({dr})",
            ]
        )
    return step
