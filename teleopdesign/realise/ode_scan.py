"""Several coupled hidden states along a measured motion, such as a tip body, with tangents.

Runge-Kutta steps; sub-steps keep the fastest mode well within the method's stability. Between rows
the motion that drives them follows the cubic of its rates, for a straight line weakens what
swings at a tenth of the sample rate by 3 %. Generated from the effect's rates.

A state that declares a correction is led back by the force r that is left unexplained, as by an
observer: dz/dt = rate + correction(r), r = rest - law - friction, 0 where friction can take it up.
Without it two bodies that part and meet fall out of step with the machine after a few meetings.
Dry friction on a state is a constant rate over each sub-step: what brings the state to rest at its
end where the friction can, else its bound (time stepping by Moreau and Jean). A stuck state rests,
without a stiff law.

Where a course of meetings depends on its past more and more, so do its tangents, until they say
nothing of any change that could be made: they begin anew wherever a small difference has grown by
`GROWTH` since it was smallest.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp

from ..effects import SIGNALS, UNEXPLAINED, Effect
from ..measurement.filtering import Array
from .compiled import compile_source
from .exponentials import head
from .laws import Names, assignments, indent, source_of
from .traced import Along, Traced

#: part of a radian of the fastest mode that one sub-step may cover (at half a radian it swings
#: 0.05 % too slowly, at one 0.8 %), the most sub-steps, and how much one may cover then
MODE_STEP, MOST_STEPS, STABLE = 0.5, 16, 2.0
#: growth of a small difference between two courses over which tangents are followed
GROWTH = 30.0


@lru_cache(maxsize=256)
def _drivers(effect: Effect) -> list[str]:
    laws = [*effect.rates().values(), *effect.dry_bounds().values()]
    if corrections := effect.corrections():
        laws += [*corrections.values(), effect.expression()]
    return [n for n, s in SIGNALS.items() if any(law.has(s) for law in laws)]


@lru_cache(maxsize=256)
def _parameters(effect: Effect) -> tuple[sp.Symbol, ...]:
    """The effect's parameters, and others that its rates hold: an inertia, an environment's."""
    of_effect = effect.symbols().values()
    laws = (
        *effect.rates().values(),
        *effect.corrections().values(),
        *effect.dry_bounds().values(),
    )
    known = {*of_effect, *SIGNALS.values(), *effect.state_symbols().values(), UNEXPLAINED}
    others = set().union(*(law.free_symbols for law in laws)) - known
    return (*of_effect, *sorted(others, key=str))


def _slopes(
    name: str,
    law: sp.Expr,
    states: Sequence[sp.Symbol],
    parameters: Sequence[sp.Symbol],
    names: Names,
) -> tuple[list[str], str, dict[int, str]]:
    """Code of a law's tangents: slopes once for all columns, then what each column makes of them.

    name: of the law in the code
    returns: lines that compute slopes; the sum over states in one column, from theirs, d_j; place
        of a parameter -> its slope
    """
    lines, terms, by_parameter = [], [], {}
    for j, symbol in enumerate((*states, *parameters)):
        slope = sp.diff(law, symbol)
        if slope == 0:
            continue
        lines += assignments({f"{name}_{j}": slope}, names)
        if j < len(states):
            terms.append(f"{name}_{j} * d_{j}")
        else:
            by_parameter[j - len(states)] = f"{name}_{j}"
    return lines, " + ".join(terms) or "0.0", by_parameter


#: private name of the force that is left unexplained
_LEFT = "left"


def _names(effect: Effect) -> dict[sp.Symbol, str]:
    """States, parameters and signals as local numbers: what does not change is computed once."""
    states = {s: f"z_{i}" for i, s in enumerate(effect.state_symbols().values())}
    parameters = {s: f"p_{i}" for i, s in enumerate(_parameters(effect))}
    signals = {SIGNALS[d]: f"u_{i}" for i, d in enumerate(_drivers(effect))}
    return states | parameters | signals | {UNEXPLAINED: _LEFT}


def _here_lines(effect: Effect) -> list[str]:
    """Code of the signals u and the states z in a stage; those of corrections after the drivers."""
    drivers = len(_drivers(effect)) + (3 if effect.corrections() else 0)
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


def _left_lines(effect: Effect) -> list[str]:
    """Code of what is left unexplained beyond the bounds of friction.

    bound: 1 or 2 for the one that it is beyond, 0 for neither
    """
    law, names, first = effect.expression(), _names(effect), len(_drivers(effect))
    needed, low, high = (f"u_{first + i}" for i in range(3))
    return [
        f"{_LEFT} = {needed} - ({source_of(law, names)})",
        f"bound = 1 if {_LEFT} < {low} else 2 if {_LEFT} > {high} else 0",
        f"{_LEFT} = {_LEFT} - ({low} if bound == 1 else {high}) if bound else 0.0",
    ]


def _rate_lines(effect: Effect) -> list[str]:
    """Code of f, the rates of the states, and of g, their tangents, in one stage."""
    states = list(effect.state_symbols().values())
    parameters, names = _parameters(effect), _names(effect)
    corrections = effect.corrections()
    lines: list[str] = []
    each = [f"d_{i} = d[{i}, c] + ahead * g[before, {i}, c]" for i in range(len(states))]
    ends: list[str] = []
    if corrections:
        before, moved, law_slopes = _slopes(
            "by_law", effect.expression(), states, parameters, names
        )
        lines += [*_left_lines(effect), *before]
        each += [
            f"d{_LEFT} = 0.0",
            "if bound:",
            "    needed = ddrive[0, k, c] + here * (ddrive[0, k + 1, c] - ddrive[0, k, c])",
            "    step_of = ddrive[bound, k + 1, c] - ddrive[bound, k, c]",
            f"    d{_LEFT} = needed - (ddrive[bound, k, c] + here * step_of) - ({moved})",
        ]
    for i, (name, rate) in enumerate(effect.rates().items()):
        whole = rate + corrections.get(name, sp.S(0))
        lines += assignments({f"f[stage, {i}]": whole}, names)
        before, moved, by_parameter = _slopes(f"by_{i}", whole, states, parameters, names)
        lines += before
        by_left = sp.diff(whole, UNEXPLAINED)
        here = f"g[stage, {i}, columns"
        ends += [f"if columns[{j}] >= 0:\n    {here}[{j}]] += {k}" for j, k in by_parameter.items()]
        if by_left != 0:
            lines += assignments({f"by_{i}_left": by_left}, names)
            moved += f" + by_{i}_left * d{_LEFT}"
            ends += [
                f"if bound and columns[{j}] >= 0:\n    {here}[{j}]] -= by_{i}_left * {k}"
                for j, k in law_slopes.items()
            ]
        each.append(f"g_{i} = {moved}")
    # a stage may follow itself, so slopes are stored when all of them are known
    each += [f"g[stage, {i}, c] = g_{i}" for i in range(len(states))]
    lines.append("for c in range(q + 1):")
    lines += [f"    {line}" for line in each]
    return [*lines, *(line for end in ends for line in end.split("\n"))]


def _dry_lines(effect: Effect) -> list[str]:
    """Code of hold, the rates by which dry friction slows the states, and their tangents."""
    states = list(effect.state_symbols().values())
    places = {n: i for i, n in enumerate(effect.states)}
    parameters, names = _parameters(effect), _names(effect)
    lines: list[str] = []
    for name, bound in effect.dry_bounds().items():
        i = places[name]
        before, moved, by_parameter = _slopes(f"dry_{i}", bound, states, parameters, names)
        lines += [*assignments({f"most_{i}": bound}, names), *before]
        lines += [
            # half a step on, for what drives it changes on the way: else a stuck state creeps
            f"wanted = z_{i} / w + 1.5 * f[0, {i}] - 0.5 * before_f[{i}]",
            f"within = abs(wanted) <= most_{i}",
            f"hold[{i}] = wanted if within else copysign(most_{i}, wanted)",
            "for c in range(q + 1):",
            *(f"    d_{j} = d[{j}, c]" for j in range(len(states))),
            "    if within:",
            f"        dhold[{i}, c] = d_{i} / w + 1.5 * g[0, {i}, c] - 0.5 * before_g[{i}, c]",
            "    else:",
            f"        dhold[{i}, c] = copysign(1.0, wanted) * ({moved})",
        ]
        for j, slope in by_parameter.items():
            lines += [
                f"if not within and columns[{j}] >= 0:",
                f"    dhold[{i}, columns[{j}]] += copysign(1.0, wanted) * {slope}",
            ]
    return lines


def _held_lines(effect: Effect) -> list[str]:
    """Code that takes the rates of dry friction from those of a stage."""
    if not effect.dry_bounds():
        return []
    first = [
        "if step == 0 and k == 0:",
        "    before_f[:] = f[0]",
        "    before_g[:] = g[0]",
        *_dry_lines(effect),
        "before_f[:] = f[0]",
        "before_g[:] = g[0]",
    ]
    first = ["if stage == 0:", *(f"    {line}" for line in first)]
    return [*first, "f[stage] -= hold", "g[stage] -= dhold"]


@lru_cache(maxsize=32)
def _source(effect: Effect) -> str:
    parameters = [f"p_{i} = p[{i}]" for i in range(len(_parameters(effect)))]
    stage = [*_here_lines(effect), *_rate_lines(effect), *_held_lines(effect)]
    return f"""{head("Generated from an effect's rates; do not edit.")}

