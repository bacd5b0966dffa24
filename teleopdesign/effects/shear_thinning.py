"""Shear thinning: viscous friction that grows less than linearly with speed.

    F = D abs(v)^n sgn(v),   0 < n < 1;   below v_0 = 1e-5 m/s (rad/s) a straight line

Lubricated gears, pre-stressed bearings and industrial robots have such friction: the friction of
the lubricant film flattens as speed grows. From n = 1 on the law is `viscous`, at n = 0 `coulomb`.
Speeds over more than a decade distinguish it from these two together. In seals and in contacts that
stick, the friction of the film comes beside `coulomb`; where nothing sticks, friction begins with
the speed, and the law has all the force of both. The effect looks like `actuator_saturation`.
"""

from ._effect import Effect, FitSearch, Parameter

#: m/s or rad/s: below this speed the law is almost a straight line, because a power has no finite
#: slope at rest. It is far below the speeds that records resolve; a lower value needs shorter steps
#: in a simulation
STRAIGHT = 1e-5


def law(now, p):
    return p.drag * now.velocity * (now.velocity**2 + STRAIGHT**2) ** ((p.exponent - 1) / 2)


def plausible(p, facts):
    most = p.drag * facts.speed ** min(p.exponent, 1.0)
    if most <= facts.force:
        return None
    return (
        f"{facts.text(most, 'force')} at the largest speed exceeds all measured forces, "
        f"{facts.text(facts.force, 'force')}: the effect imitates a constant force beside friction"
    )


EFFECT = Effect(
    role="force",
    energy="dissipates",
    law=law,
    parameters={
        "drag": Parameter("force", "D: force at a speed of 1 m/s or 1 rad/s"),
        "exponent": Parameter(
            "dimensionless",
            "n: logarithmic slope of the force over speed",
            upper=1.0,
            search=FitSearch(starts=(0.25, 0.5, 0.75)),
        ),
    },
    absent={"drag": 0.0},
    counts_as=frozenset({"viscous"}),
    after=frozenset({"coulomb"}),
    plausible=plausible,
    source="power law of a lubricant in gears and bearings; Waiboer, Aarts, Jonker, Multibody "
    "Dynamics (ECCOMAS, Madrid 2005)",
)
