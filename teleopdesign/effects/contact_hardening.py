"""Contact hardening: the contact force grows faster than the penetration (Hertz, Hunt-Crossley).

    F = K d_0 (d / d_0)^n while the penetration d = x - x_c > 0

K is the secant stiffness at the depth d_0, which is chosen, not estimated; at d_0 = 1 m its number
is that of K in F = K d^n. n = 1.5 for a sphere on a flat (Hertz), more for soft tissue.
Distinguished from a stiffer linear contact only if the depth varies widely.
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
            "d_0: where K is the secant stiffness",
            search=FitSearch(starts=(0.5,), chosen=True),
        ),
    },
    absent={"power": 1.0},
    needs=frozenset({"environment"}),
    source="Hunt, Crossley, J. Appl. Mech. 42 (1975) 440, eq (8)",
)
