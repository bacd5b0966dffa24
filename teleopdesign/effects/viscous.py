"""Viscous friction: a force in proportion to velocity.

    F = B v

The law holds for full-film lubrication, for the back-EMF of a motor on a voltage amplifier, and for
eddy currents. Where a spring-like controller moves the body, viscous friction looks like
`actuator_lag` and `actuation_delay`. In a sweep at constant velocity amplitude it looks like
Coulomb friction.
"""

from ._effect import Effect, Parameter


def law(now, p):
    return p.damping * now.velocity


EFFECT = Effect(
    role="force",
    energy="dissipates",
    law=law,
    linear=True,
    parameters={"damping": Parameter("damping", "B: force per velocity")},
    absent={"damping": 0.0},
    source="Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083",
)
