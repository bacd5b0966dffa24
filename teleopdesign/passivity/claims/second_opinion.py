"""A second test of a storage certificate: z3 tests its inequalities without its identities.

z3 decides polynomial inequalities over the reals (extra `proof`). It searches for values that meet
all assumptions of a certificate and violate its claim. Either no such values exist, or z3 names
some, or z3 stops without an answer. The checker reads the certificate, so its rules hold here, too.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import Any

from ...base.errors import ModelError
from ..checker import Refused, read
from ..checker.algebra import Poly
from .certificate import Certificate


@dataclass(frozen=True)
class SecondOpinion:
    """Result of z3 on a storage certificate.

    verdict: "confirmed", "refuted" or "unknown"
    open: inequalities (with their signs) that are not confirmed
    counterexample: values that violate one of them, as text; "" where there is none
    """

    verdict: str
    open: tuple[str, ...] = ()
    counterexample: str = ""


def second_opinion(certificate: Certificate, *, seconds: float = 10.0) -> SecondOpinion:
    """Test the inequalities of a storage certificate with z3.

    seconds: most time for each inequality, s
    raises ModelError: z3 (extra `proof`) is not installed, the certificate is of another kind, or
        the checker refuses its content
    """
    try:
        _, storage = read(dict(certificate.content))
    except Refused as problem:
        raise ModelError(f"second_opinion: {problem}") from None
    if storage is None:
        kind = certificate.kind
        raise ModelError(f'second_opinion: a storage certificate is needed, found "{kind}"')
    try:
        z3: Any = import_module("z3")
    except ModuleNotFoundError as missing:
        raise ModelError("z3 is not installed: pip install 'teleopdesign[proof]'") from missing
    still_open, example = [], ""
    for case in storage.cases:
        names = [z3.Real(n) for n in case.algebra.names]
        for goal, claimed in case.goals.items():
            solver = z3.Solver()
            solver.set("timeout", int(1000 * seconds))
            for n, e in case.factors.items():
                # that an invariant is kept is shown where none is assumed: on the border of all of
                # them at once, an inequality there alone would not keep the motion inside
                if goal in case.invariants and n in case.invariants:
                    continue
                above = _z3(z3, e.above, names)  # what stands below is positive
                solver.add(above > 0 if n in certificate.content["positive"] else above >= 0)
            solver.add(_z3(z3, claimed.above, names) < 0)
            answer = str(solver.check())
            if answer != "unsat":
                still_open.append(f"{goal} {tuple(case.signs.values())}")
            if answer == "sat" and goal not in case.invariants:
                example = str(solver.model())
    if example:
        return SecondOpinion("refuted", tuple(still_open), example)
    return SecondOpinion("unknown" if still_open else "confirmed", tuple(still_open))


def _z3(z3: Any, polynomial: Poly, names: list[Any]) -> Any:
    """A polynomial of the checker as a z3 term."""
    terms = [z3.Q(0, 1)]
    for powers, x in polynomial.items():
        factors = [n for n, k in zip(names, powers, strict=True) for _ in range(k)]
        terms.append(z3.Product([z3.Q(x.numerator, x.denominator), *factors]))
    return z3.Sum(terms)
