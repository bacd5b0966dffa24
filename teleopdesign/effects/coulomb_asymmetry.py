"""Direction-dependent Coulomb friction: forward and backward levels differ.

    level = F_C + d sgn(v),   d = (F_C+ - F_C-)/2

Gears and seals have such friction. With friction in proportion to sgn(v) no record distinguishes
the asymmetry from a constant force: two levels are the same as one level and a `bias`.
"""

from ._effect import Effect, Parameter


def law(now, p):
    return p.half_difference * now.direction


def plausible(p, facts):
    level = facts.friction
    if abs(p.half_difference) <= level:
        return None
    return (
        f"half of the difference, {facts.text(abs(p.half_difference), 'force')}, exceeds the "
        f"level of {facts.text(level, 'force')}: in one direction such friction would drive the "
        "motion; the effect imitates a constant force, such as gravity"
    )


EFFECT = Effect(
    role="friction_level",
    energy="stores",
    law=law,
    parameters={
        "half_difference": Parameter(
            "force", "d: half of forward minus backward level", lower=-float("inf")
        )
    },
    absent={"half_difference": 0.0},
    plausible=plausible,
    needs=frozenset({"coulomb"}),
    source="Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083",
)
