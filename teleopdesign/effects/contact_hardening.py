"""Contact hardening: the contact force grows faster than the penetration (Hertz, Hunt-Crossley).

    F = K d_0 (d / d_0)^n while the penetration d = x - x_c > 0

K is the secant stiffness at the penetration d_0. The user chooses d_0; d_0 is not estimated. At d_0
= 1 m, K has the same number as K in F = K d^n. The exponent is n = 1.5 for a sphere on a flat
(Hertz), and more for soft tissue. A record distinguishes hardening from a stiffer linear contact
only if the penetration varies widely.
"""

from ._effect import Effect, FitSearch, Parameter


def law(now, p):
    return p.depth * (now.penetration / p.depth) ** p.power


EFFECT = Effect(
    role="contact_shape",
    energy="stores",
    law=law,
    parameters={
        "power": Parameter(
            "dimensionless",
            "n: exponent of the penetration",
            1.0,
            4.0,
            search=FitSearch(starts=(1.2, 1.5, 2.0)),
        ),
        "depth": Parameter(
            "position",
            "d_0: penetration at which K is the secant stiffness",
            search=FitSearch(starts=(0.5,), chosen=True),
        ),
    },
    absent={"power": 1.0},
    needs=frozenset({"environment"}),
    source="Hunt, Crossley, J. Appl. Mech. 42 (1975) 440, eq (8)",
)
