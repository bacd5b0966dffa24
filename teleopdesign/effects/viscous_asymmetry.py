"""Direction-dependent viscous friction: forward and backward damping differ.

    F = (B + d sgn(v)) v,   d = (B+ - B-)/2

Check valves, lip seals and tensioned cables have such friction. Unlike a `bias`, the difference
grows with speed. The effect may stand beside `shear_thinning` too, whose friction then differs by
the same amount.
"""

from ._effect import Effect, Parameter


def law(now, p):
    return p.half_difference * abs(now.velocity)


def plausible(p, facts):
    if abs(p.half_difference) * facts.speed <= facts.film:
        return None
    return (
        f"half of the difference, {facts.text(abs(p.half_difference), 'damping')}, gives a "
        f"larger force at {facts.text(facts.speed, 'velocity')} than all velocity-dependent "
        f"friction, {facts.text(facts.film, 'force')}: in one direction such friction would drive "
        "the motion; the effect imitates another force that depends on the direction"
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
