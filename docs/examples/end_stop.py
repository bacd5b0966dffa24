"""Soft end stop: beyond some position a rubber buffer pushes back.

    F = K max(0, x - x_0)

The damping of the rubber is left out. Where all strokes reach far into the rubber, the effect looks
like `spring`.
"""

from sympy import Max

from teleopdesign.effects import Effect, FitSearch, Parameter


def law(now, p):
    return p.stiffness * Max(0, now.position - p.start)


EFFECT = Effect(
    role="force",
    energy="stores",
    law=law,
    parameters={
        "stiffness": Parameter("stiffness", "K: of the buffer"),
        "start": Parameter(
            "position",
            "x_0: where it begins",
            lower=-float("inf"),
            search=FitSearch(starts=(0.5, 1.0, 2.0)),
        ),
    },
    absent={"stiffness": 0.0},
    source="Hooke's law, one-sided",
)
