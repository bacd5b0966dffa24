"""Hidden states along a measured motion: one loop over the samples, generated from their rates.

A state whose rate is affine in it, dz/dt = A z + B, advances exactly over a sample in which its
signals are held: z(t + h) = e^x z + h phi_1(x) B with x = A h; the average over the sample is
phi_1(x) z + h phi_2(x) B. A state with a stop follows its rate up to the stop. Tangents follow by
differentiating the same expressions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
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


def signals_in(effect: Effect) -> list[str]:
    """Names of the signals in the effect's law and the rates of its states."""
    laws = (effect.expression(), *effect.rates().values())
    return [n for n, s in SIGNALS.items() if any(law.has(s) for law in laws)]


def write_tangent(
    what: str, law: sp.Expr, by: Mapping[sp.Symbol, str], names: Names
) -> tuple[list[str], str]:
    """Lines that compute the derivatives of a law, and the code of its tangent in one column.

    what: name of the law in the code;  by: symbol -> code of the symbol's tangent in that column
    """
    lines, terms = [], []
    for i, (symbol, tangent) in enumerate(by.items()):
        if (slope := sp.diff(law, symbol)) != 0:
            lines += assignments({f"{what}_{i}": slope}, names)
            terms.append(f"{what}_{i} * {tangent}")
    return lines, " + ".join(terms) or "0.0"


@dataclass(frozen=True)
class SampleLoop:
    """A loop over n samples, with p columns of tangents: how it reads signals, what it writes.

    arguments: arrays besides parameters and signals that are read as they are
    start, row: lines that read signals, before the first sample and in sample k
    at_start, at_row: code of column j of the driver's tangent there
    each, column: lines after the step of the states z_i (affine: `before` is z before it); those of
        column j follow that of their tangents dz[i, j] (affine: `dbefore`)
    """

    arguments: Sequence[str]
    start: Sequence[str]
    row: Sequence[str]
    at_start: str
    at_row: str
    each: Sequence[str]
    column: Sequence[str]


@dataclass(frozen=True)
class Scan:
    """The states of an effect in a loop over samples.

    driver: the signal with tangents;  signals: those that are read as they are, by their names
    """

    effect: Effect
    driver: str
    signals: tuple[str, ...]

    @property
    def names(self) -> dict[sp.Symbol, str]:
        """Symbols of signals, parameters and states -> private names."""
        states = {s: f"z_{i}" for i, s in enumerate(self.effect.state_symbols().values())}
        parameters = {s: f"p_{i}" for i, s in enumerate(self.effect.symbols().values())}
        return {s: f"u_{n}" for n, s in SIGNALS.items()} | parameters | states

    @property
    def by(self) -> dict[sp.Symbol, str]:
        """The driver and the parameters -> code of their tangents."""
        symbols = enumerate(self.effect.symbols().values())
        by_parameter = {s: f"(columns[{i}] == j)" for i, s in symbols}
        return {SIGNALS[self.driver]: f"d{self.driver}"} | by_parameter

    def tangent(self, what: str, law: sp.Expr) -> tuple[list[str], str]:
        """As `write_tangent`, by the driver and the parameters."""
        return write_tangent(what, law, self.by, self.names)

    def values(self, laws: Mapping[str, sp.Expr]) -> list[str]:
        """Lines that compute laws under these names."""
        return assignments(laws, self.names)

    def read(self, k: str) -> list[str]:
        """Lines that read the signals in sample k."""
        return [f"u_{n} = {n}_[{k}]" for n in self.signals]

    def source(self, loop: SampleLoop) -> str:
        """The module whose function `scan` runs the loop.

        The states start at `part` of where they stay: at their stops, or where their rates are zero
        """
        step = _stopped_step(self) if self.effect.stops() else _affine_step(self)
        parameters = [self.names[s] for s in self.effect.symbols().values()]
        arguments = [*parameters, *(f"{n}_" for n in self.signals), *loop.arguments]
        return f"""{head("Generated from an effect's law; do not edit.")}{PHI}

@jitted
def scan(h, columns, part, dpart, {", ".join(arguments)}):
    p, n = dpart.size, {loop.arguments[-1]}.shape[1]
{indent(loop.start, 4)}
{indent(step.start, 4)}
    dz = np.zeros(({len(self.effect.states)}, p))
    for j in range(p):
        d{self.driver} = {loop.at_start}
{indent(step.start_column, 8)}
{indent(step.once, 4)}
    for k in range(n):
{indent(loop.row, 8)}
{indent(step.each, 8)}
{indent(loop.each, 8)}
        for j in range(p):
            d{self.driver} = {loop.at_row}
{indent(step.column, 12)}
{indent(loop.column, 12)}
"""


