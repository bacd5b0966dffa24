"""Stribeck: friction falls from a static level F_S to the Coulomb level F_C as speed grows.

    level = F_C + (F_S - F_C) exp(-(v / v_S)^2)

The law holds for lubricated contacts in steady sliding. A record distinguishes it from `presliding`
only if the speed crosses v_S slowly, both ways, and reversals are many bristle lengths apart. The
level at rest is known if the record has speeds far below v_S, or a force of that size.
"""

from types import SimpleNamespace

from sympy import exp

from ._effect import Effect, FitSearch, Parameter
from ._facts import level_at_rest_is_observable, level_at_rest_was_reached

LIMIT = FitSearch(scale="largest_force", limit=1.0)


def law(now, p):
    return p.extra_static_level * exp(-((now.velocity / p.stribeck_velocity) ** 2))


def at_slowest(p, facts):
    return float(law(SimpleNamespace(velocity=facts.slowest), p))


EFFECT = Effect(
    role="friction_level",
    energy="dissipates",
    law=law,
    parameters={
        "extra_static_level": Parameter("force", "F_S - F_C: extra friction at rest", search=LIMIT),
        "stribeck_velocity": Parameter(
            "velocity",
            "v_S: speed where the extra level is down to 1/e",
            search=FitSearch(starts=(0.02, 0.1, 0.5)),
        ),
    },
    absent={"extra_static_level": 0.0},
    plausible=lambda p, facts: level_at_rest_is_observable(
        p.extra_static_level, at_slowest(p, facts), facts
    ),
    undetermined=lambda p, facts: level_at_rest_was_reached(
        p.extra_static_level, at_slowest(p, facts), facts
    ),
    needs=frozenset({"coulomb"}),
    always=frozenset({"even in velocity", "non-negative"}),
    source="Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083",
)
