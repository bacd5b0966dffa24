"""Files of motions that refute a claim: written as JSON, read and replayed by anyone."""

from __future__ import annotations

import json
import re
from fractions import Fraction
from pathlib import Path
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np
import sympy as sp

from ...base.errors import ExperimentError, ModelError
from ...base.files import read_whole, write_json
from ...diagrams.expressions import read_expression
from ...diagrams.junctions import position_symbol
from ...realise.lti import S
from ..growing_mode import CLAMPED, GrowingMode, Termination
from ..rate_independent import Coulomb, Cycle, Dahl, Spring
from ..search.growing_wave import GrowingWave, SampledWave, Z, sampled_wave
from ..theorems.lugre import Jumps
from ..theorems.quantised_spring import Flip
from ..theorems.sampled_compensation import Trembling
from ..theorems.velocity_compensation import SteadyStrokes
from .claim import Counterexample

_KINDS: dict[str, Any] = {
    kind.kind: kind
    for kind in (
        Cycle, Flip, GrowingMode, GrowingWave, Jumps, SampledWave, SteadyStrokes, Trembling,
    )
}  # fmt: skip
_ELEMENTS = {"coulomb": Coulomb, "dahl": Dahl, "spring": Spring}
#: text of a fraction: longer than any that a search writes, short enough to be read at once
_FRACTION = re.compile(r"-?[0-9]{1,2000}(/[0-9]{1,2000})?")
#: most strokes of a motion in a file: searches write at most 40 000, and a million take seconds
MOST_STROKES = 1_000_000


def write_record(record: Counterexample, path: str | Path) -> None:
    """Write a motion that refutes a claim as a JSON file; `read_record` reads the file.

    record: `Claim.record`;  path: of the JSON file, which holds the motion and its energy (J)
    """
    write_json(path, record.as_dict())


def read_record(path: str | Path) -> Counterexample:
    """Read a motion that refutes a claim, and replay it; `replay()` computes its energy, J, again.

    raises ModelError: no such file, or the replay does not confirm the energy that the file states
    """
    if not Path(path).is_file():
        raise ModelError(f"{path}: no such file")
    try:
        content = json.loads(read_whole(path).decode("utf-8"))
        record = _make_counterexample(content)
        with np.errstate(over="raise", invalid="raise"):
            stated, replayed = float(content["energy"]), record.energy
    except (OSError, ValueError, KeyError, TypeError, ArithmeticError, RecursionError) as problem:
        raise ModelError(f"{path}: no record of a motion: {problem}"[:300]) from problem
    if abs(replayed - stated) > 1e-6 * abs(stated) or replayed <= 0:
        raise ModelError(f"{path}: states {stated:g} J, the replay releases {replayed:g} J")
    return record


def _make_counterexample(c: dict[str, Any]) -> Counterexample:
    if not isinstance(c, dict):
        raise TypeError("expected named fields")
    strokes = int(c.get("rounds", 1)) * max(len(c.get(n, ())) for n in ("turning_points", "legs"))
    if not 0 <= strokes <= MOST_STROKES:
        raise ValueError(f"found {strokes} strokes, expected at most {MOST_STROKES}")
    if c["kind"] not in _KINDS:
        raise ModelError(f'no kind of motion "{c["kind"]}"')
    kind = _KINDS[c["kind"]]
    hints = get_type_hints(kind)
    fields = {n: _value(x, hints[n]) for n, x in c.items() if n not in ("kind", "energy")}
    record: Counterexample = sampled_wave(**fields) if kind is SampledWave else kind(**fields)
    if isinstance(record, GrowingMode) and not record.is_confirmed():
        raise ValueError("the two-port does not grow between these terminations")
    return record


def _value(data: Any, hint: Any) -> Any:
    """The value of a field of a motion from its plain data."""
    if hint is Fraction:
        return _fraction(data)
    if hint is sp.Expr:
        return _read(data, Z)
    if hint is sp.ImmutableMatrix:
        return sp.ImmutableMatrix([[_read(e, S) for e in row] for row in data])
    if hint is Termination:
        if data == "clamped":
            return CLAMPED
        damping, inertia, stiffness = map(_fraction, data)
        return Termination(damping, inertia, stiffness)
    if hint is complex:
        return complex(*data)
    if not isinstance(data, list):
        return data
    if get_origin(hint) is not tuple:
        name, *values = data
        return _ELEMENTS[name](*values)
    inner = [x for x in get_args(hint) if x is not Ellipsis] or [None]
    return tuple(_value(x, inner[min(k, len(inner) - 1)]) for k, x in enumerate(data))


def _fraction(text: str) -> Fraction:
    """A fraction from a text such as "-3/4".

    raises ValueError: any other text; a power of ten could cost time and memory without end
    """
    if not (isinstance(text, str) and _FRACTION.fullmatch(text)):
        raise ValueError(f"expected a fraction such as 3/4, found {str(text)[:60]!r}")
    return Fraction(text)


def _read(text: str, *names: sp.Symbol) -> sp.Expr:
    """An expression of these names from its text; the text is parsed and never run."""
    try:
        e = read_expression(text, where="record")
    except ExperimentError as error:
        raise ValueError(str(error)) from None
    e = e.subs({position_symbol(n.name): n for n in names})
    if e.free_symbols - {*names}:
        raise ValueError(f"unknown names in {text[:60]}")
    return e
