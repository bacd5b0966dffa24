"""An effect file as a user writes it."""

SOURCE = '''"""Own drag: a force in proportion to the square of velocity.

    F = D v abs(v)
"""

from teleopdesign import Effect, Parameter


def law(now, p):
    return p.drag * now.velocity * abs(now.velocity)


EFFECT = Effect(
    role="force",
    law=law,
    parameters={"drag": Parameter("drag", "D: force per velocity squared")},
    absent={"drag": 0.0},
    source="made for a test",
)
'''