@dataclass(frozen=True)
class _Step:
    """Code of the states: their start, once before all samples, and their step over a sample."""

    start: list[str]
    start_column: list[str]
    once: list[str]
    each: list[str]
    column: list[str]


def _affine_step(scan: Scan) -> _Step:
    """Exact step of one state with an affine rate."""
    _, a, b = affine_rate(scan.effect)
    (slopes_a, da), (slopes_b, db) = scan.tangent("a", a), scan.tangent("b", b)
    rate_a, rate_b = [*scan.values({"a": a}), *slopes_a], [*scan.values({"b": b}), *slopes_b]
    tangents = [f"da = {da}", f"db = {db}"]
    factors = ["e, p1, p2, p3 = phi(a * h)", "s1 = p1 - p2"]  # d phi_1/dz
    # a lag with a constant rate: one exponential for all samples
    each = any(a.has(s) for s in SIGNALS.values())
    return _Step(
        # a state that nothing limits starts at zero
        [*rate_a, *rate_b, "steady = -b / a if a != 0.0 else 0.0", "z_0 = part * steady"],
        [
            *tangents,
            "dz[0, j] = dpart[j] * steady",
            "dz[0, j] -= part * (db + steady * da) / a if a != 0.0 else 0.0",
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
            "dbefore = dz[0, j]",
            "dz[0, j] = dbefore * e + before * e * h * da + h * p1 * db + b * h * s1 * h * da",
        ],
    )


def _stopped_step(scan: Scan) -> _Step:
    """Step of states that follow the motion, each up to its stop.

    raises ModelError: some states have no stop, or a state depends on others
    """
    effect, stops = scan.effect, scan.effect.stops()
    states = list(effect.state_symbols().values())
    if len(stops) < len(states) or any(r.has(*states) or s.has(*states) for r, s in stops.values()):
        raise ModelError(f"{effect.name}: states with a stop beside others, or that need others")
    step = _Step([], [], [], [], [])
    for i, (rate, stop) in enumerate(stops.values()):
        (slopes_r, dr), (slopes_s, ds) = scan.tangent(f"r{i}", rate), scan.tangent(f"s{i}", stop)
        laws = [*scan.values({f"r{i}": rate, f"s{i}": stop}), *slopes_r, *slopes_s]
        step.start.extend([*laws, f"z_{i} = part * max(s{i}, 0.0)"])
        step.start_column.append(f"dz[{i}, j] = dpart[j] * s{i} + part * ({ds})")
        step.each.extend(
            [
                *laws,
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
                f"    dz[{i}, j] = copysign(1.0, z_{i}) * ({ds})",
                "else:",
                f"    dz[{i}, j] += h * ({dr})",
            ]
        )
    return step


def columns_of(effect: Effect, columns: TangentColumns) -> Array:
    """Row of the tangents for each parameter of the effect; -1 where there is none."""
    return np.array([columns.places.get(s, -1) for s in effect.symbols().values()], dtype=int)


def contiguous(tangent: Array) -> Array:
    """Tangents (p, n) as contiguous, writable memory, as compiled kernels require."""
    return np.require(tangent, requirements=("C", "W"))


@lru_cache(maxsize=64)
def _source_of_stage(effect: Effect) -> str:
    """Source of a loop whose state begins steady: at the rows, and averaged over each sample."""
    scan = Scan(effect, "command", tuple(signals_in(effect)))
    return scan.source(
        SampleLoop(
            arguments=("dcommand_", "end", "dend", "mean", "dmean"),
            start=scan.read("0"),
            row=scan.read("k"),
            at_start="dcommand_[j, 0]",
            at_row="dcommand_[j, k]",
            each=["end[k] = before", "mean[k] = before * p1 + b * h * p2", "s2 = p2 - 2.0 * p3"],
            column=[
                "dend[j, k] = dbefore",
                "dmean[j, k] = dbefore * p1 + before * s1 * h * da + h * p2 * db"
                " + b * h * s2 * h * da",
            ],
        )
    )


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
    tangent = contiguous(command.tangent)
    end, dend = np.empty_like(command.value), np.empty_like(tangent)
    mean, dmean = np.empty_like(command.value), np.empty_like(tangent)
    places = columns_of(effect, along.columns)
    compile_source(_source_of_stage(effect), "scan")(
        along.step,
        places,
        1.0,
        np.zeros(len(tangent)),
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
