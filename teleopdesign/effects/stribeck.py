"""Stribeck: friction falls from a static level F_S to the Coulomb level F_C as speed grows.

    level = F_C + (F_S - F_C) exp(-(v / v_S)^2)

The law holds for lubricated contacts in steady sliding. A record distinguishes it from `presliding`
only if the speed crosses v_S slowly in both directions, and the travel between reversals is many
bristle lengths. The extra level at rest is known if the record has speeds far below v_S, or a force
of that size.
"""

from types import SimpleNamespace

from sympy import exp

from ._effect import Effect, FitSearch, Parameter


def law(now, p):
    return p.extra_static_level * exp(-((now.velocity / p.stribeck_velocity) ** 2))


def undetermined(p, facts):
    at_rest = facts.body["coulomb.level"] + p.extra_static_level
    if at_rest <= facts.force:
        return None
    slowest = facts.slowest
    there = float(law(SimpleNamespace(velocity=slowest), p))
    return (
        f"friction of {facts.text(at_rest, 'force')} at rest exceeds all measured forces, "
        f"{facts.text(facts.force, 'force')}: the level at rest and v_S are not determined; "
        f"only the fall from {facts.text(there, 'force')} extra at the slowest motion, "
        f"{facts.text(slowest, 'velocity')}, is known"
    )


EFFECT = Effect(
    role="friction_level",
    energy="dissipates",
    law=law,
    parameters={
        "extra_static_level": Parameter(
            "force",
            "F_S - F_C: extra friction at rest",
            search=FitSearch(scale="largest_force", limit=1.0),
        ),
        "stribeck_velocity": Parameter(
            "velocity",
            "v_S: speed where the extra level is down to 1/e",
            search=FitSearch(starts=(0.02, 0.1, 0.5)),
        ),
    },
    absent={"extra_static_level": 0.0},
    undetermined=undetermined,
    needs=frozenset({"coulomb"}),
    always=frozenset({"even in velocity", "non-negative"}),
    source="Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083",
)
