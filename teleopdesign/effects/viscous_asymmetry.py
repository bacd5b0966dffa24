"""Direction-dependent viscous friction: forward and backward damping differ.

    F = (B + d sgn(v)) v,   d = (B+ - B-)/2

Check valves, lip seals and tensioned cables do this. Unlike a `bias` it grows with speed. It may
stand beside `shear_thinning` as well, whose friction then differs by as much.
"""

from ._effect import Effect, Parameter


def law(now, p):
    return p.half_difference * abs(now.velocity)


def plausible(p, facts):
    if abs(p.half_difference) * facts.speed <= facts.film:
        return None
    return (
        f"half of the difference, {facts.text(abs(p.half_difference), 'damping')}, makes more of "
        f"a force at {facts.text(facts.speed, 'velocity')} than the friction of speed there, "
        f"{facts.text(facts.film, 'force')}: one way it would drive the motion; it stands for "
        "another force that depends on the direction"
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
