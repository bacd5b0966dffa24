"""Refuting motions as files: written as JSON, read and replayed by anyone."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import sympy as sp

from ..errors import ModelError
from ..realise.lti import S
from .check_certificate import _read
from .claim import Record
from .growing_mode import CLAMPED, GrowingMode, Termination
from .growing_wave import GrowingWave
from .lugre import Jumps
from .quantised_spring import Flip
from .rate_independent import Coulomb, Cycle, Dahl, Spring
from .sampled_compensation import Trembling
from .sampled_data import Z, sampled_wave
from .velocity_compensation import SteadyStrokes

_ELEMENTS = {"coulomb": Coulomb, "dahl": Dahl, "spring": Spring}


def write_record(record: Record, path: str | Path) -> None:
    """Write a refuting motion as JSON."""
    text = json.dumps(record.as_dict(), indent=1)
    Path(path).write_text(text + "\n", encoding="utf-8")


def read_record(path: str | Path) -> Record:
    """Read a refuting motion; `replay()` then computes what it gives out, in J.

    raises ModelError: not such a file, or one whose stated energy its replay does not confirm
    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        record = _made(content)
        stated, found = float(content["energy"]), record.energy
    except (OSError, ValueError, KeyError, TypeError) as problem:
        raise ModelError(f"{path}: no record of a motion: {problem}") from problem
    if abs(found - stated) > 1e-6 * abs(stated) or found <= 0:
        raise ModelError(f"{path}: states {stated:g} J, the replay gives out {found:g} J")
    return record


def _made(c: dict[str, Any]) -> Record:
    kind = c["kind"]
    if kind == "growing wave":
        names = {"s": S, "exp": sp.exp}
        z = sp.ImmutableMatrix([[_read(e, names) for e in row] for row in c["impedance"]])
        velocity = tuple(complex(*v) for v in c["velocity"])
        return GrowingWave(z, Fraction(c["rate"]), Fraction(c["frequency"]), velocity)
    if kind == "growing mode":
        return _growing_mode(c)
    if kind == "sampled wave":
        law = _read(c["law"], {"z": Z})
        b, late, k = (_read(c[n], {}) for n in ("damping", "sample_time", "stiffness"))
        return sampled_wave(law, b, late, k, Fraction(c["rate"]), Fraction(c["frequency"]))
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
    raise ModelError(f'record: no kind "{kind}"')


def _growing_mode(c: dict[str, Any]) -> GrowingMode:
    z = sp.ImmutableMatrix([[_read(e, {"s": S}) for e in row] for row in c["impedance"]])
    first, second = (
        CLAMPED if held == "clamped" else _held(*(Fraction(x) for x in held))
        for held in c["terminations"]
    )
    one, other = (complex(*v) for v in c["velocity"])
    at = Fraction(c["rate"]), Fraction(c["frequency"])
    mode = GrowingMode(z, (first, second), *at, (one, other))
    if not mode.is_confirmed():
        raise ValueError("the two-port does not grow between these terminations")
    return mode


def _held(damping: Fraction, inertia: Fraction, stiffness: Fraction) -> Termination:
    return Termination(damping, inertia, stiffness)


def _tuples(value: Any) -> Any:
    return tuple(_tuples(v) for v in value) if isinstance(value, list) else value
