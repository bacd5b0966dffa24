"""Laws given as a transfer function or a measured response, with their values as numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from ._exact import exact_decimal

if TYPE_CHECKING:
    from ._controller import Stage


def has_numbers(stage: Stage) -> bool:
    """Whether the law is a measured response, or has a transfer function in z at a fixed period."""
    if stage.law.response is not None:
        return True
    return stage.law.in_z is not None and stage.values["period"] > 0


def is_by_numbers(stage: Stage) -> bool:
    """Whether the law states a transfer function or response, which depends on its input alone."""
    law = stage.law
    return any(x is not None for x in (law.transfer, law.in_z, law.response))


def insert_values(stage: Stage, s: sp.Symbol) -> sp.Expr:
    """Transfer function of a law that states one, with the values of the stage inserted."""
    if stage.law.transfer is not None:
        return stage.law.transfer(stage.values, s)
    if stage.law.response is not None:
        return exact_decimal(stage.values["scale"]) * stage.law.response(s)
    assert stage.law.in_z is not None
    period, z = exact_decimal(stage.values["period"]), sp.Symbol("z")
    late = sp.exp(-s * period)
    above, below = (
        sp.Poly(x, z) for x in sp.fraction(sp.together(stage.law.in_z(stage.values, z)))
    )
    # in powers of e^(-s T): those of e^(s T) overflow far out in the right half plane
    order = below.degree()
    sides = (
        sp.Add(*(c * late ** (order - k) for (k,), c in part.terms())) for part in (above, below)
    )
    return sp.Mul(next(sides), 1 / next(sides)) * (1 - late) / (s * period)
