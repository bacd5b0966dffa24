"""Added inertia: the body has more inertia than the model states.

    F = m_+ a

Causes are a tool, a gripper, or the inertia of a rotor that acts through a gear. Where the inertia
of the model is free, its estimate already includes the added inertia. Without an interaction force
that excites the motion, added inertia is the same as an actuator gain.
"""

from ._effect import Effect, Parameter


def law(now, p):
    return p.inertia * now.acceleration


EFFECT = Effect(
    role="force",
    energy="stores",
    law=law,
    linear=True,
    parameters={"inertia": Parameter("inertia", "m_+: inertia beyond the model's")},
    absent={"inertia": 0.0},
    source="Newton's second law",
)
