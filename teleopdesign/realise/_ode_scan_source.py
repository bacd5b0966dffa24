"""Source of the loop that integrates an effect's coupled hidden states along a measured motion.

It is written from the rates, corrections and dry friction that the effect declares, with their
derivatives by states and parameters. `ode_scan.py` describes the loop, and runs it.
"""

from __future__ import annotations

from functools import lru_cache

import sympy as sp

from ..effects import SIGNALS, UNEXPLAINED, Effect
from .compiled import head
from .laws import assignments, indent, source_of
from .scan import write_tangent


@lru_cache(maxsize=256)
def list_drivers(effect: Effect) -> list[str]:
    """Names of the measured signals that drive the effect's states."""
    laws = [*effect.rates().values(), *effect.dry_bounds().values()]
    if corrections := effect.corrections():
        laws += [*corrections.values(), effect.expression()]
    return [n for n, s in SIGNALS.items() if any(law.has(s) for law in laws)]


@lru_cache(maxsize=256)
def list_parameters(effect: Effect) -> tuple[sp.Symbol, ...]:
    """The effect's parameters, and other symbols of its rates, such as an inertia."""
    of_effect = effect.symbols().values()
    laws = (
        *effect.rates().values(),
        *effect.corrections().values(),
        *effect.dry_bounds().values(),
    )
    known = {*of_effect, *SIGNALS.values(), *effect.state_symbols().values(), UNEXPLAINED}
    others = set().union(*(law.free_symbols for law in laws)) - known
    return (*of_effect, *sorted(others, key=str))


#: private name of the force that is left unexplained
_LEFT = "left"


def _name_symbols(effect: Effect) -> dict[sp.Symbol, str]:
    """States, parameters and signals -> local variables of the code."""
    states = {s: f"z_{i}" for i, s in enumerate(effect.state_symbols().values())}
    parameters = {s: f"p_{i}" for i, s in enumerate(list_parameters(effect))}
    signals = {SIGNALS[d]: f"u_{i}" for i, d in enumerate(list_drivers(effect))}
    return states | parameters | signals | {UNEXPLAINED: _LEFT}


def _tangents(effect: Effect) -> dict[sp.Symbol, str]:
    """States and parameters -> code of their tangents in column c."""
    states = {s: f"d_{i}" for i, s in enumerate(effect.state_symbols().values())}
    return states | {s: f"unit[{i}, c]" for i, s in enumerate(list_parameters(effect))}


def _write_stage_signals(effect: Effect) -> list[str]:
    """Code of the signals u and the states z in a stage; signals of corrections come last."""
    drivers = len(list_drivers(effect)) + (3 if effect.corrections() else 0)
    lines = []
    for i in range(drivers):
        lines += [
            f"bend = (1.0 - here) * bends[0, {i}, k] - here * bends[1, {i}, k]",
            f"chord = drive[{i}, k + 1] - drive[{i}, k]",
            f"u_{i} = drive[{i}, k] + here * (chord + (1.0 - here) * bend)",
        ]
    return [
        *lines,
        *(f"z_{i} = z[{i}] + ahead * f[before, {i}]" for i in range(len(effect.states))),
    ]


def _write_left(effect: Effect) -> list[str]:
    """Code of the force that is left unexplained beyond the bounds of friction.

    bound: 1 or 2 for the lower or upper bound that the force exceeds, 0 for neither
    """
    law, names, first = effect.expression(), _name_symbols(effect), len(list_drivers(effect))
    needed, low, high = (f"u_{first + i}" for i in range(3))
    return [
        f"{_LEFT} = {needed} - ({source_of(law, names)})",
        f"bound = 1 if {_LEFT} < {low} else 2 if {_LEFT} > {high} else 0",
        f"{_LEFT} = {_LEFT} - ({low} if bound == 1 else {high}) if bound else 0.0",
    ]


