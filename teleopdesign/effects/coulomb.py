"""Coulomb friction: a constant force against the motion that does not depend on speed.

    level = F_C,   F = F_C sgn(v);   stuck: whatever balances, up to F_C

The law holds for dry contacts that slide steadily. Near rest a record shows `presliding` instead,
where the position resolves the deflection of the contact.
"""

from ._effect import Effect, Parameter


def law(now, p):
    return p.level


EFFECT = Effect(
    role="friction_level",
    energy="dissipates",
    law=law,
    parameters={"level": Parameter("force", "F_C: friction force while sliding")},
    absent={"level": 0.0},
    always=frozenset({"even in velocity", "non-negative"}),
    source="Bernstein, Lawrence, Pao, World Haptics 2005, eq (1)",
)
