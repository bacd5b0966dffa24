"""Tip friction: dry friction beyond the compliance or the play of a transmission.

    m_t dv_t/dt = coupling + interaction force - F_t sgn(v_t);   stuck: whatever balances, up to F_t

Gears, whose bearings and seals hold the load's side, and instruments behind cables. At a reversal
the actuator winds the transmission up by 2 F_t before the tip follows: a hysteresis of the
stiffness K that is mistaken for `presliding`, and for `backlash` where K is high.
"""

from ._effect import Effect, FitSearch, Parameter


def law(now, p):
    return p.level


EFFECT = Effect(
    role="tip_level",
    energy="dissipates",
    law=law,
    parameters={
        "level": Parameter(
            "force", "F_t: friction force while the tip slides", search=FitSearch(starts=(0.1,))
        )
    },
    absent={"level": 0.0},
    needs=frozenset({"transmission_compliance"}),
    always=frozenset({"even in velocity", "non-negative"}),
    source="two masses on a spring with friction on both; Spong, J. Dyn. Sys. Meas. Control 109 "
    "(1987) 310, with Coulomb friction of the link",
)
