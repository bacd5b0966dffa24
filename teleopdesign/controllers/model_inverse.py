"""Model inverse of one axis: the force that makes a device follow a desired motion.

    F = m a + b v + k x,   x = w(s) input,   w(s) = (2 pi f_c / (s + 2 pi f_c))^2

The law is the inverse of the impedance m s^2 + b s + k with a low-pass. The low-pass has just
enough roll-off to make the inverse proper. So a linear device responds with w, whatever its
dynamics. Friction is no part of the inverse: cancel friction first. In the sampled law x, v and a
are means over the coming sample, with the reference held. For the inverse of any other transfer
function see `inverted`.
"""

from types import SimpleNamespace

from sympy import exp, pi

from ..effects import EFFECTS, Parameter
from ._controller import ControlLaw, ControllerState

_TERMS = EFFECTS["added_inertia"], EFFECTS["viscous"], EFFECTS["spring"]


def _velocity(now, p):
    return 2 * pi * p.bandwidth * (now.once - now.twice)


def _once(now, p):
    return 2 * pi * p.bandwidth * (now.input - now.once)


def _twice_ahead(now, p):
    """Exact solution of the double pole for a held input; `once` changes within the sample."""
    decay = 2 * pi * p.bandwidth * now.period
    left = (now.twice - now.input) + (now.once - now.input) * decay
    return now.input + left * exp(-decay)


def _motion(now, p):
    """The low-passed motion; sampled, its means over the coming sample (of x by trapezium)."""
    velocity = _velocity(now, p)
    if now.period == 0:
        pole = 2 * pi * p.bandwidth
        return SimpleNamespace(
            position=now.twice, velocity=velocity, acceleration=pole * (_once(now, p) - velocity)
        )
    once = now.input + (now.once - now.input) * exp(-2 * pi * p.bandwidth * now.period)
    twice = _twice_ahead(now, p)
    later = _velocity(SimpleNamespace(once=once, twice=twice), p)
    return SimpleNamespace(
        position=(now.twice + twice) / 2,
        velocity=(twice - now.twice) / now.period,
        acceleration=(later - velocity) / now.period,
    )


def law(now, p):
    motion = _motion(now, p)
    return sum(effect.law(motion, p) for effect in _TERMS)


CONTROLLER = ControlLaw(
    law=law,
    states={
        "once": ControllerState("position", _once),
        "twice": ControllerState("position", _velocity, _twice_ahead),
    },
    linear=True,
    parameters={
        "inertia": Parameter("inertia", "m: inertia"),
        "damping": Parameter("damping", "b: damping"),
        "stiffness": Parameter("stiffness", "k: stiffness"),
        "bandwidth": Parameter("frequency", "f_c: frequency of both poles of the low-pass, Hz"),
    },
    source="Lee, Lawrence, Pao 2004, as used by Bernstein, Lawrence, Pao, World Haptics 2005",
)
