"""Actuator gain: the force that acts is a constant factor times the command.

    acting force = g command

A torque constant or gear ratio that is not what the data sheet says. Something must set the scale
of force: an exciting interaction force, or an inertia that is known.
"""

from ._effect import Effect, FitSearch, Parameter


def law(now, p):
    return p.gain * now.command


EFFECT = Effect(
    role="actuation",
    energy="supplies",
    law=law,
    linear=True,
    parameters={
        "gain": Parameter(
            "dimensionless", "g: acting force per command", search=FitSearch(starts=(1.0,))
        )
    },
    absent={"gain": 1.0},
    source="torque constant of a motor",
)
