"""Direction-dependent viscous friction: forward and backward damping differ.

    F = (B + d sgn(v)) v,   d = (B+ - B-)/2

Check valves, lip seals and tensioned cables do this. Unlike a `bias` it grows with speed.
"""

from ._effect import Effect, Parameter


def law(now, p):
    return p.half_difference * abs(now.velocity)


EFFECT = Effect(
    role="force",
    energy="supplies",
    law=law,
    parameters={
        "half_difference": Parameter(
            "damping", "d: half of forward minus backward damping", lower=-float("inf")
        )
    },
    absent={"half_difference": 0.0},
    needs=frozenset({"viscous"}),
    source="Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083",
)
