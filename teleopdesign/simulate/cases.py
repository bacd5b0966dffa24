"""Parameter sets of one diagram as numbers for its compiled laws, grouped by structure.

The simulated form of a diagram differs from the stated one; absent effects are left out, ideal
friction gets a short bristle, and controllers take their sampled form. So cases fall into groups,
by the effects that their values switch off. Some numbers of the simulated form depend on several
values of a case.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.errors import ModelError, did_you_mean
from ..blocks import Body
from ..diagrams import Diagram
from ..diagrams.units import bounds_of_value
from ..realise.simulated import check_levels, least_levels, may_be_negative

if TYPE_CHECKING:
    from .setup import Setup

#: relative change of a value, to determine which simulated numbers depend on it
_CHANGE = 1e-3


@dataclass(frozen=True)
class Group:
    """Cases of one structure.

    cases: their indices;  diagram: the diagram with the values of the first of them
    """

    cases: np.ndarray
    diagram: Diagram


def columns_of(diagram: Diagram, values: Mapping[str, ArrayLike]) -> dict[str, np.ndarray]:
    """The values as one array (cases,) for each parameter; single numbers are repeated.

    raises ModelError: no such parameter, arrays of different lengths, no numbers
    """
    known = diagram.values
    for name in values:
        if name not in known:
            raise ModelError(f'{diagram.name}: no parameter "{name}"{did_you_mean(name, known)}')
    arrays: dict[str, np.ndarray] = {}
    for name, value in values.items():
        try:
            arrays[name] = np.asarray(value, dtype=float)
        except (TypeError, ValueError):
            raise ModelError(f"simulate_many: {name}: expected numbers, found {value!r}") from None
        if arrays[name].ndim > 1:
            raise ModelError(
                f"simulate_many: {name}: expected one number a case, found an array of shape "
                f"{arrays[name].shape}"
            )
    lengths = {name: len(a) for name, a in arrays.items() if a.ndim}
    cases = max(lengths.values(), default=1)
    for name, length in lengths.items():
        if length not in (1, cases) or length == 0:
            longest = max(lengths, key=lambda n: lengths[n])
            raise ModelError(
                f"simulate_many: {name} has {length} values, {longest} has {cases}: "
                "expected as many"
            )
    return {name: np.array(np.broadcast_to(a, (cases,))) for name, a in arrays.items()}


def list_refusals(diagram: Diagram, columns: Mapping[str, np.ndarray]) -> dict[int, str]:
    """Case -> reason why the diagram does not accept its values."""
    suspect = np.zeros(_cases(columns), dtype=bool)
    for name, column in columns.items():
        lower, upper = bounds_of_value(diagram, name)
        suspect |= ~((column >= lower) & (column <= upper))
    suspect |= _slides_by_itself(diagram, columns)
    reasons = {}
    for case in np.flatnonzero(suspect):
        try:
            for part in set_case(diagram, columns, int(case)).bodies:
                if isinstance(part.body, Body):
                    check_levels(part.body, f"{diagram.name}: {part.name}")
        except ModelError as error:
            reasons[int(case)] = str(error)
    return reasons


def _slides_by_itself(diagram: Diagram, columns: Mapping[str, np.ndarray]) -> np.ndarray:
    """Mask (cases,): whether a friction level is below zero in one direction (`check_levels`)."""
    below = np.zeros(_cases(columns), dtype=bool)
    for part in diagram.bodies:
        body = part.body
        if not isinstance(body, Body) or not may_be_negative(body):
            continue
        of = {symbol: f"{part.name}.{name}" for name, symbol in body.symbols().items()}

        def value(symbol: Any, of: Mapping[Any, str] = of) -> Any:
            return columns.get(of[symbol], diagram.values[of[symbol]])

        for level in least_levels(body, value).values():
            below |= np.asarray(level < 0)
    return below


def set_case(diagram: Diagram, columns: Mapping[str, np.ndarray], case: int) -> Diagram:
    """The diagram with the values of one case."""
    return diagram.with_values({name: float(column[case]) for name, column in columns.items()})


def groups(
    diagram: Diagram, columns: Mapping[str, np.ndarray], cases: np.ndarray
) -> Iterator[Group]:
    """The cases by structure: by the values at which effects or optional parameters are absent."""
    flags = [
        column[cases] == off
        for name, column in columns.items()
        for off in _absent_values(diagram, name)
    ]
    table = np.array(flags, dtype=bool).reshape(len(flags), len(cases))
    _, which = np.unique(table, axis=1, return_inverse=True)
    which = np.broadcast_to(which.reshape(-1), (len(cases),))
    for group in np.unique(which):
        members = cases[which == group]
        yield Group(members, set_case(diagram, columns, int(members[0])))


def simulated_values(
    group: Group,
    columns: Mapping[str, np.ndarray],
    form: Callable[[Diagram], Diagram],
    names: tuple[str, ...],
) -> tuple[np.ndarray, dict[int, str]]:
    """Parameters of the simulated form for each case of the group, and the cases that have none.

    form: function from a diagram to its simulated form;  names: parameters of this form
    returns: (cases, names), NaN where there is no simulated form; index of the case -> reason
    """
    base = form(group.diagram).values
    reasons: dict[int, str] = {}
    out = np.tile(np.array([base[n] for n in names], dtype=float), (len(group.cases), 1))
    stated = group.diagram.values
    sources: dict[str, list[str]] = {}  # number of the simulated form -> values it follows from
    for name, column in columns.items():
        if np.ptp(column[group.cases]) == 0.0:
            continue
        changed = _change_value(group.diagram, name)
        other = form(changed).values
        moved = [n for n in names if other.get(n, base[n]) != base[n]]
        for n in moved:
            sources.setdefault(n, []).append(name)
    derived: dict[tuple[str, ...], list[str]] = {}
    for n, follows in sources.items():
        if follows == [n] and base[n] == stated[n]:
            out[:, names.index(n)] = columns[n][group.cases]
        else:
            derived.setdefault(tuple(follows), []).append(n)
    for from_, many in derived.items():
        # each different set of values once: a sweep often repeats them
        sets = np.column_stack([columns[n][group.cases] for n in from_])
        different, which = np.unique(sets, axis=0, return_inverse=True)
        at = [names.index(n) for n in many]
        for k, row in enumerate(different):
            here = np.flatnonzero(which.reshape(-1) == k)
            try:
                case_values = dict(zip(from_, map(float, row), strict=True))
                there = form(group.diagram.with_values(case_values)).values
                out[np.ix_(here, np.array(at))] = [there[n] for n in many]
            except ModelError as error:
                out[np.ix_(here, np.array(at))] = np.nan
                reasons |= {int(case): str(error) for case in group.cases[here]}
    return out, reasons


def delays_of_cases(
    setup: Setup, names: tuple[str, ...], numbers: np.ndarray
) -> list[tuple[float, ...]]:
    """Delay of each delayed signal in each case, s.

    names: parameters that the delays depend on;  numbers: their values, (cases, names)
    """
    equations = setup.program.equations
    if not equations.delays:
        return [()] * len(numbers)
    symbols = {name: x for x, name in equations.parameters.items()}
    different, which = np.unique(numbers, axis=0, return_inverse=True)
    delays = []
    for row in different:
        at = {symbols[name]: float(x) for name, x in zip(names, row, strict=True)}
        delays.append(tuple(float(delay.subs(at)) for delay in equations.delays))
    return [delays[i] for i in which.reshape(-1)]


def _cases(columns: Mapping[str, np.ndarray]) -> int:
    return len(next(iter(columns.values()))) if columns else 1


def _change_value(diagram: Diagram, name: str) -> Diagram:
    """The diagram with one value changed a little, within its bounds."""
    value, (lower, upper) = diagram.values[name], bounds_of_value(diagram, name)
    more = value + _CHANGE * (abs(value) or 1.0)
    less = value - _CHANGE * (abs(value) or 1.0)
    return diagram.with_values({name: float(more if lower <= more <= upper else less)})


def _absent_values(diagram: Diagram, name: str) -> list[float]:
    """Values of a parameter at which a term is left out of the equations."""
    block_name, _, within = name.partition(".")
    block = diagram.block(block_name)
    stages = getattr(block, "stages", ())
    if any(within == f"{g.name}.{g.law.dead_time}" for g in stages):
        return [0.0]
    body = getattr(block, "body", None)
    if not isinstance(body, Body):
        return []
    effect_name, _, parameter = within.partition(".")
    values = []
    for effect in body.effects:
        if effect.name == effect_name:
            values += [v for n, v in effect.absent.items() if n == parameter]
            if effect.parameters[parameter].optional:
                values.append(0.0)
    return sorted(set(values))
