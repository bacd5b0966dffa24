"""Environment: a one-sided spring and damper that a body runs into, modelled and not measured.

    F = max(K d + D v, 0) where d = x - x_c > 0, else 0    subtracted from the body's equation

The model of the environment belongs to the body that touches it. Effects of the role `contact` add
to the sum K d + D v. An effect of the role `contact_shape` replaces d in the force of the spring. A
body with a tip behind its transmission touches the environment with the tip: x and v are then those
of the tip.
"""

from .._effect import Effect, Parameter


def law(now, p):
    return p.stiffness * now.penetration + p.damping * now.velocity


EFFECT = Effect(
    role="contact",
    block="environment",
    energy="dissipates",
    law=law,
    parameters={
        "stiffness": Parameter("stiffness", "K: contact stiffness"),
        "damping": Parameter("damping", "D: contact damping"),
        "contact_position": Parameter(
            "position", "x_c: position where contact begins", lower=-float("inf")
        ),
    },
    absent={"stiffness": 0.0, "damping": 0.0},
    source="one-sided spring and damper",
)
