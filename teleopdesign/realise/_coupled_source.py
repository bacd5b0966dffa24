"""Source of the loop that integrates the coupled hidden states of an effect along a motion.

It is written from the rates, corrections and dry friction that the effect declares. `scan.py`
describes the steps, and runs them;  names in the code are those of `_scan_source.py`.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import sympy as sp

from ..effects import UNEXPLAINED, Effect
from ._scan_source import LEFT, ScanLaws, laws_of, list_drivers, list_traced, read_parameters
from .compiled import head
from .laws import indent


def _laws(effect: Effect) -> ScanLaws:
    return laws_of(effect, list_drivers(effect), "d_{i}")


def _write_stage_signals(effect: Effect) -> list[str]:
    """Code of the signals u and the states z in a stage; signals of corrections come last."""
    drivers = len(list_drivers(effect)) + (3 if effect.corrections() else 0)
    lines = []
    for i in range(drivers):
        lines += [
            f"bend = (1.0 - here) * bends[0, {i}, k] - here * bends[1, {i}, k]",
            f"chord = u[{i}, k + 1] - u[{i}, k]",
            f"u_{i} = u[{i}, k] + here * (chord + (1.0 - here) * bend)",
        ]
    return [
        *lines,
        *(f"z_{i} = z[{i}] + ahead * f[before, {i}]" for i in range(len(effect.states))),
    ]


def _write_left(effect: Effect) -> tuple[list[str], list[str]]:
    """Code of the force that is left unexplained beyond the bounds of friction, and of its tangent.

    bound: 1 or 2 for the lower or upper bound that the force exceeds, 0 for neither
    """
    law, first = effect.expression(), len(list_drivers(effect))
    lines, tangent = _laws(effect).with_tangent("by_law", law)
    needed, low, high = (f"u_{first + i}" for i in range(3))
    at = len(list_traced(list_drivers(effect)))
    return [
        *lines,
        f"{LEFT} = {needed} - by_law",
        f"bound = 1 if {LEFT} < {low} else 2 if {LEFT} > {high} else 0",
        f"{LEFT} = {LEFT} - ({low} if bound == 1 else {high}) if bound else 0.0",
    ], [
        f"d{LEFT} = 0.0",
        "if bound:",
        f"    needed = {_tangent_within(at)}",
        f"    d{LEFT} = needed - ({_tangent_within(f'{at} + bound')}) - ({tangent})",
    ]


def _tangent_within(signal: int | str) -> str:
    """Code of the tangent of a signal between two rows."""
    return f"du[{signal}, k, j] + here * (du[{signal}, k + 1, j] - du[{signal}, k, j])"


def _write_rates(effect: Effect) -> list[str]:
    """Code of f, the rates of the states, and of g, their tangents, in one stage."""
    count, laws, corrections = len(effect.states), _laws(effect), effect.corrections()
    lines: list[str] = []
    each = [f"d_{i} = d[{i}, j] + ahead * g[before, {i}, j]" for i in range(count)]
    each += _write_tangents(effect)
    if corrections:
        lines, tangents = _write_left(effect)
        each += tangents
        laws = replace(laws, by={**laws.by, UNEXPLAINED: f"d{LEFT}"})
    for i, (name, rate) in enumerate(effect.rates().items()):
        whole = rate + corrections.get(name, sp.S(0))
        rates, tangent = laws.with_tangent(f"by_{i}", whole)
        lines += [*rates, f"f[stage, {i}] = by_{i}"]
        each.append(f"g_{i} = {tangent}")
    # slopes are stored when all are known, because a state may depend on the slope of another
    each += [f"g[stage, {i}, j] = g_{i}" for i in range(count)]
    return [*lines, "for j in range(m):", *(f"    {line}" for line in each)]


def _write_tangents(effect: Effect) -> list[str]:
    """Code of the tangents of the signals in a stage."""
    return [
        f"du_{i} = {_tangent_within(t)}" for t, i in enumerate(list_traced(list_drivers(effect)))
    ]


def _write_dry(effect: Effect) -> list[str]:
    """Code of hold, the rates by which dry friction slows the states, and of their tangents."""
    places, laws = {n: i for i, n in enumerate(effect.states)}, _laws(effect)
    lines: list[str] = []
    for name, bound in effect.dry_bounds().items():
        i = places[name]
        most, tangent = laws.with_tangent(f"most_{i}", bound)
        lines += [
            *most,
            # half a step ahead, because the driving force changes: else a stuck state creeps
            f"wanted = z_{i} / w + 1.5 * f[0, {i}] - 0.5 * before_f[{i}]",
            f"within = abs(wanted) <= most_{i}",
            f"hold[{i}] = wanted if within else copysign(most_{i}, wanted)",
            "for j in range(m):",
            *(f"    d_{other} = d[{other}, j]" for other in range(len(places))),
            *(f"    {line}" for line in _write_tangents(effect)),
            "    if within:",
            f"        dhold[{i}, j] = d_{i} / w + 1.5 * g[0, {i}, j] - 0.5 * before_g[{i}, j]",
            "    else:",
            f"        dhold[{i}, j] = copysign(1.0, wanted) * ({tangent})",
        ]
    return lines


def _write_friction_of_stage(effect: Effect) -> list[str]:
    """Code that subtracts the rates of dry friction from those of a stage."""
    if not effect.dry_bounds():
        return []
    first = [
        "if step == 0 and k == 0:",
        "    before_f[:] = f[0]",
        "    before_g[:] = g[0]",
        *_write_dry(effect),
        "before_f[:] = f[0]",
        "before_g[:] = g[0]",
    ]
    first = ["if stage == 0:", *(f"    {line}" for line in first)]
    return [*first, "f[stage] -= hold", "g[stage] -= dhold"]


@lru_cache(maxsize=32)
def write_coupled(effect: Effect) -> str:
    """Source of `scan` for coupled states: `out` (s, n) and tangents `dout` (s, q, n) at the rows.

    u: signals (m, n), those of corrections last;  bends: their deviations from chords (2, m, n)
    du: tangents (t, n, q + 1) of the traced signals, and of those of corrections
    unit: tangents (p, q + 1) of the parameters; (p, 0) without tangents. The last column is a
        difference without input, whose growth is measured
    size, growth: size of a difference of states, and the growth at which tangents restart
    """
    signals, friction = _write_stage_signals(effect), _write_friction_of_stage(effect)
    stage = [*signals, *_write_rates(effect), *friction]
    return f"""{head("Generated from an effect's rates; do not edit.")}

