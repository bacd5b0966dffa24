"""Viscous friction: a force in proportion to velocity.

    F = B v

Holds for full-film lubrication, back-EMF of a motor on a voltage amplifier, and eddy currents.
Mistaken for `actuator_lag` and `actuation_delay` where a spring-like controller moves the body, and
for Coulomb friction in a sweep at constant velocity amplitude.
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
