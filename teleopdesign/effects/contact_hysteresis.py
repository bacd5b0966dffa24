"""Contact hysteresis: a small friction inside the material, whatever the speed.

    F = K d + sigma z,   dz/dt = v - (sigma / level) abs(v) z     while d = x - x_c > 0 and F > 0
                         dz/dt = -z / tau                         otherwise

Rubber and tissue lose energy in slow loading too. The bristle is that of the effect `presliding`.
While the material pushes it is loaded; where F would pull, contact has been lost and it recovers
within tau. It stores sigma z^2/2, only gives up what it stored, and so the contact stays passive.
"""

from types import SimpleNamespace

from sympy import And, Piecewise

from . import presliding
from ._effect import SIGNALS, Effect, Parameter, State, parameter_symbol


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
        "level": Parameter("force", "greatest force of the friction inside"),
        "stiffness": Parameter("stiffness", "sigma: its stiffness before it slides"),
        "recovery_time": Parameter("time", "tau: of its recovery where nothing touches"),
    },
    absent={"level": 0.0},
    needs=frozenset({"environment"}),
    source="Dahl, AIAA J. 14 (1976) 1675, inside a one-sided contact",
)
