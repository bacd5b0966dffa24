"""Actuator gain: the acting force is a constant factor times the command.

    acting force = g command

A torque constant or a gear ratio differs from the data sheet. A record determines the gain only if
something else sets the scale of force: an interaction force that excites the motion, or a known
inertia.
"""

from ._effect import Effect, FitSearch, Parameter


def law(now, p):
    return p.gain * now.command


def undetermined(p, facts):
    return (
        f"a sensor that reads {p.gain:.3g} of the hand's force looks the same, unless the inertia "
        "is known: calibrate one of the two forces"
    )


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
    undetermined=undetermined,
    source="torque constant of a motor",
)
