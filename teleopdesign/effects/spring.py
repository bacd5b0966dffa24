"""Spring: a force in proportion to position.

    F = K x

Causes are cables, bushings, and gravity near the bottom of a pendulum. x counts from the zero of
the encoder: a spring with its rest position elsewhere comes with a `bias`. On a revolute axis
`gravity` is nearly the same where the travel is much less than half a turn to either side.
"""

import numpy as np

from ..base.sentences import percent
from ._effect import Effect, Parameter
from ._facts import STRAIGHT


def law(now, p):
    return p.stiffness * now.position


def undetermined(p, facts):
    if facts.axis != "revolute" or (bend := facts.bend(np.sin)) >= STRAIGHT:
        return None
    travel = facts.text(facts.travel, "position")
    return (
        f"over a travel of {travel} the gravity of a link that hangs down at 0 gives this torque "
        f"within {percent(bend, '.2g')} of its variation: the records hardly distinguish `gravity`"
    )


EFFECT = Effect(
    role="force",
    energy="stores",
    law=law,
    linear=True,
    parameters={"stiffness": Parameter("stiffness", "K: force per displacement")},
    absent={"stiffness": 0.0},
    commoner="gravity",
    undetermined=undetermined,
    source="Hooke's law",
)
