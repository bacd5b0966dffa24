"""The inequalities of a storage certificate put to z3, without the identities that show them.

z3 decides polynomial inequalities over the reals (extra `proof`). Asked for values that meet all
that a certificate assumes and break what it claims, it finds none, finds some, or gives up.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import sympy as sp

from ..errors import ModelError
from .certificate import Certificate
from .check_certificate import _read


@dataclass(frozen=True)
class SecondOpinion:
    """What z3 says: "confirmed", "refuted" or "unknown".

    open: inequalities (with their signs) that are not confirmed
    counterexample: values that break one of them, as text; "" where none was found
    """

    verdict: str
    open: tuple[str, ...] = ()
    counterexample: str = ""


def second_opinion(certificate: Certificate, *, seconds: float = 10.0) -> SecondOpinion:
    """Whether the inequalities of a storage certificate hold, by z3.

    seconds: for each inequality
    raises ModelError: z3 (extra `proof`) is not installed, or a certificate of another kind
    """
    c = certificate.content
    if c["kind"] != "storage":
        raise ModelError(f'second_opinion: a storage certificate is needed, found "{c["kind"]}"')
    try:
        z3: Any = import_module("z3")
    except ModuleNotFoundError as missing:
        raise ModelError("z3 is not installed: pip install 'teleopdesign[proof]'") from missing
    still_open, example = [], ""
    for signs in itertools.product((1, -1), repeat=len(c["signs"])):
        assumed, goals = _inequalities(c, dict(zip(c["signs"], signs, strict=True)))
        for name, goal in goals.items():
            solver = z3.Solver()
            solver.set("timeout", int(1000 * seconds))
            for e, strict in assumed:
                solver.add(_z3(z3, e) > 0 if strict else _z3(z3, e) >= 0)
            above, below = sp.fraction(sp.together(goal))
            solver.add(_z3(z3, sp.expand(above)) * _z3(z3, sp.factor(below)) < 0)
            answer = str(solver.check())
            if answer != "unsat":
                still_open.append(f"{name} {signs}")
            if answer == "sat":
                example = str(solver.model())
    if example:
        return SecondOpinion("refuted", tuple(still_open), example)
    return SecondOpinion("unknown" if still_open else "confirmed", tuple(still_open))


def _inequalities(
    c: Any, signs: dict[str, int]
) -> tuple[list[tuple[sp.Expr, bool]], dict[str, sp.Expr]]:
    """What is assumed, (expression, strict), and what is claimed to be >= 0."""
    names = {n: sp.Symbol(n, real=True) for n in c["symbols"]}
    put: dict[sp.Symbol, sp.Expr] = {}
    for x, s in signs.items():
        put |= {names["sign_" + x]: sp.Integer(s), names["abs_" + x]: names[x]}
        put[names[x]] = s * names[x]

    def get(text: str) -> sp.Expr:
        return _read(text, names).subs(put, simultaneous=True)

    rates = {names[x]: signs.get(x, 1) * get(text) for x, text in c["rates"].items()}
    storage = get(c["storage"])
    change = sum((sp.diff(storage, x) * r for x, r in rates.items()), sp.S(0))
    assumed = [(get(t), True) for t in c["positive"].values()]
    assumed += [(get(t), False) for t in c["nonnegative"].values()]
    assumed += [(get(h["expression"]), False) for h in c["invariant"].values()]
    assumed += [(names[x], False) for x in signs]
    return assumed, {"storage": storage, "supply": get(c["supply"]) - change}


def _z3(z3: Any, e: sp.Expr) -> Any:
    """A rational sympy expression as a z3 term."""
    if e.is_Rational:
        return z3.Q(int(e.p), int(e.q))
    if e.is_Symbol:
        return z3.Real(e.name)
    parts = [_z3(z3, a) for a in e.args if not (e.is_Pow and a is e.exp)]
    if e.is_Add:
        return z3.Sum(parts)
    if e.is_Mul:
        return z3.Product(parts)
    if e.is_Pow and e.exp.is_Integer and e.exp > 0:
        return z3.Product(parts * int(e.exp))
    raise ModelError(f"z3: not a polynomial: {e}")
