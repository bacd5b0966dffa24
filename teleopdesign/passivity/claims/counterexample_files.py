"""Files of motions that refute a claim: written as JSON, read and replayed by anyone."""

from __future__ import annotations

import json
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp

from ...base.errors import ExperimentError, ModelError
from ...base.files import read_whole, write_json
from ...diagrams.expressions import read_expression
from ...diagrams.junctions import position_symbol
from ...realise.lti import S
from ..rate_independent import Coulomb, Cycle, Dahl, Spring
from ..search.growing_wave import GrowingWave
from ..search.sampled_wave import Z, sampled_wave
from ..theorems.lugre import Jumps
from ..theorems.quantised_spring import Flip
from ..theorems.sampled_compensation import Trembling
from ..theorems.velocity_compensation import SteadyStrokes
from ..two_port.growing_mode import GrowingMode
from ..two_port.termination import CLAMPED, Termination
from .claim import Counterexample

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
    kind = c["kind"]
    strokes = int(c.get("rounds", 1)) * max(len(c.get(n, ())) for n in ("turning_points", "legs"))
    if not 0 <= strokes <= MOST_STROKES:
        raise ValueError(f"found {strokes} strokes, expected at most {MOST_STROKES}")
    if kind == "growing wave":
        z = sp.ImmutableMatrix([[_read(e, S) for e in row] for row in c["impedance"]])
        velocity = tuple(complex(*v) for v in c["velocity"])
        return GrowingWave(z, _fraction(c["rate"]), _fraction(c["frequency"]), velocity)
    if kind == "growing mode":
        return _growing_mode(c)
    if kind == "sampled wave":
        law = _read(c["law"], Z)
        b, late, k = (_read(c[n]) for n in ("damping", "sample_time", "stiffness"))
        return sampled_wave(law, b, late, k, _fraction(c["rate"]), _fraction(c["frequency"]))
    if kind == "cycle":
        helps, *against = (_ELEMENTS[n](*v) for n, *v in [c["compensator"], *c["friction"]])
        return Cycle(helps, tuple(against), tuple(c["turning_points"]), int(c["rounds"]))
    if kind in ("steady strokes", "trembling"):
        moved = {k: v for k, v in c.items() if k not in ("kind", "energy")}
        for name in {"friction", "compensator"} & set(moved):
            element, *values = moved[name]
            moved[name] = _ELEMENTS[element](*values)
        return (Trembling if kind == "trembling" else SteadyStrokes)(**moved)
    fields = {k: _tuples(v) for k, v in c.items() if k not in ("kind", "energy")}
    if kind == "jumps":
        return Jumps(**fields)
    if kind == "flip":
        return Flip(**fields)
    raise ModelError(f'no kind of motion "{kind}"')


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


def _growing_mode(c: dict[str, Any]) -> GrowingMode:
    z = sp.ImmutableMatrix([[_read(e, S) for e in row] for row in c["impedance"]])
    first, second = (
        CLAMPED if held == "clamped" else _make_termination(*(_fraction(x) for x in held))
        for held in c["terminations"]
    )
    one, other = (complex(*v) for v in c["velocity"])
    at = _fraction(c["rate"]), _fraction(c["frequency"])
    mode = GrowingMode(z, (first, second), *at, (one, other))
    if not mode.is_confirmed():
        raise ValueError("the two-port does not grow between these terminations")
    return mode


def _make_termination(damping: Fraction, inertia: Fraction, stiffness: Fraction) -> Termination:
    return Termination(damping, inertia, stiffness)


def _tuples(value: Any) -> Any:
    return tuple(_tuples(v) for v in value) if isinstance(value, list) else value
