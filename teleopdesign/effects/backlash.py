"""Backlash: actuator side and tip side are two bodies joined through a gap.

    F = K (d -+ g/2) + C (v - v_t) outside the gap, abs(d) > g/2, else 0;   d = x - x_t
    m_t dv_t/dt = F + interaction force;   the body's inertia counts both sides

Gears and worn joints. Told from `transmission_compliance` by small motion, in which the tip does
not follow at all.

When the two meet next depends on the last time by more than sensors tell: along a measured motion
the tip is led back to its course (`_structure.py`).
"""

from sympy import Piecewise

from ._effect import FitSearch, Parameter
from ._structure import make_structure, tip_is_part

#: part of the largest measured force that half a gap must be worth, K g/2: by no more does the
#: coupling differ from a spring without a gap. Half a percent is less than models of real machines
#: leave. Lower: another departure from a spring is named a gap; higher: a small gap in a soft
#: transmission has no name
SEEN = 0.005


def coupling(now, p):
    half, damping = p.gap / 2, p.damping * now.stretch_rate
    return Piecewise(
        (p.stiffness * (now.stretch - half) + damping, now.stretch > half),
        (p.stiffness * (now.stretch + half) + damping, now.stretch < -half),
        (0, True),
    )


def plausible(p, facts):
    worth = p.stiffness * p.gap / 2
    if worth >= SEEN * facts.force:
        return tip_is_part(p, facts)
    return (
        f"a gap of {facts.text(p.gap, 'position')} changes the force by no more than "
        f"{facts.text(worth, 'force')}, where {facts.text(facts.force, 'force')} act: it stands "
        "for a transmission that is no plain spring, or for friction behind it"
    )


#: how closely the tip is led: by less, courses of meetings fall out of step more often
FOLLOWING = 3.0
EFFECT = make_structure(
    coupling=coupling,
    following=FOLLOWING,
    energy="dissipates",
    parameters={
        "tip_inertia": Parameter(
            "inertia", "m_t: inertia of the tip side", search=FitSearch(starts=(0.1, 0.3))
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
    plausible=plausible,
    source="two masses with lost motion",
)
