"""Contact hysteresis: a small friction inside the material that does not depend on speed.

    F = K d + sigma z,   dz/dt = v - (sigma / level) abs(v) z     while d = x - x_c > 0 and F > 0
                         dz/dt = -z / tau                         otherwise

Rubber and tissue lose energy in slow loading too. The bristle is that of the effect `presliding`.
While the material pushes, the motion loads the bristle. Where F would pull, contact is lost and the
bristle recovers within tau. The bristle stores sigma z^2/2 and gives up only stored energy, so the
contact stays passive.
"""

from types import SimpleNamespace

from sympy import And, Piecewise

from .. import presliding
from .._effect import SIGNALS, Effect, Parameter, State, parameter_symbol


def undamped(p):
    return SimpleNamespace(stiffness=p.stiffness, bristle_damping=0)


def law(now, p):
    return presliding.law(now, undamped(p))


def bristle(now, p):
    depth = SIGNALS["position"] - parameter_symbol("environment", "contact_position")
    pushing = parameter_symbol("environment", "stiffness") * depth + law(now, p) > 0
    here = SimpleNamespace(velocity=now.velocity, level=p.level, bristle=now.bristle)
    loaded = presliding.bristle(here, undamped(p))
    return Piecewise((loaded, And(depth > 0, pushing)), (-now.bristle / p.recovery_time, True))


EFFECT = Effect(
    role="contact",
    block="environment",
    energy="dissipates",
    law=law,
    states={"bristle": State("position", bristle)},
    parameters={
        "level": Parameter("force", "largest force of the friction inside the material"),
        "stiffness": Parameter("stiffness", "sigma: stiffness of this friction before it slides"),
        "recovery_time": Parameter("time", "tau: time of recovery without contact"),
    },
    absent={"level": 0.0},
    needs=frozenset({"environment"}),
    source="Dahl, AIAA J. 14 (1976) 1675, inside a one-sided contact",
)