@jitted
def scan(h, steps, p, unit, u, bends, du, size, growth, z, out, dout):
    n = u.shape[1]
    s, q = {len(effect.states)}, dout.shape[1]
{read_parameters(effect)}
    m = unit.shape[1]
    d = np.zeros((s, m))
    f = np.zeros((4, s))
    g = np.zeros((4, s, m))
    w = h / steps
    hold, dhold = np.zeros(s), np.zeros((s, m))
    before_f, before_g = np.zeros(s), np.zeros((s, m))
    if q:
        d[:, q] = size
    for k in range(n):
        grown = 0.0
        if q:
            for i in range(s):
                grown = max(grown, abs(d[i, q] / size[i]))
        if grown > growth:
            d[:] = 0.0
            d[:, q] = size
        elif 0.0 < grown < 1.0:  # a difference that decayed is restored to its first size
            d[:, q] /= grown
        for i in range(s):
            out[i, k] = z[i]
            for j in range(q):
                dout[i, j, k] = d[i, j]
        if k == n - 1:
            break
        for step in range(steps):
            for stage in range(4):
                part = 0.0 if stage == 0 else 1.0 if stage == 3 else 0.5
                here = (step + part) / steps
                ahead = part * w
                before = max(stage - 1, 0)
{indent(stage, 16)}
            for i in range(s):
                z[i] += w / 6 * (f[0, i] + 2 * f[1, i] + 2 * f[2, i] + f[3, i])
                for j in range(m):
                    d[i, j] += w / 6 * (
                        g[0, i, j] + 2 * g[1, i, j] + 2 * g[2, i, j] + g[3, i, j]
                    )
"""
