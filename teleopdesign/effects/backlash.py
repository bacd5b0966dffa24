"""Backlash: actuator side and tip side are two bodies joined through a gap.

    F = K (d -+ g/2) + C (v - v_t) outside the gap, abs(d) > g/2, else 0;   d = x - x_t
    m_t dv_t/dt = F + interaction force;   the body's inertia counts both sides

Gears and worn joints have backlash. Small motion distinguishes backlash from
`transmission_compliance`: with backlash the tip does not follow small motion at all.

The next contact depends on the last one by more than sensors resolve, so along a measured motion a
correction leads the computed tip back to its course (`_structure.py`).
"""

from sympy import Piecewise

from ._effect import FitSearch, Parameter
from ._structure import gap_is_observable, make_structure


def coupling(now, p):
    half, damping = p.gap / 2, p.damping * now.stretch_rate
    return Piecewise(
        (p.stiffness * (now.stretch - half) + damping, now.stretch > half),
        (p.stiffness * (now.stretch + half) + damping, now.stretch < -half),
        (0, True),
    )


#: how closely the simulated tip follows the measurement: with less, contacts are out of step
FOLLOWING = 3.0
EFFECT = make_structure(
    coupling=coupling,
    following=FOLLOWING,
    energy="dissipates",
    parameters={
        # a search from half the true inertia, or from three times it, often ends elsewhere
        "tip_inertia": Parameter(
            "inertia", "m_t: inertia of the tip side", search=FitSearch(starts=(0.1, 0.2, 0.4, 0.8))
        ),
        "stiffness": Parameter(
            "stiffness",
            "K: contact stiffness",
            search=FitSearch(starts=(0.03, 0.1, 0.3), scale="resonance_stiffness"),
        ),
        "damping": Parameter(
            "damping",
            "C: contact damping",
            search=FitSearch(starts=(0.03,), scale="resonance_damping"),
        ),
        "gap": Parameter(
            "position",
            "g: width of the gap",
            search=FitSearch(
                starts=(0.7, 2.5, 10.0, 35.0, 120.0), scale="resonance_position", essential=True
            ),
        ),
    },
    plausible=gap_is_observable,
    source="two masses with lost motion",
)
