"""Entries of a state space that share its states: one realisation in the place of the entries.

    dx/dt = A x + B u        y = C x + D u        (x at the next sample, of a discrete one)

A transfer function is that of each entry, C_i (s I - A)^-1 B_j + D_ij, and the diagram holds these.
In time the states are there once, so that a mode that grows is one mode: a simulation, and a
judgement of what grows inside, takes an integrator (or a sample's delay) for each state.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..base.errors import ModelError
from ..controllers import matrices_of, unit_state
from .junctions import Junction
from .parts import Block, Control, Moving
from .wiring import Diagram

_Place = tuple[int, int]
#: relative difference that is rounding: each entry is discretised with a separate matrix
#: exponential. A value that a user changes by less is taken for the same value
_ROUNDING = 1e-9


def with_shared_states(diagram: Diagram) -> Diagram:
    """The diagram in which each state of such systems occurs once, in place of their entries.

    raises ModelError: entries of one system are missing or changed separately, so that they share
        no states; a signal of an entry is used apart from the others of its row
    """
    systems: dict[str, dict[_Place, Control]] = {}
    for part in diagram.controls:
        if part.entry is not None:
            place = part.entry.row, part.entry.column
            systems.setdefault(part.entry.of, {})[place] = part
    for name, entries in systems.items():
        diagram = _join_entries(diagram, name, entries)
    return diagram


def _join_entries(diagram: Diagram, name: str, entries: Mapping[_Place, Control]) -> Diagram:
    where = f"{diagram.name}: {name}"
    a, b, c, d, period = _matrices(where, entries)
    inputs = {place[1]: part.input for place, part in entries.items()}
    some = next(iter(entries.values()))
    law = unit_state(discrete=period is not None)
    states = [f"{name}_state_{i + 1}" for i in range(len(a))]
    blocks: list[Block] = [
        Control(state, law, f"{state}_change", f"{state}_out", "", some.analog) for state in states
    ]
    signals = [f"{state}_out" for state in states]
    sums = [
        Junction(f"{state}_change", _terms(signals, a[i], inputs, b[i]))
        for i, state in enumerate(states)
    ]
    whole = {row: _row_signal(name, row, entries) for row in sorted({i for i, _ in entries})}
    sums += [Junction(s, _terms(signals, c[i], inputs, d[i])) for i, s in whole.items()]
    gone = {part.name for part in entries.values()}
    rows = {
        part.output: whole[i]
        for (i, _), part in entries.items()
        if part.output not in whole.values()
    }
    kept = tuple(part for part in diagram.blocks if part.name not in gone)
    _check_takers(where, diagram, kept, rows)
    junctions = tuple(_read_by_row(where, j, rows) for j in diagram.junctions)
    return replace(
        diagram,
        blocks=(*kept, *blocks),
        junctions=(*junctions, *sums),
        texts={s: text for s, text in diagram.texts.items() if s not in rows},
    )


def _matrices(
    where: str, entries: Mapping[_Place, Control]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, float | None]:
    """A, B, C, D unchanged, from the values of the entries, and the period of a discrete system."""
    expected = set(next(iter(entries.values())).entry.entries)  # type: ignore[union-attr]
    if missing := sorted(expected - set(entries)):
        i, j = missing[0]
        raise ModelError(
            f"{where}: entry {i + 1}, {j + 1} is gone, whose states the others share: take all of "
            "them out, or none"
        )
    laws = {place: matrices_of(part.controller) for place, part in entries.items()}
    if any(one is None for one in laws.values()):
        raise ModelError(
            f"{where}: an entry is another controller, whose states the others do not share: "
            "replace all of them, or none"
        )
    known = {place: one for place, one in laws.items() if one is not None}
    size = max(i for i, _ in known) + 1, max(j for _, j in known) + 1
    a, period = next(iter(known.values()))[0], next(iter(known.values()))[4]
    b, c, d = np.zeros((len(a), size[1])), np.zeros((size[0], len(a))), np.zeros(size)
    for (i, j), one in known.items():
        b[:, j], c[i], d[i, j] = one[1:4]
    for (i, j), one in known.items():
        pairs = ((one[0], a), (one[1], b[:, j]), (one[2], c[i]))
        if one[4] != period or not all(_is_same(*pair) for pair in pairs):
            raise ModelError(
                f"{where}: entry {i + 1}, {j + 1} has other values than the entries that share its "
                "states: change all of them alike"
            )
    return a, b, c, d, period


def _is_same(values: np.ndarray, expected: np.ndarray) -> bool:
    apart = np.abs(values - expected) if values.shape == expected.shape else np.array([np.inf])
    return bool((apart <= _ROUNDING * np.abs(expected).max(initial=0.0)).all())


def _terms(
    states: Sequence[str], of_states: np.ndarray, inputs: Mapping[int, str], of_inputs: np.ndarray
) -> dict[str, float]:
    """Weights that are not zero, by signal; weights of equal input signals are added."""
    terms: dict[str, float] = {}
    pairs = [*zip(states, of_states, strict=True), *((s, of_inputs[j]) for j, s in inputs.items())]
    for signal, weight in pairs:
        if weight != 0:
            terms[signal] = terms.get(signal, 0.0) + float(weight)
    return terms


def _row_signal(name: str, row: int, entries: Mapping[_Place, Control]) -> str:
    """Name of an output of the system; the entry's signal if the row has only one entry."""
    of_row = [part.output for (i, _), part in entries.items() if i == row]
    return of_row[0] if len(of_row) == 1 else f"{name}_{row + 1}_out"


def _check_takers(
    where: str, diagram: Diagram, kept: Sequence[Block], rows: Mapping[str, str]
) -> None:
    inputs = [s for part in (*kept, *diagram.kinematics) for s in part.inputs] + [
        *diagram.measured,
        *(b.driver for b in kept if isinstance(b, Moving)),
    ]
    for signal in inputs:
        if signal in rows:
            raise ModelError(f"{where}: {signal} is not there by itself: take the sum of its row")


def _read_by_row(where: str, junction: Junction, rows: Mapping[str, str]) -> Junction:
    """The junction with the output of a row in place of the outputs of its entries."""
    weights: dict[str, set[object]] = {}
    for signal, row in rows.items():
        weights.setdefault(row, set()).add(junction.terms.get(signal, 0))
    terms = {s: w for s, w in junction.terms.items() if s not in rows}
    for row, every in weights.items():
        if len(every) > 1:
            raise ModelError(
                f"{where}: {junction.name} takes entries of one row with several weights"
            )
        weight = next(iter(every))
        if weight != 0:
            terms[row] = weight
    return replace(junction, terms=terms) if terms != dict(junction.terms) else junction
