"""The laws of linear systems from python-control, with their unrounded numbers as parameters.

State space: dx/dt = A x + B u, y = C x + D u. Transfer function: numerator and denominator, as a
system in the controllable form. Each state has a unit, `scale`, on which no output depends.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Any, Literal

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from ..base.errors import ModelError
from ..base.recipes import maker_of, remember
from ..effects import Parameter
from ._controller import ControlLaw, ControllerState, Stage, mark_sampled_rate
from ._exact import exact_decimal, resolvent

Array = NDArray[np.float64]
#: whether a system came as matrices or as numerator and denominator
Form = Literal["matrices", "coefficients"]
_Law = Callable[[Any, Any], sp.Expr]


def stage(name: str, matrices: tuple[Array, Array, Array, float], period: float | None) -> Stage:
    """A system in state space as a stage of a controller.

    matrices: A (n, n), B (n,), C (n,), D;  period: s, of a discrete system; None: continuous
    """
    a, b, c, d = matrices
    n = len(b)
    values = {f"a_{i}_{j}": float(a[i, j]) for i in range(n) for j in range(n)}
    values |= {f"b_{i}": float(b[i]) for i in range(n)}
    values |= {f"c_{i}": float(c[i]) for i in range(n)} | {"d": float(d)}
    return _stage(name, "matrices", n, values, a, period)


def rational_stage(
    name: str, above: Sequence[float], below: Sequence[float], period: float | None
) -> Stage:
    """A transfer function as a stage of a controller, with unchanged coefficients.

    above, below: numerator and denominator from the highest power, the first of `below` not zero
    period: s, of a discrete system; None: continuous
    """
    n = len(below) - 1
    values = {f"numerator_{k}": 0.0 for k in range(n + 1)}
    values |= {f"numerator_{k}": float(x) for k, x in enumerate(reversed(above))}
    values |= {f"denominator_{k}": float(x) for k, x in enumerate(reversed(below))}
    return _stage(name, "coefficients", n, values, _companion(below), period)


def _stage(
    name: str,
    form: Form,
    n: int,
    values: dict[str, float],
    a: Array,
    period: float | None,
) -> Stage:
    values |= {f"scale_{i}": x for i, x in enumerate(_balance(a))}
    if period is not None:
        values["period"] = period
    return Stage(_law(name, form, n, period is not None), values)


def _companion(below: Sequence[float]) -> Array:
    """A of the controllable form; below: denominator from the highest power."""
    n = len(below) - 1
    a = np.eye(n, k=1)
    if n:
        a[-1] = -np.array(below[:0:-1], dtype=float) / below[0]
    return a


def _balance(a: Array) -> list[float]:
    """Units of the states, powers of two, because coefficients of a polynomial span decades.

    Without them, a Butterworth low-pass of order 8 at 100 Hz loses 1e-8 of its step, with them
    3e-15.
    """
    from scipy.linalg import matrix_balance

    if not len(a):
        return []
    _, (scale, _) = matrix_balance(a, permute=False, separate=True)
    return [float(x) for x in scale]


def matrices(values: Mapping[str, float], n: int) -> tuple[Array, Array, Array, float]:
    """A, B, C, D from the values of a stage, with the states in their units `scale`."""
    scale = np.array([values[f"scale_{i}"] for i in range(n)])
    if "denominator_0" in values:
        below = [values[f"denominator_{k}"] for k in range(n, -1, -1)]
        above = np.array([values[f"numerator_{k}"] for k in range(n + 1)]) / below[0]
        a, d = _companion(below), float(above[n])
        b = np.eye(n)[:, -1] if n else np.zeros(0)
        c = above[:n] - d * np.array(below[:0:-1]) / below[0]
    else:
        a, b, c, d = as_they_came(values)
    return a * scale / scale[:, None], b / scale, c * scale, d


def as_they_came(values: Mapping[str, float]) -> tuple[Array, Array, Array, float]:
    """A (n, n), B (n,), C (n,), D of a state space, with the states in their original units."""
    n = _order(values)
    a = np.array([[values[f"a_{i}_{j}"] for j in range(n)] for i in range(n)]).reshape(n, n)
    b, c = (np.array([values[f"{x}_{i}"] for i in range(n)]) for x in "bc")
    return a, b, c, values["d"]


def _order(values: Mapping[str, float]) -> int:
    return sum(k.startswith("scale_") for k in values)


@lru_cache(maxsize=64)  # laws compare by identity: one order, one kernel
def _law(name: str, form: Form, n: int, discrete: bool) -> ControlLaw:
    if form == "matrices":
        entries = [f"a_{i}_{j}" for i in range(n) for j in range(n)]
        entries += [f"{x}_{i}" for x in "bc" for i in range(n)] + ["d"]
        meanings = {e: _meaning(e) for e in entries}
        output, change = _matrix_law(n)
    else:
        sides, variable = ("numerator", "denominator"), "z" if discrete else "s"
        meanings = {
            f"{side}_{k}": f"coefficient of {variable}^{k}" for side in sides for k in range(n + 1)
        }
        output, change = _coefficient_law(n)
    parameters = {
        e: Parameter("dimensionless", text, lower=-float("inf")) for e, text in meanings.items()
    }
    parameters |= {
        f"scale_{i}": Parameter("dimensionless", "unit of a state: any gives the same output")
        for i in range(n)
    }
    if discrete:
        parameters["period"] = Parameter("time", "of a sample; 0: any")
    states = {
        f"x_{i}": ControllerState(
            "dimensionless",
            mark_sampled_rate if discrete else change(i),
            change(i) if discrete else None,
        )
        for i in range(n)
    }
    made = ControlLaw(
        law=output,
        parameters=parameters,
        states=states,
        linear=not discrete,
        transfer=None if discrete else _transfer,
        shift=_transfer if discrete else None,
        sampled=_make_discretiser(name)
        if discrete
        else lambda v, period: _discretise_held(name, v, n, period),
        source="python-control",
    )
    made = made.named(name, f"A linear system of order {n} from python-control.")
    return remember(made, _law, name, form, n, discrete)


def is_of_matrices(law: ControlLaw) -> bool:
    """Whether a law was made here, so that its transfer function is that of its own states."""
    return maker_of(law) is _law


def _matrix_law(n: int) -> tuple[_Law, Callable[[int], _Law]]:
    """Output, and change of each state, of a state space."""

    def output(now: Any, p: Any) -> sp.Expr:
        terms = (_entry(p, f"c_{j}") * _state(now, p, j) for j in range(n))
        return sp.Add(*terms) + p.d * now.input

    def change(i: int) -> _Law:
        def rate(now: Any, p: Any) -> sp.Expr:
            terms = (_entry(p, f"a_{i}_{j}") * _state(now, p, j) for j in range(n))
            return (sp.Add(*terms) + _entry(p, f"b_{i}") * now.input) / _entry(p, f"scale_{i}")

        return rate

    return output, change


def _coefficient_law(n: int) -> tuple[_Law, Callable[[int], _Law]]:
    """Output, and change of each state, of the controllable form."""

    def output(now: Any, p: Any) -> sp.Expr:
        lead, straight = _entry(p, f"denominator_{n}"), _entry(p, f"numerator_{n}")
        shares = (
            _entry(p, f"numerator_{k}") - straight * _entry(p, f"denominator_{k}") / lead
            for k in range(n)
        )
        terms = (share * _state(now, p, k) for k, share in enumerate(shares))
        return (sp.Add(*terms) + straight * now.input) / lead

    def change(i: int) -> _Law:
        def rate(now: Any, p: Any) -> sp.Expr:
            if i < n - 1:
                return _state(now, p, i + 1) / _entry(p, f"scale_{i}")
            terms = (_entry(p, f"denominator_{k}") * _state(now, p, k) for k in range(n))
            back = sp.Add(*terms) / _entry(p, f"denominator_{n}")
            return (now.input - back) / _entry(p, f"scale_{i}")

        return rate

    return output, change


def _entry(p: Any, name: str) -> sp.Expr:
    return getattr(p, name)


def _state(now: Any, p: Any, i: int) -> sp.Expr:
    """A state in the unit of its equation."""
    return _entry(p, f"scale_{i}") * getattr(now, f"x_{i}")


def _meaning(entry: str) -> str:
    """ "a_0_1" as "A, row 1, column 2"."""
    matrix, *places = entry.split("_")
    indices = [f"{w} {int(k) + 1}" for w, k in zip(("row", "column"), places, strict=False)]
    return ", ".join([matrix.upper(), *indices])


def sides_of(values: Mapping[str, float], s: sp.Symbol) -> tuple[sp.Poly, sp.Poly]:
    """Numerator and denominator in exact numbers, with a root of the latter for each state."""
    n = _order(values)
    if "denominator_0" in values:
        above, below = (
            [exact_decimal(values[f"{side}_{k}"]) for k in range(n, -1, -1)]
            for side in ("numerator", "denominator")
        )
    else:

        def entry(name: str) -> Fraction:
            return Fraction(repr(float(values[name])))

        a = [[entry(f"a_{i}_{j}") for j in range(n)] for i in range(n)]
        b, c = ([entry(f"{x}_{i}") for i in range(n)] for x in "bc")
        det, numerator = resolvent(a, b, c)
        straight = entry("d")
        through = zip([Fraction(0), *numerator], det, strict=True)
        above = [sp.Rational(x + straight * y) for x, y in through]
        below = [sp.Rational(x) for x in det]
    return sp.Poly(above, s, domain="QQ"), sp.Poly(below, s, domain="QQ")


def _transfer(values: Mapping[str, float], s: sp.Symbol) -> sp.Expr:
    """The transfer function in exact numbers: a zero coefficient stays exactly zero."""
    p, q = sides_of(values, s)
    common = sp.gcd(p, q)
    return p.quo(common).as_expr() / q.quo(common).as_expr()


def _discretise_held(name: str, values: Mapping[str, float], n: int, period: float) -> Stage:
    """The system for an input held over each sample: exact, by one matrix exponential."""
    from scipy.linalg import expm

    a, b, c, d = matrices(values, n)
    block = np.zeros((n + 1, n + 1))
    block[:n, :n], block[:n, n] = a, b
    stepped = expm(period * block)
    return stage(name, (stepped[:n, :n], stepped[:n, n], c, d), period)


def check_period(name: str, stated: float, period: float) -> None:
    """Raise ModelError if the computer has another period (s) than the system (0: any)."""
    if stated and abs(stated - period) > 1e-9 * period:
        raise ModelError(
            f"{name}: is sampled every {stated * 1e3:g} ms, the computer every "
            f"{period * 1e3:g} ms: give it in continuous time, or sample both alike"
        )


def _make_discretiser(name: str) -> Callable[[Mapping[str, float], float], Stage]:
    def sampled(values: Mapping[str, float], period: float) -> Stage:
        check_period(name, values["period"], period)
        form: Form = "coefficients" if "denominator_0" in values else "matrices"
        return Stage(_law(name, form, _order(values), True), values)

    return sampled
