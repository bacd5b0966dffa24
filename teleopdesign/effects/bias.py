"""Bias: a constant force, whatever the motion.

    F = F_0

Gravity on a vertical axis, a counterweight, an offset of the current sensor or amplifier. With sgn
friction no record tells it from `coulomb_asymmetry`.
"""

from ._effect import Effect, Parameter


def law(now, p):
    return p.force


EFFECT = Effect(
    role="force",
    energy="stores",
    law=law,
    parameters={
        "force": Parameter("force", "F_0: constant force, subtracted", lower=-float("inf"))
    },
    absent={"force": 0.0},
    source="equation of motion with a constant force",
)
