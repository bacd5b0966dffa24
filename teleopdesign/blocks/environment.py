"""An environment that is modelled, not measured: a one-sided spring and damper the body runs into.

    F = K (x - x_c) + D v where x > x_c, else 0      subtracted from the equation of the body

It is carried by the body that touches it, as a force among others, under the name `environment`.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from ..effects import Effect, Parameter

NAME = "environment"


def _law(now: Any, p: Any) -> sp.Expr:
    depth = now.position - p.contact_position
    return sp.Piecewise((p.stiffness * depth + p.damping * now.velocity, depth > 0), (0, True))


CONTACT = Effect(
    role="force",
    law=_law,
    parameters={
        "stiffness": Parameter("stiffness", "K: contact stiffness"),
        "damping": Parameter("damping", "D: contact damping"),
        "contact_position": Parameter("position", "x_c: where contact begins", lower=-float("inf")),
    },
    absent={"stiffness": 0.0, "damping": 0.0},
    source="one-sided spring and damper",
).named(NAME, __doc__ or "")
