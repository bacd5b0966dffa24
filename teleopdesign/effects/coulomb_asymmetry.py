"""Direction-dependent Coulomb friction: forward and backward levels differ.

    level = F_C + d sgn(v),   d = (F_C+ - F_C-)/2

Gears and seals do this. With sgn friction no record tells it from a constant force: two levels are
one level and a `bias`.
"""

from ._effect import Effect, Parameter


def law(now, p):
    return p.half_difference * now.direction


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
    needs=frozenset({"coulomb"}),
    source="Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083",
)
