"""Transmission compliance: actuator side and tip side are two bodies on a spring and damper.

    F = K (x - x_t) + C (v - v_t),   m_t dv_t/dt = F + interaction force
    the body's inertia counts both sides

Examples are cables, belts and harmonic drives. Position and friction are those of the actuator
side; the interaction force acts on the tip. Below the resonance the effect looks like
`added_inertia`, or it is invisible where the inertia is free.

Noise of the readings makes a lightly damped tip oscillate for long. So along a measured motion a
correction leads the computed tip back to its course (`_structure.py`).
"""

from ._effect import FitSearch, Parameter
from ._structure import make_structure, rings_like_a_hum, tip_springs_back


def coupling(now, p):
    return p.stiffness * now.stretch + p.damping * now.stretch_rate


#: how closely the simulated tip follows the measurement: with more, the force that leads the tip
#: counts more than the error that it saves
FOLLOWING = 1.0
EFFECT = make_structure(
    coupling=coupling,
    following=FOLLOWING,
    energy="dissipates",
    linear=True,
    parameters={
        "tip_inertia": Parameter(
            "inertia", "m_t: inertia of the tip side", search=FitSearch(starts=(0.1, 0.5))
        ),
        "stiffness": Parameter(
            "stiffness",
            "K: stiffness of the transmission",
            search=FitSearch(starts=(0.004, 0.02, 0.1, 0.5), scale="resonance_stiffness"),
        ),
        "damping": Parameter(
            "damping",
            "C: damping of the transmission",
            search=FitSearch(starts=(0.01,), scale="resonance_damping"),
        ),
    },
    plausible=tip_springs_back,
    undetermined=rings_like_a_hum,
    source="two masses on a spring; Mahvash, Okamura, IEEE CDC 2006",
)
