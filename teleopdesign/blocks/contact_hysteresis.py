"""Contact hysteresis: a small friction inside the material, whatever the speed.

    F = K d + sigma z,   dz/dt = v - (sigma / level) abs(v) z     while d = x - x_c > 0 and F > 0
                         dz/dt = -z / tau                         otherwise

Rubber and tissue lose energy in slow loading too. The bristle is that of the effect `presliding`.
While the material pushes it is loaded; where F would pull, contact has been lost and it recovers
within tau. It stores sigma z^2/2, only gives up what it stored, and so the contact stays passive.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import sympy as sp

from ..effects import EFFECTS, SIGNALS, Effect, Parameter, State
from .environment import CONTACT

_DAHL = EFFECTS["presliding"].without("bristle_damping")


def _law(now: Any, p: Any) -> sp.Expr:
    return sp.sympify(_DAHL.law(now, p), strict=True)


def _bristle(now: Any, p: Any) -> sp.Expr:
    symbols = CONTACT.symbols()
    depth = SIGNALS["position"] - symbols["contact_position"]
    pushing = sp.And(depth > 0, symbols["stiffness"] * depth + _law(now, p) > 0)
    here = SimpleNamespace(velocity=now.velocity, level=p.level, bristle=now.bristle)
    loaded = _DAHL.states["bristle"].rate(here, p)
    return sp.Piecewise((loaded, pushing), (-now.bristle / p.recovery_time, True))


CONTACT_HYSTERESIS = Effect(
    role="contact",
    energy="dissipates",
    law=_law,
    states={"bristle": State("position", _bristle)},
    parameters={
        "level": Parameter("force", "greatest force of the friction inside"),
        "stiffness": Parameter("stiffness", "sigma: its stiffness before it slides"),
        "recovery_time": Parameter("time", "tau: of its recovery where nothing touches"),
    },
    absent={"level": 0.0},
    needs=frozenset({CONTACT.name}),
    source="Dahl, AIAA J. 14 (1976) 1675, inside a one-sided contact",
).named("contact_hysteresis", __doc__ or "")
