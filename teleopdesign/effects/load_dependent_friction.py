"""Load-dependent friction: the level grows with the force carried.

    level = F_C + mu abs(acting force)

Gears, screws and capstans press harder on their contacts the more they transmit. Told from
`coulomb` by commands that vary at equal speed. From mu = 1 on no acting force moves the body.
"""

from ._effect import Effect, FitSearch, Parameter


def law(now, p):
    return p.coefficient * abs(now.acting_force)


EFFECT = Effect(
    role="friction_level",
    energy="dissipates",
    law=law,
    parameters={
        "coefficient": Parameter(
            "dimensionless", "mu: level per force carried", search=FitSearch(within=1.0)
        )
    },
    absent={"coefficient": 0.0},
    needs=frozenset({"coulomb"}),
    always=frozenset({"even in velocity", "non-negative"}),
    source="Amontons' law on the transmitted force",
)
