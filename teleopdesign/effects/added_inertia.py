"""Added inertia: the body carries more than the model says.

    F = m_+ a

A tool, a gripper, a gear's reflected rotor. Where the model's inertia is free, that takes it up
and nothing is missing; without an exciting interaction force it equals an actuator gain.
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
