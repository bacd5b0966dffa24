"""Impact damping: the contact force grows with the speed of compression (Hunt, Crossley).

    F = K d (1 + v / v_0) while the penetration d = x - x_c > 0

With `contact_hardening` the term K d_0 (d/d_0)^n replaces K d. The sum is then the law of Hunt and
Crossley, k d^n + c d^n v with c = k / v_0. The force starts from zero when contact begins, unlike
the force of a damper beside the spring. For slow impacts the speed of return over the speed of
impact is 1 - alpha v, alpha = 2/(3 v_0).
"""

from .._effect import Effect, Parameter, parameter_symbol


def law(now, p):
    stiffness = parameter_symbol("environment", "stiffness")
    return stiffness * now.penetration * now.velocity / p.reference_velocity


EFFECT = Effect(
    role="contact",
    block="environment",
    energy="dissipates",
    law=law,
    parameters={
        "reference_velocity": Parameter(
            "velocity", "v_0: speed of compression that doubles the force"
        )
    },
    absent={"reference_velocity": float("inf")},
    needs=frozenset({"environment"}),
    source="Hunt, Crossley, J. Appl. Mech. 42 (1975) 440",
)
