"""Direction-dependent viscous friction: forward and backward damping differ.

    F = (B + d sgn(v)) v,   d = (B+ - B-)/2

Check valves, lip seals and tensioned cables do this. Unlike a `bias` it grows with speed.
"""

from ._effect import Effect, Parameter


def law(now, p):
    return p.half_difference * abs(now.velocity)


def plausible(p, facts):
    damping = facts.body["viscous.damping"]
    if abs(p.half_difference) <= damping:
        return None
    return (
        f"half of the difference, {facts.text(abs(p.half_difference), 'damping')}, is more than "
        f"the damping of {facts.text(damping, 'damping')}: one way it would drive the motion; it "
        "stands for another force that depends on the direction"
    )


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
    plausible=plausible,
    needs=frozenset({"viscous"}),
    source="Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083",
)
