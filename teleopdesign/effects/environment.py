"""Environment: a one-sided spring and damper that a body runs into, modelled and not measured.

    F = max(K d + D v, 0) where d = x - x_c > 0, else 0    subtracted from the body's equation

The body that touches it carries it; effects of the role `contact` add to the sum, one of the role
`contact_shape` takes the place of d. A body with a tip behind its transmission touches it with the
tip: x and v are the tip's.
"""

from ._effect import Effect, Parameter


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
        "contact_position": Parameter("position", "x_c: where contact begins", lower=-float("inf")),
    },
    absent={"stiffness": 0.0, "damping": 0.0},
    source="one-sided spring and damper",
)
