"""Coupling: another measured motion accelerates the body through a common inertia.

    F = M a_other

Examples are joints of one arm, two carriages on one beam, and the reaction of a frame. The other
motion is a further channel of the record, `other_position`. Where both motions run together, the
coupling looks like `added_inertia` and `spring`. A record distinguishes these if one body moves
while the other rests.
"""

from ._effect import Effect, FitSearch, Parameter


def law(now, p):
    return p.inertia * now.other_acceleration


EFFECT = Effect(
    role="force",
    energy="supplies",
    law=law,
    parameters={
        "inertia": Parameter(
            "inertia",
            "M: force per acceleration of the other motion",
            lower=-float("inf"),
            search=FitSearch(starts=(0.1,)),
        )
    },
    absent={"inertia": 0.0},
    source="off-diagonal term of an inertia matrix; Spong, Hutchinson, Vidyasagar, Robot Modeling "
    "and Control (2006), section 6.2",
)
