"""An environment that is modelled, not measured: a one-sided spring and damper the body runs into.

    F = max(K d + D v, 0) where d = x - x_c > 0, else 0    subtracted from the body's equation

It is carried by the body that touches it, under the name `environment`; effects of the role
`contact` add to the sum, one of the role `contact_shape` takes the place of d. A body with a tip
behind its transmission touches it with the tip: x and v are the tip's.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp

from ..effects import CONTACT_ROLES, SIGNALS, Effect, Parameter

NAME = "environment"


def _law(now: Any, p: Any) -> sp.Expr:
    return p.stiffness * now.penetration + p.damping * now.velocity


CONTACT = Effect(
    role="contact",
    energy="dissipates",
    law=_law,
    parameters={
        "stiffness": Parameter("stiffness", "K: contact stiffness"),
        "damping": Parameter("damping", "D: contact damping"),
        "contact_position": Parameter("position", "x_c: where contact begins", lower=-float("inf")),
    },
    absent={"stiffness": 0.0, "damping": 0.0},
    source="one-sided spring and damper",
).named(NAME, __doc__ or "")


def contact_force(effects: Sequence[Effect]) -> sp.Expr:
    """Force that the environment takes from the body; 0 where none of these effects is one."""
    if not any(e.role in CONTACT_ROLES for e in effects):
        return sp.S(0)
    penetration = SIGNALS["position"] - CONTACT.symbols()["contact_position"]
    felt: sp.Expr = penetration
    for effect in effects:
        if effect.role == "contact_shape":
            felt = effect.expression({"penetration": penetration})
    laws = (e.expression({"penetration": felt}) for e in effects if e.role == "contact")
    force = sp.Add(*laws)
    return sp.Piecewise((force, sp.And(penetration > 0, force > 0)), (0, True))
