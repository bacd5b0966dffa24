"""Gravity on a revolute axis: a torque that repeats once a turn.

    F = A sin(x + phi),   A = m g l;   x + phi = 0 where the centre of mass hangs straight down

Examples are a pendulum, a link and an unbalanced drum. On a prismatic axis gravity is a constant
force, `bias`. Over a small part of a turn gravity looks like a `bias` and a `spring`. A torque that
repeats several times a turn, as from teeth and magnets, is `cogging`.
"""

import numpy as np
from sympy import sin

from ..base.sentences import percent
from ._effect import Effect, FitSearch, Parameter, positive_amplitude
from ._facts import STRAIGHT

#: rad to either side of the hanging place: of less, a stiffness is that of a contact. Lower: a
#: bristle is called a link; higher: a link that swings less is called a spring
SWING = 0.05


def law(now, p):
    return p.amplitude * sin(now.position + p.phase)


def plausible(p, facts):
    # a link that hangs down need not be lifted anywhere near the horizontal
    part = (
        float(np.abs(np.sin(facts.places + p.phase)).max(initial=SWING))
        if len(facts.places)
        else 1.0
    )
    if (torque := abs(p.amplitude) * part) <= facts.acting:
        return None
    return (
        f"a torque of {facts.text(torque, 'force')} within the travel exceeds all acting forces, "
        f"{facts.text(facts.acting, 'force')}: over a travel of "
        f"{facts.text(facts.travel, 'position')} the effect imitates a constant force and a spring"
    )


def undetermined(p, facts):
    if (bend := facts.bend(lambda place: np.sin(place + p.phase))) >= STRAIGHT:
        return None
    travel = facts.text(facts.travel, "position")
    return (
        f"over a travel of {travel} a spring and a constant force give this torque within "
        f"{percent(bend, '.2g')} of its variation: the records hardly distinguish these"
    )


EFFECT = Effect(
    role="force",
    energy="stores",
    law=law,
    counterparts={"prismatic": "bias"},
    parameters={
        "amplitude": Parameter("force", "A: torque with the link horizontal", lower=-float("inf")),
        "phase": Parameter(
            "angle", "phi: angle at x = 0", lower=-float("inf"), search=FitSearch(starts=(0.0,))
        ),
    },
    absent={"amplitude": 0.0},
    canonical=positive_amplitude,
    plausible=plausible,
    undetermined=undetermined,
    source="pendulum: Spong, Hutchinson, Vidyasagar, Robot Modeling and Control (2006), 6.3",
)
