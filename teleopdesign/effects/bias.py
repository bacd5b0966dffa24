"""Bias: a constant force that does not depend on the motion.

    F = F_0

Causes are gravity on a vertical axis, a counterweight, or an offset of the current sensor or
amplifier. With friction in proportion to sgn(v) no record distinguishes a bias from
`coulomb_asymmetry`.
"""

from ._effect import Effect, Parameter


def law(now, p):
    return p.force


EFFECT = Effect(
    role="force",
    energy="stores",
    law=law,
    parameters={
        "force": Parameter(
            "force", "F_0: constant force; F_0 > 0 acts towards negative x", lower=-float("inf")
        )
    },
    absent={"force": 0.0},
    source="equation of motion with a constant force",
)
