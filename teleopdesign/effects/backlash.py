"""Backlash: actuator side and tip side are two bodies joined through a gap.

    F = K (d -+ g/2) + C (v - v_t) outside the gap, abs(d) > g/2, else 0;   d = x - x_t
    m_t dv_t/dt = F + interaction force;   the body's inertia counts both sides

Gears and worn joints. Told from `transmission_compliance` by small motion, in which the tip does
not follow at all.

When the two meet next depends on the last time by more than sensors tell: along a measured motion
the tip is led back to its course (`_tip.py`).
"""

from sympy import Piecewise

from ._effect import Effect, Parameter
from ._tip import behind, led_back


def coupling(now, p):
    apart, closing = now.position - now.tip_position, now.velocity - now.tip_velocity
    return Piecewise(
        (p.stiffness * (apart - p.gap / 2) + p.damping * closing, apart > p.gap / 2),
        (p.stiffness * (apart + p.gap / 2) + p.damping * closing, apart < -p.gap / 2),
        (0, True),
    )


#: how closely the tip is led: by less, courses of meetings fall out of step more often
FOLLOWING = 3.0
LAW, TIP = behind(coupling, led_back(FOLLOWING))
EFFECT = Effect(
    role="structure",
    energy="dissipates",
    law=LAW,
    states=TIP,
    led=lambda p: p.tip_inertia,
    parameters={
        "tip_inertia": Parameter("inertia", "m_t: inertia of the tip side", starts=(0.1, 0.3)),
        "stiffness": Parameter(
            "stiffness",
            "K: contact stiffness",
            starts=(0.03, 0.1, 0.3),
            scale="resonance_stiffness",
        ),
        "damping": Parameter(
            "damping", "C: contact damping", starts=(0.03,), scale="resonance_damping"
        ),
        "gap": Parameter(
            "position",
            "g: width of the gap",
            starts=(0.7, 2.5, 10.0, 35.0, 120.0),
            scale="resonance_position",
            essential=True,
        ),
    },
    absent={"tip_inertia": 0.0},
    source="two masses with lost motion",
)
