"""Frictional memory: the friction level follows speed with a lag.

    level at speed w,   tau dw/dt = abs(v) - w

The lubricant film takes time to build up and to break down. The lag matters only where the level
depends on speed.
"""

from ._effect import Effect, FitSearch, Parameter, State


def law(now, p):
    return now.film


def film(now, p):
    return (abs(now.velocity) - now.film) / p.time_constant


EFFECT = Effect(
    role="friction_speed",
    energy="dissipates",
    law=law,
    states={"film": State("velocity", film)},
    parameters={
        "time_constant": Parameter(
            "time",
            "tau: lag of the film behind the speed",
            upper=2.0,
            search=FitSearch(starts=(1.0, 10.0)),
        )
    },
    absent={"time_constant": 0.0},
    needs=frozenset({"stribeck"}),
    always=frozenset({"even in velocity", "non-negative"}),
    source="Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083, section 2",
)
