"""The law of a linear system: dx/dt = A x + B u, y = C x + D u, the entries its parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp

from ..effects import Parameter
from ..errors import ModelError
from ..recipes import remember
from ._controller import ControlLaw, ControllerState, Stage, only_sampled

Array = np.ndarray


def stage(name: str, matrices: tuple[Array, Array, Array, float], period: float | None) -> Stage:
    """The system as a stage of a controller.

    matrices: A (n, n), B (n,), C (n,), D;  period: None: continuous; s, of a discrete-time system
    """
    a, b, c, d = matrices
    n = len(b)
    values = {f"a_{i}_{j}": float(a[i, j]) for i in range(n) for j in range(n)}
    values |= {f"b_{i}": float(b[i]) for i in range(n)}
    values |= {f"c_{i}": float(c[i]) for i in range(n)} | {"d": float(d)}
    if period is not None:
        values["period"] = period
    return Stage(_law(name, n, period is not None), values)


def matrices(values: Mapping[str, float], n: int) -> tuple[Array, Array, Array, float]:
    """A, B, C, D from the values of a stage."""
    a = np.array([[values[f"a_{i}_{j}"] for j in range(n)] for i in range(n)]).reshape(n, n)
    b, c = (np.array([values[f"{x}_{i}"] for i in range(n)]) for x in "bc")
    return a, b, c, values["d"]


@lru_cache(maxsize=64)  # laws compare by identity: one order, one kernel
def _law(name: str, n: int, discrete: bool) -> ControlLaw:
    entries = [f"a_{i}_{j}" for i in range(n) for j in range(n)]
    entries += [f"{x}_{i}" for x in "bc" for i in range(n)] + ["d"]
    parameters = {e: Parameter("dimensionless", _meaning(e), lower=-float("inf")) for e in entries}
    if discrete:
        parameters["period"] = Parameter("time", "of a sample; 0: any")

    def output(now: Any, p: Any) -> sp.Expr:
        return _row(now, p, "c_{}", n) + p.d * now.input

    def change(i: int) -> Callable[[Any, Any], sp.Expr]:
        return lambda now, p: _row(now, p, f"a_{i}_{{}}", n) + getattr(p, f"b_{i}") * now.input

    states = {
        f"x_{i}": ControllerState(
            "dimensionless",
            only_sampled if discrete else change(i),
            change(i) if discrete else None,
        )
        for i in range(n)
    }
    made = ControlLaw(
        law=output,
        parameters=parameters,
        states=states,
        linear=not discrete,
        transfer=None if discrete else lambda values, s: _transfer(matrices(values, n), s),
        sampled=_same_period(name) if discrete else lambda v, period: _held(name, v, n, period),
        source="python-control",
    )
    made = made.named(name, f"A linear system of order {n} from python-control.")
    return remember(made, _law, name, n, discrete)


def _meaning(entry: str) -> str:
    """ "a_0_1" as "A, row 1, column 2"."""
    matrix, *places = entry.split("_")
    indices = [f"{w} {int(k) + 1}" for w, k in zip(("row", "column"), places, strict=False)]
    return ", ".join([matrix.upper(), *indices])


def _row(now: Any, p: Any, entry: str, n: int) -> sp.Expr:
    terms = (getattr(p, entry.format(j)) * getattr(now, f"x_{j}") for j in range(n))
    return sp.Add(*terms)


def _transfer(system: tuple[Array, Array, Array, float], s: sp.Symbol) -> sp.Expr:
    """Numerator from the Markov parameters C A^k B: those that are zero stay exactly zero."""
    a, b, c, d = system
    below, markov, x = np.poly(a) if len(b) else np.ones(1), [d], b
    for _ in b:
        markov.append(float(c @ x))
        x = a @ x
    above = np.convolve(below, markov)[: len(below)]
    polynomial = [sp.Poly([sp.Float(k) for k in row], s).as_expr() for row in (above, below)]
    return polynomial[0] / polynomial[1]


def _held(name: str, values: Mapping[str, float], n: int, period: float) -> Stage:
    """The system for an input held over each sample: exact, by one matrix exponential."""
    from scipy.linalg import expm

    a, b, c, d = matrices(values, n)
    block = np.zeros((n + 1, n + 1))
    block[:n, :n], block[:n, n] = a, b
    stepped = expm(period * block)
    return stage(name, (stepped[:n, :n], stepped[:n, n], c, d), period)


def _same_period(name: str) -> Callable[[Mapping[str, float], float], Stage]:
    def sampled(values: Mapping[str, float], period: float) -> Stage:
        stated = values["period"]
        if stated and abs(stated - period) > 1e-9 * period:
            raise ModelError(
                f"{name}: is sampled every {stated * 1e3:g} ms, the computer every "
                f"{period * 1e3:g} ms: give it in continuous time, or sample both alike"
            )
        n = sum(k.startswith("b_") for k in values)
        return Stage(_law(name, n, True), values)

    return sampled
