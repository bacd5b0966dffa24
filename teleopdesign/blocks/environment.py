"""The force of a modelled environment on the body that touches it."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from ..effects import BLOCK_EFFECTS, CONTACT_ROLES, SIGNALS, Effect

CONTACT = BLOCK_EFFECTS["environment"]


def contact_force(effects: Sequence[Effect]) -> sp.Expr:
    """Force of the environment that resists the body; 0 where no effect is a contact."""
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
