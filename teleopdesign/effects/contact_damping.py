"""Contact damping: a damper acts beside the spring of a modelled environment.

    F = max(K d + D v, 0) while the penetration d = x - x_c > 0

Rubber, tissue, a felt pad. It acts during contact only, and never pulls. A record shows it if the
contact is entered and left at speed; contact held or pressed slowly shows the stiffness alone.
"""

from ._effect import Effect, Parameter


def law(now, p):
    return p.damping * now.velocity


EFFECT = Effect(
    role="contact",
    energy="dissipates",
    law=law,
    parameters={"damping": Parameter("damping", "D: damping during contact")},
    absent={"damping": 0.0},
    needs=frozenset({"environment"}),
    source="spring and damper in parallel (Kelvin, Voigt), one-sided",
)
