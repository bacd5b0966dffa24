"""Presliding: friction is a hysteretic spring before it slides (Dahl, LuGre).

    F = sigma z + sigma_1 dz/dt,   dz/dt = v - (sigma / level) abs(v) z

The contact deflects by level/sigma before it slides. Without bristle damping sigma_1 the law is
that of Dahl. With sigma_1, and with `stribeck` and `viscous` beside it, the law is LuGre. Only
motion of a few bristle lengths shows presliding, where the encoder resolves it. In larger motion
presliding looks like `actuation_delay`: both round the corners of the friction loop.
"""

from ._effect import Effect, FitSearch, Parameter, State
from ._facts import slip_is_observable


def law(now, p):
    spring = p.stiffness * now.bristle
    return spring + p.bristle_damping * bristle(now, p) if p.bristle_damping != 0 else spring


def bristle(now, p):
    return now.velocity - p.stiffness / now.level * abs(now.velocity) * now.bristle


def plausible(p, facts):
    level = facts.friction
    bristle = f"a bristle of {facts.text(p.stiffness, 'stiffness')} at {facts.text(level, 'force')}"
    return slip_is_observable(bristle, [level / p.stiffness], facts) if p.stiffness > 0 else None


EFFECT = Effect(
    role="friction_shape",
    energy="dissipates",
    law=law,
    states={"bristle": State("position", bristle)},
    parameters={
        "stiffness": Parameter(
            "stiffness",
            "sigma: bristle stiffness before sliding",
            search=FitSearch(starts=(3.0, 10.0, 30.0, 100.0, 300.0, 1e3, 3e3, 1e4)),
        ),
        "bristle_damping": Parameter(
            "damping",
            "sigma_1: damping of the bristle",
            optional=True,
            search=FitSearch(starts=(0.1,)),
        ),
    },
    absent={"stiffness": float("inf")},
    plausible=plausible,
    needs=frozenset({"coulomb"}),
    source="Mahvash, Okamura, ICRA 2006, eq (2); Dahl, AIAA J. 14 (1976) 1675; Canudas de Wit, "
    "Olsson, Astrom, Lischinsky, IEEE TAC 40 (1995) 419",
)