def _write_rates(effect: Effect) -> list[str]:
    """Code of f, the rates of the states, and of g, their tangents, in one stage."""
    count, names, by = len(effect.states), _name_symbols(effect), _tangents(effect)
    corrections = effect.corrections()
    lines: list[str] = []
    each = [f"d_{i} = d[{i}, c] + ahead * g[before, {i}, c]" for i in range(count)]
    if corrections:
        slopes, tangent = write_tangent("by_law", effect.expression(), by, names)
        lines += [*_write_left(effect), *slopes]
        each += [
            f"d{_LEFT} = 0.0",
            "if bound:",
            "    needed = ddrive[0, k, c] + here * (ddrive[0, k + 1, c] - ddrive[0, k, c])",
            "    step_of = ddrive[bound, k + 1, c] - ddrive[bound, k, c]",
            f"    d{_LEFT} = needed - (ddrive[bound, k, c] + here * step_of) - ({tangent})",
        ]
        by = by | {UNEXPLAINED: f"d{_LEFT}"}
    for i, (name, rate) in enumerate(effect.rates().items()):
        whole = rate + corrections.get(name, sp.S(0))
        slopes, tangent = write_tangent(f"by_{i}", whole, by, names)
        lines += [*assignments({f"f[stage, {i}]": whole}, names), *slopes]
        each.append(f"g_{i} = {tangent}")
    # slopes are stored when all are known, because a state may depend on the slope of another
    each += [f"g[stage, {i}, c] = g_{i}" for i in range(count)]
    return [*lines, "for c in range(m):", *(f"    {line}" for line in each)]


def _write_dry(effect: Effect) -> list[str]:
    """Code of hold, the rates by which dry friction slows the states, and of their tangents."""
    places, names = {n: i for i, n in enumerate(effect.states)}, _name_symbols(effect)
    lines: list[str] = []
    for name, bound in effect.dry_bounds().items():
        i = places[name]
        slopes, tangent = write_tangent(f"dry_{i}", bound, _tangents(effect), names)
        lines += [
            *assignments({f"most_{i}": bound}, names),
            *slopes,
            # half a step ahead, because the driving force changes: else a stuck state creeps
            f"wanted = z_{i} / w + 1.5 * f[0, {i}] - 0.5 * before_f[{i}]",
            f"within = abs(wanted) <= most_{i}",
            f"hold[{i}] = wanted if within else copysign(most_{i}, wanted)",
            "for c in range(m):",
            *(f"    d_{j} = d[{j}, c]" for j in range(len(places))),
            "    if within:",
            f"        dhold[{i}, c] = d_{i} / w + 1.5 * g[0, {i}, c] - 0.5 * before_g[{i}, c]",
            "    else:",
            f"        dhold[{i}, c] = copysign(1.0, wanted) * ({tangent})",
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
def write_scan(effect: Effect) -> str:
    """Source of the scan: states `out` (s, n) and tangents `dout` (s, q, n) at the rows.

    drive: signals (m, n), those of corrections last;  bends: their deviations from chords (2, m, n)
    unit: tangents (p, q + 1) of the parameters; (p, 0) without tangents. The last column is a
        difference without input, whose growth is measured
    ddrive: tangents of the signals of corrections
    size, growth: size of a difference of states, and the growth at which tangents restart
    """
    parameters = [f"p_{i} = p[{i}]" for i in range(len(list_parameters(effect)))]
    signals, friction = _write_stage_signals(effect), _write_friction_of_stage(effect)
    stage = [*signals, *_write_rates(effect), *friction]
    return f"""{head("Generated from an effect's rates; do not edit.")}

@jitted
def scan(h, steps, p, unit, drive, bends, ddrive, size, growth, z, out, dout):
    n = drive.shape[1]
    s, q = {len(effect.states)}, dout.shape[1]
{indent(parameters, 4)}
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
            for c in range(q):
                dout[i, c, k] = d[i, c]
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
                for c in range(m):
                    d[i, c] += w / 6 * (
                        g[0, i, c] + 2 * g[1, i, c] + 2 * g[2, i, c] + g[3, i, c]
                    )
"""
