"""Actuator dead zone: small commands make no force, larger ones less by a constant.

    acting force = sgn(command) max(abs(command) - w, 0)

Examples are amplifiers that switch on late, valves with overlap and gears whose friction acts on
the motor alone. While the device slides at a speed of one sign, a dead zone looks like more
`coulomb` friction; commands that change sign while it moves on distinguish the two.
"""

from sympy import Max, Min

from ._effect import Effect, Parameter


def law(now, p):
    # what a saturation would let pass is lost
    return now.command - Max(-p.half_width, Min(p.half_width, now.command))


EFFECT = Effect(
    role="actuation",
    energy="supplies",
    law=law,
    parameters={"half_width": Parameter("force", "w: largest command that makes no force")},
    absent={"half_width": 0.0},
    source="dead zone of an amplifier or valve; Tao, Kokotovic, Automatica 31 (1995) 1",
)
