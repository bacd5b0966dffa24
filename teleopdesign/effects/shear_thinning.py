"""Shear thinning: viscous friction that grows less than linearly with speed.

    F = D abs(v)^n sgn(v),   0 < n < 1;   below v_0 = 1e-5 m/s (rad/s) a straight line

Lubricated gears and pre-stressed bearings: friction of the film flattens as speed grows, as that of
industrial robots does. From n = 1 on it is `viscous`, at n = 0 `coulomb`; a record tells it from
the two together by speeds over more than a decade. Of seals and contacts that stick, friction of
the film is what comes beside `coulomb`: a power alone stands for both. Mistaken for
`actuator_saturation`.
"""

from ._effect import Effect, FitSearch, Parameter

#: m/s or rad/s; a power has no slope at rest. Far below the speeds that records resolve; lower, a
#: simulation needs shorter steps
STRAIGHT = 1e-5


def law(now, p):
    return p.drag * now.velocity * (now.velocity**2 + STRAIGHT**2) ** ((p.exponent - 1) / 2)


def plausible(p, facts):
    most = p.drag * facts.speed ** min(p.exponent, 1.0)
    if most <= facts.force:
        return None
    return (
        f"{facts.text(most, 'force')} at the largest speed is more than any force measured, "
        f"{facts.text(facts.force, 'force')}: it stands for a constant force beside friction"
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
