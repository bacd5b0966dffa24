"""Contact damping: a damper acts beside the spring of a modelled environment.

    F = max(K d + D v, 0) while the penetration d = x - x_c > 0

Rubber, tissue and felt pads have such damping. The damper acts during contact only, and the contact
force never pulls. A record shows the damping if contact begins and ends at speed. A contact that is
held or pressed slowly shows the stiffness alone.
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