@jitted
def scan(h, steps, p, columns, drive, bends, ddrive, size, growth, z, out, dout):
    n = drive.shape[1]
    s, q = {len(effect.states)}, dout.shape[1]
{indent(parameters, 4)}
    # the last column is a difference that nothing drives: how much it grows
    d = np.zeros((s, q + 1))
    d[:, q] = size
    f = np.zeros((4, s))
    g = np.zeros((4, s, q + 1))
    w = h / steps
    hold = np.zeros(s)
    dhold = np.zeros((s, q + 1))
    before_f = np.zeros(s)
    before_g = np.zeros((s, q + 1))
    for k in range(n):
        grown = 0.0
        for i in range(s):
            grown = max(grown, abs(d[i, q] / size[i]))
        if grown > growth:
            d[:] = 0.0
            d[:, q] = size
        elif 0.0 < grown < 1.0:  # what was forgotten since does not count
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
                for c in range(q + 1):
                    d[i, c] += w / 6 * (
                        g[0, i, c] + 2 * g[1, i, c] + 2 * g[2, i, c] + g[3, i, c]
                    )
"""


@lru_cache(maxsize=32)
def _stiffness(effect: Effect) -> tuple[list[str], Any]:
    """Signals, and a function of them and the parameters: slopes of the rates by the states (1/s).

    Laws with gaps or stops are judged where they are stiffest, by the first of their pieces, and
    what stiffens with the motion where no state has left the signal that it starts at.
    """
    # a correction is fastest where little is left unexplained, and then linear in it
    law, corrections = effect.expression(), effect.corrections()
    rates = [
        rate - law * sp.diff(corrections.get(name, sp.S(0)), UNEXPLAINED).subs(UNEXPLAINED, 0)
        for name, rate in effect.rates().items()
    ]
    rates = [r.replace(sp.Piecewise, lambda *pieces: pieces[0][0]) for r in rates]
    symbols = effect.state_symbols()
    starts = {symbols[n]: SIGNALS[s.start] if s.start else 0 for n, s in effect.states.items()}
    matrix = sp.Matrix(rates).jacobian(list(starts)).subs(starts)
    names = [n for n, s in SIGNALS.items() if matrix.has(s)]
    return names, sp.lambdify([[SIGNALS[n] for n in names], _parameters(effect)], matrix, "numpy")


def _fastest(effect: Effect, along: Along, parameters: Array) -> float:
    """Largest rate (rad/s) of the states among themselves, at the ends of the measured motion."""
    names, slopes = _stiffness(effect)
    signals = [along.signals[SIGNALS[n]].value for n in names]
    ends = {int(end(row)) for row in signals for end in (np.argmin, np.argmax)} or {0}
    fastest = 0.0
    for end in ends:
        with np.errstate(invalid="ignore"):  # a law beyond where it begins, such as a root
            at_end = np.array(slopes([row[end] for row in signals], parameters), dtype=float)
        fastest = max(fastest, float(np.abs(np.linalg.eigvals(np.nan_to_num(at_end))).max()))
    return fastest


#: what each of these goes on by
_RATES = {"position": "velocity", "velocity": "acceleration"}


def _slope_of(name: str, along: Along) -> Array | None:
    """Rate of a driving signal at the rows; None where a straight line is all that is known."""
    if name in _RATES:
        return along.signals[SIGNALS[_RATES[name]]].value
    return None


def _bends(drive: Array, slopes: Sequence[Array | None], step: float) -> Array:
    """How far each signal (m, n) leaves its chord at the begin and end of each step, (2, m, n)."""
    bends = np.zeros((2, *drive.shape))
    for i, slope in enumerate(slopes):
        if slope is not None:
            chord = np.diff(drive[i])
            bends[0, i, :-1] = step * slope[:-1] - chord
            bends[1, i, :-1] = step * slope[1:] - chord
    return bends


def ode_scan(effect: Effect, along: Along, rest: Sequence[Traced] = ()) -> dict[sp.Symbol, Traced]:
    """The effect's hidden states at the rows, with tangents, driven by the measured signals.

    along: signals at the rows, which carry no tangents themselves
    rest: what corrections need: force at the rows that the effect and friction have to take up,
        and the least and largest that friction can; with tangents
    """
    parameters_of_effect, signals, step, columns = (
        _parameters(effect),
        along.signals,
        along.step,
        along.columns,
    )
    parameters = np.array([along.values[s] for s in parameters_of_effect], dtype=float)
    symbols = [getattr(c, "symbol", c) for c in columns]  # of a probe: its strength
    places = np.array(
        [symbols.index(s) if s in symbols else -1 for s in parameters_of_effect], dtype=int
    )
    fastest = _fastest(effect, along, parameters)
    covered = step * fastest
    steps = int(np.clip(np.ceil(covered / MODE_STEP), 1, MOST_STEPS))
    corrected = rest if effect.corrections() else ()
    drivers = [signals[SIGNALS[n]].value for n in _drivers(effect)]
    drive = np.ascontiguousarray([*drivers, *(r.value for r in corrected)])
    bends = _bends(drive, [_slope_of(n, along) for n in _drivers(effect)], step)
    n, count = drive.shape[1], len(effect.states)
    # without corrections nothing but the parameters of the rates moves the states
    mine = np.arange(len(columns)) if corrected else np.unique(places[places >= 0])
    places = np.where(places >= 0, np.searchsorted(mine, places), -1)
    moving = np.zeros((len(corrected), n, len(mine) + 1))
    for i, r in enumerate(corrected):
        moving[i, :, :-1] = r.tangent.T
    start = np.array(
        [signals[SIGNALS[s.start]].value[0] if s.start else 0.0 for s in effect.states.values()]
    )
    out, tangent = np.empty((count, n)), np.zeros((count, len(columns), n))
    if covered <= STABLE * MOST_STEPS:
        # a difference of one in position goes with one of the fastest mode's rate in velocity
        rate = max(fastest, 1e-300)
        states = effect.states.values()
        size = np.array([rate if s.quantity == "velocity" else 1.0 for s in states])
        growth = GROWTH if effect.corrections() and not effect.linear else np.inf
        by_mine = tangent if len(mine) == len(columns) else np.empty((count, len(mine), n))
        scan = compile_source(_source(effect), "scan")
        known = (step, steps, parameters, places, drive, bends, moving)
        scan(*known, size, growth, start, out, by_mine)
        if by_mine is not tangent:
            tangent[:, mine] = by_mine
    if covered > STABLE * MOST_STEPS or not np.isfinite(out).all():
        # too fast for the record's rate: no number at all rather than a wrong one
        out[:], tangent[:] = np.nan, np.nan
    return {
        symbol: Traced(out[i], tangent[i])
        for i, symbol in enumerate(effect.state_symbols().values())
    }
